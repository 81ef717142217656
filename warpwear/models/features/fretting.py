"""Before a jump over cycles of fretting a contact is asked what slips: all of it, a ring, or nothing."""

import math
from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np

from warpwear import lazy
from warpwear.contact.half_space.solver import HalfSpace, HalfSpaceContact
from warpwear.engine.executor import Field
from warpwear.engine.numbers import Numbers
from warpwear.engine.program import launch_once
from warpwear.engine.state import InFrame
from warpwear.grid import FloatArray
from warpwear.kernels import wear_from_pressure
from warpwear.laws.fretting import Fretting
from warpwear.models.features.feature import Feature, Host, Site

optimize = lazy.module("scipy.optimize")

#: Tolerance of the contact under P*, as of `solver.BoundedPressure`: slips follow from its gaps.
TOLERANCE = 1.0e-9
#: What an approach under P* may be off, over that at which nothing sticks: a rig's yield is looked for.
SAME = 1.0e-9


class CyclicSlip(Feature, name="fretting"):
    """Knows what cells slip in a cycle, and how much of the wear of both bodies is a mean along x.

    All of the contact may slide, by `rigid` [mm] in a cycle; cells slip by lengths of their own beside that,
    4κμ times their gap under P* (`warpwear.laws.fretting`). Those are kept in the field `slips`, and grow by
    what cells lose, so that the contact under P* is solved once where a force keeps it as it is.
    """

    moves_pressure = True
    NUMBERS: ClassVar = ("_jump", "rigid", "force", "border", "_stuck", "_approach", "_first")
    STATE: ClassVar = {
        **dict.fromkeys(("slips", "grown"), InFrame("contact")),
        **dict.fromkeys(NUMBERS, float),
    }
    SCRATCH: ClassVar = ("_solver",)

    def __init__(self, drive: Fretting, site: Site) -> None:
        task, executor = site.task, site.executor
        assert task.modulus is not None  # checked with the study
        self._drive, self._load, self._executor = drive, task.load, executor
        slides = not (self._drive.of_body or self._drive.force)
        #: What cells slip in a cycle by their gaps [mm]; no rows where all slide alike.
        self.slips = executor.zeros(0) if slides else executor.zeros()
        #: By how much they grew in the last jump [mm], and how long that was [mm].
        self.grown = executor.zeros(self.slips.shape[0])
        self._jump = 0.0
        self.pressed = {} if slides else {"slips": self.slips, "grown": self.grown}
        self.yields = None if slides else executor.zeros()
        #: What all cells slide in a cycle [mm].
        self.rigid = self._drive.cycle if slides else 0.0
        #: Amplitudes: of the force [N], and of the displacement at which all of the contact slips [mm].
        self.force, self.border = math.nan, math.nan
        #: Approaches: under P*, of the last contact, and at first touch [mm].
        self._stuck = self._approach = self._first = math.nan
        self._solver: HalfSpace | None = None
        if not slides:
            law: dict[str, Any] = {"boundary": task.boundary, "hardness": task.hardness}
            self._solver = HalfSpace(executor, modulus=task.modulus, tolerance=TOLERANCE, **law)

    def restored(self) -> None:
        """Slide as this drive does, whatever another one did."""
        if self._solver is None:
            self.rigid = self._drive.cycle

    @property
    def window(self) -> int:  # type: ignore[override]
        """Return the cells of a mean of the disc's wear: those of the stroke of what slides."""
        return max(1, min(round(0.5 * self.rigid / self._executor.grid.cell), self._executor.grid.nx))

    @property
    def edge(self) -> int:  # type: ignore[override]
        """Return the cells along an edge that must not be touched: the disc's scar is a stroke longer."""
        return 1 + self.window // 2

    def prepare(self, host: Host, increment: float, removals: tuple[float, float]) -> None:
        """Find what slips in a jump over cycles, and the compliance that its wear lends."""
        host.slides.set(window=self.window)
        host.make_gap()
        if math.isnan(self._approach):
            self.note(host.solve())
        self._look(host.gap, host.slides)
        host.slides.set(growth_ahead=self._ahead(increment), **self.wears(removals))
        if self.yields is not None:
            fields = self.slips, self.grown, self.yields
            launch_once(self._executor, wear_from_pressure.yields, host.slides.array, *fields)

    def note(self, contact: HalfSpaceContact) -> None:
        """Note the approach of a contact under the load."""
        self._approach = contact.approach

    def _look(self, gap: Field, slides: Numbers) -> None:
        """See what slips in a jump that begins with a gap, under a load whose approach was noted.

        slides: what the passes of the step read.
        """
        drive = self._drive
        self._first = float(np.min(self._executor.to_numpy(gap)))
        self.border = drive.kappa * drive.friction * (self._approach - self._first)
        limit = drive.friction * self._load
        if self._solver is None:
            self.force = limit
        elif drive.force is not None:
            self.force = drive.force
            if math.isnan(self._stuck):
                stuck = self._solve(gap, load=self._load - drive.force / drive.friction)
                self._stuck = stuck.approach
                self._see(stuck.gradient_field, stuck.pressure_field, slides)
        else:
            self._displace(gap, limit, slides)

    def _displace(self, gap: Field, limit: float, slides: Numbers) -> None:
        """Find the contact under P* that a drive of a stroke leaves. limit: force at which all slips [N]."""
        drive, per_approach = self._drive, self._drive.kappa * self._drive.friction
        amplitude = 0.5 * drive.stroke
        slid = amplitude - drive.rig * limit - self.border
        if slid >= 0.0:
            self.rigid, self.force, self._stuck = 4.0 * slid, limit, self._first
            self._see(gap, self._executor.zeros(), slides)
            return

        bounds = self._first, self._approach

        def missing(approach: float) -> float:
            """Return what a drive that leaves an approach under P* has left over [mm]."""
            if approach in bounds:  # where nothing sticks, or all
                return slid if approach == self._first else amplitude
            contact = self._solve(gap, approach=approach)
            force = limit - drive.friction * contact.mean_pressure * self._executor.grid.area
            return amplitude - per_approach * (self._approach - approach) - drive.rig * force

        self._stuck = self._approach - amplitude / per_approach
        if drive.rig:
            self._stuck = optimize.brentq(missing, *bounds, xtol=SAME * (self._approach - self._first))
        stuck = self._solve(gap, approach=self._stuck)
        self.rigid = 0.0
        self.force = limit - drive.friction * stuck.mean_pressure * self._executor.grid.area
        self._see(stuck.gradient_field, stuck.pressure_field, slides)

    def _solve(
        self, gap: Field, *, load: float | None = None, approach: float | None = None
    ) -> HalfSpaceContact:
        """Solve the contact under P*, from nothing, so that it is the same whatever was solved before."""
        assert self._solver is not None
        self._solver.forget()
        mean = None if load is None else load / self._executor.grid.area
        return self._solver.solve(gap, mean_pressure=mean, approach=approach, certified=False)

    def _see(self, gap: Field, pressure: Field, slides: Numbers) -> None:
        """Make the slips of the gaps beyond the approach under P*, where no pressure is."""
        slides.set(slip_of_gap=self._drive.slip_of_gap, approach=self._stuck)
        fields = gap, pressure, self.slips, self.grown
        launch_once(self._executor, wear_from_pressure.slip, slides.array, *fields)

    def _ahead(self, increment: float) -> float:
        """Return the part of the last growth of slips that takes them to the end of a jump [mm]."""
        ahead = increment / self._jump if self._jump and not self.rigid else 0.0
        self._jump = 0.0 if self.rigid else increment  # what slides as a whole counts from another place
        return ahead

    def wears(self, removals: tuple[float, float]) -> dict[str, float]:
        """Return what an increment wears where all slides, and by slips, for a `Slide`.

        removals: K ΔL of counter and disc [mm³/N] over the distance that cycles count for.
        """
        cycle = self._drive.cycle
        (counter, disc), slides = removals, self.rigid / cycle
        own = 0.0 if self.yields is None else 1.0 / cycle
        return {
            "k_counter": slides * counter,
            "k_disc": slides * disc,
            "slipping_counter": own * counter,
            "slipping_disc": own * disc,
            # Under a stroke they are made anew in each jump.
            "slip_of_gap": self._drive.slip_of_gap if self._drive.force else 0.0,
        }

    def worn(self, removals: tuple[float, float], row: Mapping[str, float]) -> tuple[float, float]:
        """Return K times what slipped in the mean, of counter and disc [mm³/N]."""
        share = row["slip_mean"] / self._drive.cycle
        return share * removals[0], share * removals[1]

    def row(self, increment: float, total: Mapping[str, float]) -> dict[str, float]:
        """Return what the history has of a jump over an increment [mm]."""
        drive, load, area = self._drive, self._load, self._executor.grid.cell_area
        work, stuck = total["slip_work"] * area, total["stuck"] * area  # [N mm, mm²]
        work += self.rigid * load
        moved = drive.kappa * drive.friction * (self._approach - self._stuck)
        if self.rigid:
            moved = self.border + 0.25 * self.rigid
        elif drive.force is None:
            moved = 0.5 * drive.stroke - drive.rig * self.force
        moved, border = (x if drive.has_displacement else math.nan for x in (moved, self.border))
        energy = drive.friction * work
        return {
            "cycles": increment / drive.cycle if drive.cycle else 0.0,
            "tangential_force": self.force,
            "displacement": moved,
            "displacement_border": border,
            "energy": energy,
            "energy_ratio": energy / (4.0 * self.force * moved),
            "slip_mean": work / load,
            "stick_area": 0.0 if self.rigid else stuck,
        }

    def fields(self, pressure: FloatArray) -> dict[str, FloatArray]:
        """Return what places under a pressure slip in a cycle [mm]."""
        of_cells = self._executor.to_numpy(self.slips) if self.slips.shape[0] else 0.0
        return {"slip": np.where(pressure > 0.0, self.rigid + of_cells, 0.0)}
