"""The certificate of a pressure: what it violates, and how far its energy can lie above the least.

It is reckoned from the pressure that is returned and the gap which that leaves, made anew, in NumPy on a CPU
and in CuPy on a GPU. Nothing that the search believes goes into it but the approach.
"""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, Self

import numpy as np

from warpwear.contact.balance import TOLERANCE
from warpwear.grid import FloatArray, blocks_of_rows

#: Load that a certified pressure may miss, relatively: twice what a search allows, which sums otherwise.
LOAD_TOLERANCE = 2.0 * TOLERANCE
#: Cells looked at together, which stay in the cache of a core.
TOGETHER = 2**16
#: On a GPU, which they keep busy.
TOGETHER_ON_GPU = 2**24


@dataclass(frozen=True)
class Certificate:
    """What a pressure p between 0 and H is worth that was solved for a load or at an approach λ.

    t is the gap after deformation, from the mean planes, so that t − λ is what lies between the bodies. The
    conditions are t = λ where 0 < p < H, t ≥ λ where p = 0 and t ≤ λ where p = H.

    violation: largest breach of these, over the rms height of the gap before contact; allowed: what may be
    left of it, the tolerance or, where that is more, what rounding shows. penetration: of the bodies where
    p < H, deepest, a length. load_residual: load over the one asked for, − 1; 0 at an approach.
    beyond_bounds: by how much a pressure is negative or exceeds H. relative_gap: energy_gap over load times
    rms height. level: the λ' below, the largest of several parts.

    energy_gap: Σ p max(t − λ', 0) + (H − p) max(λ' − t, 0), times the area of a cell, with the λ' that makes
    it least (without a hardness the smallest t, and the first term alone). No other pressure between the
    bounds under the same load has an energy that is lower by more. For the energy ½ p·Ap + p·g is convex and
    t = Ap + g its gradient, so that any such q has at least the energy of p plus t·(q − p), which is
    (t − λ')·(q − p) as Σ q = Σ p; and of that no cell gives less than −p (t − λ') where t > λ' and
    −(H − p)(λ' − t) where t < λ'. There is no factor ½, as the bound uses the tangent and not the parabola.
    """

    violation: float
    penetration: float
    load_residual: float
    beyond_bounds: float
    energy_gap: float
    relative_gap: float
    allowed: float
    level: float

    def scaled(self, *, length: float, pressure: float, area: float) -> Self:
        """Give the certificate in other units. length, pressure, area: what those here are worth there."""
        return replace(
            self,
            penetration=self.penetration * length,
            beyond_bounds=self.beyond_bounds * pressure,
            energy_gap=self.energy_gap * length * pressure * area,
            level=self.level * length,
        )

    @property
    def fault(self) -> str:
        """What keeps the pressure from being certified, as half a sentence; empty where nothing does."""
        if not self.beyond_bounds <= 0.0:
            return f"a pressure is beyond its bounds by {self.beyond_bounds:.3g} MPa"
        if not abs(self.load_residual) <= LOAD_TOLERANCE:
            return f"it misses the load by {self.load_residual:.3g} of it (allowed {LOAD_TOLERANCE:g})"
        if not self.violation <= self.allowed:
            return (
                f"complementarity is violated by {self.violation:.3g} of the rms height "
                f"(allowed {self.allowed:.3g})"
            )
        if not (math.isfinite(self.energy_gap) and math.isfinite(self.penetration)):
            return f"its energy gap is {self.energy_gap:g}"
        return ""


class Cells(NamedTuple):
    """Arrays of the same shape (rows, columns). cap may be one number for all, inf for none."""

    pressure: Any
    gradient: Any
    cap: Any


#: Gives the cells of a part, block by block, each time it is called.
Blocks = Callable[[], Iterator[Cells]]


class _Part(NamedTuple):
    """What is found of the cells that share one load and one approach."""

    total: float
    over: float  # largest p − H
    under: float  # largest −p
    highest: float  # t where p > 0
    lowest: float  # t where p < H
    level: float  # λ'
    gap: float  # Σ p max(t − λ', 0) + (H − p) max(λ' − t, 0)


