"""An independent reference in plain NumPy: slow, short, and it raises rather than return a wrong answer.

Lengths in mm, pressures in MPa, loads in N, wear coefficients in mm²/N. Imports nothing from the package.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

#: Gaps that differ by less are tied [mm].
TIE = 1.0e-12


@dataclass(frozen=True)
class Contact:
    """A solved contact."""

    approach: float  # of a bearing area the highest cell in contact; any value up to the next cell will do
    pressure: FloatArray
    plastic: NDArray[np.bool_]  # cells at hardness
    residual: float  # carried at hardness − asked for


def bearing(gap: FloatArray, load: float, hardness: float, cell: float, tolerance: float) -> Contact:
    """Bearing area: the lowest cells carry H each until they carry the load (thesis eqs 4.8–4.11).

    If a count of cells meets the tolerance, p = F/A on them. If none does because cells tie, the cells below
    carry H and the tied ones share what is missing.
    """
    ordered = np.sort(gap, axis=None)
    one_cell = hardness * cell**2
    counts = np.append(np.flatnonzero(np.diff(ordered) > TIE) + 1, ordered.size)
    nearest = int(counts[np.argmin(np.abs(counts * one_cell - load))])
    if abs(nearest * one_cell - load) < tolerance:
        touching = gap <= ordered[nearest - 1]
        pressure = np.where(touching, load / (nearest * cell**2), 0.0)
        return Contact(float(ordered[nearest - 1]), pressure, touching, nearest * one_cell - load)
    approach = float(ordered[int(load / one_cell)])  # the first cell that is not needed whole
    tied = np.abs(gap - approach) <= TIE
    below = (gap < approach) & ~tied
    share = (load / one_cell - below.sum()) / tied.sum()
    if not 0.0 <= share <= 1.0:
        raise ArithmeticError(f"tied cells would carry {share} of the hardness")
    return Contact(approach, hardness * (below + share * tied), below, 0.0)


def foundation(
    gap: FloatArray, compliance: float | FloatArray, load: float, hardness: float, cell: float
) -> Contact:
    """Capped foundation p = clip((δ − g)/c, 0, H) with h² Σ p = F to 1e-12 F, c per cell or one for all."""
    c = np.broadcast_to(compliance, gap.shape)

    def pressure(base: float, offset: float = 0.0) -> FloatArray:
        return np.clip(((base - gap) + offset) / c, 0.0, hardness)

    low, high = gap.min(), (gap + c * min(hardness, load / cell**2)).max()
    while low < (middle := 0.5 * (low + high)) < high:  # until low and high are neighbouring numbers
        low, high = (middle, high) if pressure(middle).sum() * cell**2 < load else (low, middle)
    elastic = (gap <= low) & (low - gap < hardness * c)
    missing = load / cell**2 - pressure(low).sum()
    offset = missing / (1.0 / c[elastic]).sum() if missing else 0.0  # exact: nothing kinks in between
    found = pressure(low, offset)
    residual = float(found.sum() * cell**2 - load)
    if not abs(residual) <= 1e-12 * load:
        raise ArithmeticError(f"{residual} N of {load} N are left")
    return Contact(float(low + offset), found, found >= hardness, residual)


def stretched(
    gap: FloatArray,
    compliance: float,
    lent: tuple[FloatArray, FloatArray],
    load: float,
    hardness: float,
    cell: float,
) -> Contact:
    """Foundation whose cells yield by p (c + k(p)), k(p) linear in a table and constant beside it."""
    at, k = (np.asarray(column) for column in lent)
    slopes = np.concatenate([[0.0], np.diff(k) / np.diff(at), [0.0]])
    rest = compliance + np.append(k[:1], k) - slopes * np.append(at[:1], at)  # k = rest + slope p

    def pressure(approach: float) -> FloatArray:
        """The root of slope p² + rest p = overlap, of the piece of the table that the overlap is of."""
        overlap = np.maximum(approach - gap, 0.0)
        piece = np.searchsorted(at * (compliance + k), overlap)
        a, b = slopes[piece], rest[piece]
        root = np.sqrt(np.maximum(b * b + 4.0 * a * overlap, 0.0))
        p = np.where(
            b >= 0.0, 2.0 * overlap / np.maximum(b + root, 1e-300), (root - b) / (2.0 * a + (a == 0.0))
        )
        return np.minimum(p, hardness)

    low, high = gap.min(), gap.max() + min(hardness, load / cell**2) * (compliance + k.max())
    while low < (middle := 0.5 * (low + high)) < high:
        low, high = (middle, high) if pressure(middle).sum() * cell**2 < load else (low, middle)
    found = pressure(low)
    return Contact(float(low), found, found >= hardness, float(found.sum() * cell**2 - load))


@dataclass
class Run:
    """A worn contact: fields, the pressure of the last step, and one value a step of every quantity."""

    gap: FloatArray
    wear_counter: FloatArray
    wear_disc: FloatArray
    pressure: FloatArray
    history: dict[str, list[float]] = field(default_factory=dict)


def wear_run(
    gap: FloatArray,
    *,
    load: float,
    hardness: float,
    cell: float,
    wear: tuple[float, float],
    increments: Iterable[float],
    implicit: bool,
    stiffness: float = np.inf,
    factor: float | FloatArray = 1.0,
    tolerance: float = 0.0,
    over_pressure: tuple[FloatArray, FloatArray, FloatArray] | None = None,
) -> Run:
    """Archard wear of both bodies, Δw = K p ΔL each, the disc's ΔL times a factor (eqs 4.16 and 4.22).

    explicit: p of the gap before the step, so c = 1/k. implicit: p of the gap after it, so
    c = 1/k + (K_counter + K_disc factor) ΔL. tolerance: of the bearing area, which c = 0 leaves.
    over_pressure: pressures, and what K of counter and disc are multiplied by at a pressure of the cell.
    """
    run = Run(gap.copy(), np.zeros_like(gap), np.zeros_like(gap), np.zeros_like(gap))
    touched = np.zeros(gap.shape, dtype=bool)
    for increment in increments:
        depth_per_pressure = wear[0] * increment, wear[1] * factor * increment
        c = 1.0 / stiffness + (sum(depth_per_pressure) if implicit else 0.0)
        if over_pressure is not None:
            at, *times = over_pressure
            of_step = np.array(depth_per_pressure)
            lent = at, np.add(*(k * t for k, t in zip(of_step * implicit, times, strict=True)))
            if implicit or np.isfinite(stiffness):
                contact = stretched(run.gap, 1.0 / stiffness, lent, load, hardness, cell)
            else:
                contact = bearing(run.gap, load, hardness, cell, tolerance)
            depth_per_pressure = tuple(
                k * np.interp(contact.pressure, at, t) for k, t in zip(of_step, times, strict=True)
            )
        elif np.any(c):
            contact = foundation(run.gap, c, load, hardness, cell)
        else:
            contact = bearing(run.gap, load, hardness, cell, tolerance)
        p = run.pressure = contact.pressure
        run.wear_counter += depth_per_pressure[0] * p
        run.wear_disc += depth_per_pressure[1] * p
        run.gap = gap + run.wear_counter + run.wear_disc
        touched |= p > 0.0
        along, across = (np.ptp(np.flatnonzero(touched.any(axis))) + 1 for axis in (1, 0))
        row = {
            "approach": contact.approach,
            "load_residual": contact.residual,
            "area_contact": np.count_nonzero(p) * cell**2,
            "area_plastic": np.count_nonzero(contact.plastic) * cell**2,
            "area_touched": np.count_nonzero(touched) * cell**2,
            "patch_along": along * cell,
            "patch_across": across * cell,
            "area_nominal": np.pi / 4.0 * along * across * cell**2,
            "pressure_mean": p[p > 0.0].mean(),
            "pressure_std": p[p > 0.0].std(),
            "pressure_max": p.max(),
            "wear_volume_counter": run.wear_counter.sum() * cell**2,
            "wear_volume_disc": run.wear_disc.sum() * cell**2,
            "wear_depth_counter": run.wear_counter.max(),
            "wear_depth_disc": run.wear_disc.max(),
        }
        for name, value in row.items():
            run.history.setdefault(name, []).append(float(value))
    return run


def counter_gap(x: FloatArray, y: FloatArray, radius: float, heights: float | FloatArray = 0.0) -> FloatArray:
    """Gap between a ball and a rough disc from the mean planes, R − √(R² − r²) without its cancellation."""
    squared = x[:, None] ** 2 + y[None, :] ** 2
    sag = squared / (radius + np.sqrt(radius**2 - squared)) if np.isfinite(radius) else 0.0 * squared
    return sag - heights


def truncation(gap: FloatArray, volume: float, cell: float) -> tuple[float, int]:
    """The plane δ that cuts a volume off the gap, h² Σ max(δ − g, 0) = V, and how many cells it cuts."""
    ordered = np.sort(gap, axis=None)
    steps = np.arange(1, ordered.size) * np.diff(ordered)  # volume / h² from one cell to the next
    reached = np.concatenate([[0.0], np.cumsum(steps)])
    count = int(np.searchsorted(reached, volume / cell**2))  # cells lower than δ
    if not 0 < count <= ordered.size:
        raise ArithmeticError(f"{volume} mm³ cannot be cut off")
    return float(ordered[count - 1] + (volume / cell**2 - reached[count - 1]) / count), count


@dataclass(frozen=True)
class Layered:
    """A body of layers: depths at which each begins, K and hardness of each; the last goes on for ever."""

    begins: tuple[float, ...]
    wear: tuple[float, ...]
    hardness: tuple[float, ...]

    def at(self, depth: FloatArray) -> NDArray[np.int64]:
        """The layer at a worn depth."""
        return np.searchsorted(self.begins, depth, side="right") - 1

    def worn(self, depth: float, load_distance: float) -> float:
        """The depth to which ∫ p dL wears one cell, layer by layer."""
        for number, k in enumerate(self.wear):
            end = self.begins[number + 1] if number + 1 < len(self.begins) else np.inf
            if depth >= end:
                continue
            if load_distance < (end - depth) / k:
                return depth + k * load_distance
            load_distance -= (end - depth) / k
            depth = end
        raise ArithmeticError("no layer is left")


def layered_run(
    gap: FloatArray,
    bodies: tuple[Layered, Layered],
    *,
    load: float,
    increments: Iterable[float],
    cell: float,
    own: float = 0.0,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Wear of counter-body and disc that lie still, and the last pressure, implicit by K as a step begins.

    A cap is that of the softer of both layers that meet; own: compliance beside the wear of a step [mm³/N].
    """  # fmt: skip
    worn, p = np.zeros((2, *gap.shape)), gap
    for slid in increments:
        layers = [body.at(depth) for body, depth in zip(bodies, worn, strict=True)]
        k, caps = ([np.array(getattr(body, of))[layer] for body, layer in zip(bodies, layers, strict=True)]
                   for of in ("wear", "hardness"))  # fmt: skip
        compliance, cap, here = own + sum(k) * slid, np.minimum(*caps), gap + worn.sum(axis=0)
        low, high = here.min(), (here + compliance * cap).max()
        while low < (middle := 0.5 * (low + high)) < high:
            p = np.clip((middle - here) / compliance, 0.0, cap)
            low, high = (middle, high) if p.sum() * cell**2 < load else (low, middle)
        for body, depth in zip(bodies, worn, strict=True):
            for place in zip(*np.nonzero(p), strict=True):
                depth[place] = body.worn(float(depth[place]), float(p[place] * slid))
    return worn[0], worn[1], p
