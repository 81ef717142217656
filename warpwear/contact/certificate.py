"""A certificate tells what a pressure violates, and how far its energy can lie above the least.

It is reckoned from the pressure that is returned and the gap which that leaves, made anew, by passes and
decisions of the device. Nothing that the search believes goes into it but the approach.
"""

import math
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
import warp as wp

from warpwear.contact.balance import TOLERANCE
from warpwear.engine.executor import Arguments, Executor, arguments
from warpwear.engine.program import Program
from warpwear.grid import FloatArray
from warpwear.kernels.cells import NONE
from warpwear.kernels.half_space import certificate as kernels

#: Load that a certified pressure may miss, relatively: twice what a search allows, which sums otherwise.
LOAD_TOLERANCE = 2.0 * TOLERANCE


@dataclass(frozen=True)
class Certificate:
    """Tells what a pressure p between 0 and H is worth that was solved for a load or at an approach λ.

    t is the gap after deformation, from the mean planes, so that t − λ is what lies between the bodies. The
    conditions are t = λ where 0 < p < H, t ≥ λ where p = 0 and t ≤ λ where p = H.

    Attributes
    ----------
    violation : float
        Largest breach of the conditions above, divided by the rms gap before contact.
    allowed : float
        What may be left of it, the tolerance or, where that is more, what rounding shows.
    penetration : float
        Of the bodies where p < H, deepest, a length.
    load_residual : float
        Load over the one asked for, − 1; 0 at an approach.
    beyond_bounds : float
        By how much a pressure is negative or exceeds H.
    energy_gap : float
        Σ p max(t − λ', 0) + (H − p) max(λ' − t, 0), times the area of a cell, with the λ' that makes it least
        (without a hardness the smallest t, and the first term alone). No other pressure between the bounds
        under the same load has an energy that is lower by more.
    relative_gap : float
        That over load times rms height.
    level : float
        The λ', the largest of several parts.

    Notes
    -----
    For the energy ½ p·Ap + p·g is convex and t = Ap + g its gradient, so that any such q has at least the
    energy of p plus t·(q − p), which is (t − λ')·(q − p) as Σ q = Σ p; and of that no cell gives less than
    −p (t − λ') where t > λ' and −(H − p)(λ' − t) where t < λ'. There is no factor ½, as the bound uses the
    tangent and not the parabola.
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

    @classmethod
    def of(cls, groups: Any, *, cell_area: float) -> Self:
        """Sum up what kernels have proven of groups of rows, by the names of `Proven`."""
        loads, allowed, scale = groups["load"], groups["allowed"], groups["scale"]
        deepest = groups["approach"] - groups["lowest"]
        violation = np.maximum(np.maximum(groups["highest"] - groups["approach"], deepest), 0.0)
        total = groups["total"]
        off = np.divide(total, loads, out=1.0 + total, where=loads > 0.0) - 1.0
        off[loads < 0.0] = 0.0
        relative, may = (
            np.divide(v, scale, out=np.zeros_like(scale), where=v > 0.0) for v in (violation, allowed)
        )
        worst = int(np.argmax(np.where(np.isnan(violation), np.inf, violation - allowed)))
        gap, work = float(groups["gap"].sum()), float((total * scale).sum())
        return cls(
            violation=math.nan if np.isnan(violation).any() else float(relative[worst]),
            penetration=float(np.maximum(deepest, 0.0).max()),
            load_residual=float(off[np.argmax(np.abs(off))]),
            beyond_bounds=float(np.maximum(np.maximum(groups["over"], groups["under"]), 0.0).max()),
            energy_gap=gap * cell_area,
            relative_gap=gap / work if work else 0.0,
            allowed=float(may[worst]),
            level=float(groups["level"].max()),
        )

    @property
    def fault(self) -> str:
        """Return what keeps the pressure from being certified, as half a sentence, or an empty one."""
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


class Certifier:
    """Certifies a pressure on the device, as a part of a program.

    fields: `half_space.solve.Fields`, with the response to the pressure. groups: 1, all rows together, or as
    many as the executor has rows, each with a load and an approach of its own. visited: how many rows count,
    the first ones; an array of one number.
    """

    def __init__(
        self,
        executor: Executor,
        fields: Arguments,
        *,
        groups: int = 1,
        visited: Any = None,
    ) -> None:
        self._executor, device, rows = executor, executor.device, executor.grid.nx
        self._slots = rows if groups > 1 else executor.slots_of(rows)
        self._program: Program | None = None
        #: For kernels.
        self.arguments = arguments(
            kernels.Proof,
            device,
            columns=executor.grid.ny,
            fields=fields,
            visited=wp.full(1, rows, dtype=wp.int32, device=device) if visited is None else visited,
            groups=groups,
            table=(kernels.LINES, self._slots),
        )

    def add_to(self, program: Program, chunks: Any = None) -> None:
        """Certify in a program the pressures of groups, by what is known of them."""
        proof = self.arguments

        def look(kernel: Any) -> None:
            program.launch(kernel, proof, slots=self._slots, chunks=chunks)

        look(kernels.extremes)
        program.decide(kernels.bracket, proof)
        if proof.fields.cap < NONE:
            with program.loop(proof.searching):
                look(kernels.carried_at)
                program.decide(kernels.narrow, proof)
        look(kernels.excess)
        program.decide(kernels.prove, proof)

    def at(self, *, load: float | FloatArray | None, **numbers: float | FloatArray) -> Certificate:
        """Certify the pressure now, at a load Σ p [MPa] or, with None, without one.

        numbers: of one group or of each, approach, scale and allowed violation, as of `Proven` [mm].
        """
        groups = self.arguments.groups
        values = groups.numpy()
        for name, value in {**numbers, "load": -1.0 if load is None else load}.items():
            values[name] = value
        groups.assign(values)
        if self._program is None:
            self._program = Program(self._executor, records=2)
            self.add_to(self._program)
        self._program.run()
        return Certificate.of(groups.numpy(), cell_area=self._executor.grid.cell_area)


def columns_of(*certificates: Certificate | None) -> dict[str, float]:
    """Return a step's columns from its solves' certificates, the worst of them; NaN where there is none."""
    names = {"violation": "violation", "energy_gap": "energy_gap", "energy_gap_relative": "relative_gap"}
    there = [certificate for certificate in certificates if certificate is not None]
    return {name: max((getattr(c, of) for c in there), default=math.nan) for name, of in names.items()}