def certify(
    parts: Iterable[Blocks],
    *,
    approaches: FloatArray,
    asked: FloatArray | None,
    scale: FloatArray,
    allowed: FloatArray,
    cell_area: float,
    xp: Any = np,
) -> Certificate:
    """Certify the pressure of one part or of several, each with an approach of its own.

    parts: the cells of each. asked: Σ p of each; None at approaches. scale: rms height of each, or of a flat
    another length. allowed: violation of each [length]. xp: NumPy, or CuPy where the cells lie on a GPU.
    """
    found = [_measure(blocks, xp) for blocks in parts]
    total, over, under, highest, lowest, level, gap = np.array(found).T
    violation = np.maximum(np.maximum(highest - approaches, approaches - lowest), 0.0)
    off = np.zeros(len(found))
    if asked is not None:
        off = np.divide(total, asked, out=1.0 + total, where=asked > 0.0) - 1.0
    relative, may = (
        np.divide(v, scale, out=np.zeros_like(scale), where=v > 0.0) for v in (violation, allowed)
    )
    worst = int(np.argmax(np.where(np.isnan(violation), np.inf, violation - allowed)))
    work = float((total * scale).sum())
    return Certificate(
        violation=math.nan if np.isnan(violation).any() else float(relative[worst]),
        penetration=float(np.maximum(approaches - lowest, 0.0).max()),
        load_residual=float(off[np.argmax(np.abs(off))]),
        beyond_bounds=float(np.maximum(np.maximum(over, under), 0.0).max()),
        energy_gap=float(gap.sum()) * cell_area,
        relative_gap=float(gap.sum()) / work if work else 0.0,
        allowed=float(may[worst]),
        level=float(level.max()),
    )


def cells_of(
    pressure: Any, gap: Any, displacement: Any, cap: Any, fractions: Any = None, together: int = TOGETHER
) -> Blocks:
    """The cells of one part, from arrays of shape (rows, columns). fractions: of the cap, that cells bear."""

    def blocks() -> Iterator[Cells]:
        for here in blocks_of_rows(pressure.shape[0], values=pressure.shape[1], together=together):
            caps = cap if fractions is None else cap * fractions[here]
            yield Cells(pressure[here], gap[here] + displacement[here], caps)

    return blocks


def columns_of(*certificates: Certificate | None) -> dict[str, float]:
    """Columns of a step from the certificates of its solves, the worst of them; NaN where there is none."""
    there = [certificate for certificate in certificates if certificate is not None]
    return {
        "violation": max((one.violation for one in there), default=math.nan),
        "energy_gap": max((one.energy_gap for one in there), default=math.nan),
        "energy_gap_relative": max((one.relative_gap for one in there), default=math.nan),
    }


def _measure(blocks: Blocks, xp: Any) -> _Part:
    """Measure one part, in three looks at its cells."""
    table = xp.stack([_extremes(cells, xp) for cells in blocks()])
    total, (over, under, highest, lowest) = float(table[:, 0].sum()), table[:, 1:].max(axis=0).tolist()
    lowest = -lowest
    level = _best_level(blocks, total, highest, lowest, xp) if over > -math.inf else lowest
    gap = float(sum(_gap(cells, level) for cells in blocks()))
    return _Part(total, over, under, highest, lowest, level, gap)


def _extremes(cells: Cells, xp: Any) -> Any:
    """Σ p, then the largest p − H, −p, t where p > 0, and −t where p < H; a NaN of a cell makes one a NaN."""
    p, t, cap = cells
    return xp.stack(
        [
            p.sum(),
            (p - cap).max(),
            -p.min(),
            xp.where(p > 0.0, t, -xp.inf).max(),
            xp.where(p < cap, -t, -xp.inf).max(),
        ]
    )


def _best_level(blocks: Blocks, total: float, highest: float, lowest: float, xp: Any) -> float:
    """λ' of a part with a hardness: where the cells below it carry the load at the hardness.

    The slope of the gap in λ' is what the cells below λ' carry at the hardness less the load. Cells with
    t < lowest all bear their hardness, and no cell with t > highest bears anything, so that λ' lies between.
    """
    low, high = min(lowest, highest), max(lowest, highest)
    below, levels, caps = 0.0, [], []
    for _, t, cap in blocks():
        caps_here = xp.broadcast_to(xp.asarray(cap), t.shape)
        below += float(caps_here[t < low].sum())
        there = (t >= low) & (t <= high)
        levels.append(t[there])
        caps.append(caps_here[there])
    t = xp.concatenate(levels)
    if not t.size:
        return lowest if math.isfinite(lowest) else highest
    order = xp.argsort(t)
    carried = below + xp.cumsum(xp.concatenate(caps)[order])
    return float(t[order[min(int(xp.searchsorted(carried, total)), t.size - 1)]])


def _gap(cells: Cells, level: float) -> Any:
    p, t, cap = cells
    lifted, pressed = (p > 0.0) & (t > level), (p < cap) & (t < level)
    room = (cap - p)[pressed]
    return (p[lifted] * (t[lifted] - level)).sum() + (room * (level - t[pressed])).sum()
