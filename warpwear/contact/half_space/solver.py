"""Two bodies in contact whose surfaces deform together are one elastic–plastic half-space, 0 ≤ p ≤ H.

The pressure minimises ½ p·(G + c)p + p·g at a given mean pressure or approach; see `search`.

A contact of many cells begins with the pressure on cells twice as wide, which is solved roughly. The gap of a
wide cell is the mean of its four, so that the long waves are those of the fine grid, and its pressure is that
of all four. A pair of transforms costs a quarter there, and what a search spends on the long waves, which
decide where load goes, it then need not spend on the fine grid.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from warpwear.contact.balance import TOLERANCE as LOAD_TOLERANCE
from warpwear.contact.certificate import Certificate
from warpwear.contact.half_space.influence import Influence
from warpwear.contact.half_space.search import Search
from warpwear.contact.half_space.transforms import release
from warpwear.engine.executor import Executor, Field, arguments
from warpwear.engine.program import Program, launch_once
from warpwear.engine.state import InFrame
from warpwear.errors import ConvergenceError, InputError
from warpwear.grid import FloatArray, Grid
from warpwear.kernels.half_space import passes
from warpwear.kernels.half_space.solve import CONVERGED, UNBALANCED, Request, SearchRules

#: Largest violation of complementarity, over the rms height of the gap.
TOLERANCE = SearchRules.tolerance
MAX_ITERATIONS = SearchRules.iterations
#: Cells along each side of a grid from which wide ones pay.
LEAST_SIDE = 256
#: On a GPU, where a solve on wide cells takes a graph of its own, once.
LEAST_SIDE_ON_GPU = 4096
#: Fields of the fine grid that a solver on wide cells, and those that it starts from, take of a GPU.
FIELDS_ON_GPU = 6.0
#: Fields that a search on a GPU takes for itself afterwards.
FIELDS_OF_SEARCH = 10.0
#: Tolerance of the contact on wide cells, as of `BoundedPressure`, and its iterations at most.
ROUGH = 1.0e-3
ROUGH_ITERATIONS = 100
#: Tolerance from which single precision may be enough for a whole search.
LOOSE = 1.0e-5
#: Response to the waves by which cells of unlike compliance are preconditioned, over the shortest's.
LONGER = 4.0


@dataclass(frozen=True)
class HalfSpaceContact:
    """Holds a solved contact. The fields are the solver's own and last until its next solve."""

    approaches: FloatArray  # rigid, from the mean planes: of all cells, or row by row [mm]
    mean_pressure: float  # [MPa]
    violation: float  # largest violation of complementarity, over the rms height
    cells_in_contact: int  # with p > 0
    iterations: int
    transforms: int  # pairs of Fourier transforms of the search; a certificate takes one more
    pressure_field: Field
    gradient_field: Field  # gap after deformation and wear, from the mean planes [mm]
    executor: Executor
    allowed: FloatArray  # violation that may be left, of each part [mm]
    certificate: Certificate | None = None

    @property
    def approach(self) -> float:
        """Return the one approach that all cells share [mm]."""
        return float(self.approaches.item())

    @property
    def pressure(self) -> FloatArray:
        """Return the pressure [MPa], shape (nx, ny)."""
        return self.executor.to_numpy(self.pressure_field)


def worst_of(violation: FloatArray, scale: FloatArray) -> float:
    """Return the largest violation over the scale of its part."""
    return float(np.divide(violation, scale, out=np.zeros_like(scale), where=violation > 0.0).max())


class BoundedPressure:
    """Solves contacts under one operator; each solve starts from the last one's pressure.

    hardness: H [MPa]. tolerance: of the largest violation of complementarity (|t − λ| where 0 < p < H, λ − t
    where p = 0, t − λ where p = H; t gap after deformation, λ approach), over the rms height of the gap. The
    load is met to 1e-12. rules: of the search, but for the tolerance and the iterations.
    """

    STATE: ClassVar = {"pressure_field": InFrame("contact"), "started": bool}
    SCRATCH: ClassVar = ("_fields", "_search", "operator", "_searched")

    def __init__(
        self,
        executor: Executor,
        influence: Influence,
        *,
        hardness: float = math.inf,
        tolerance: float = TOLERANCE,
        max_iterations: int = MAX_ITERATIONS,
        rules: SearchRules | None = None,
    ) -> None:
        self._executor = executor
        self._hardness = hardness
        self._rules = replace(rules or SearchRules(), tolerance=tolerance, iterations=max_iterations)
        #: What displaces by a pressure.
        self.operator = influence
        names = "pressure", "gradient", "trial", "step", "response"
        self._fields = {name: executor.zeros() for name in names}
        self._search: Search | None = None
        #: Gap, cap ratios, compliances of cells and groups that the search is for.
        self._searched: tuple[Any, ...] = ()
        #: Of the next solves, see the class.
        self.tolerance = tolerance
        #: Whether the next solve starts from what `pressure_field` holds; else from nothing.
        self.started = False

    def forget(self) -> None:
        """Start the next solve from nothing."""
        self.started = False

    @property
    def pressure_field(self) -> Field:
        """Return where the next solve starts, to be changed in place between 0 and H [MPa]."""
        return self._fields["pressure"]

    def solve(
        self,
        gap: Field,
        *,
        mean_pressure: float | FloatArray | None = None,
        approach: float | None = None,
        compliance: float = 0.0,
        streak_compliance: float = 0.0,
        streak_window: int | None = None,
        certified: bool | None = True,
        then: Callable[[Search], Program] | None = None,
        **own: Field | None,
    ) -> HalfSpaceContact:
        """Solve the contact at a mean pressure [MPa] or at an approach [mm].

        mean_pressure: of all cells; or an array, of each row visited, under an operator that ties no rows to
        each other: each then has an approach and an rms height of its own, and may carry nothing. gap: from
        the mean planes [mm]. compliance: c of every cell beside the half-space's [mm/MPa]: K ΔL of both
        bodies for an implicit step of wear. streak_compliance: K ΔL of a body that the other slides over,
        under pressures averaged along x, see `Influence`. streak_window: cells of that mean; None: the whole
        line. certified: whether to certify the pressure, for one more pair of transforms; None: if it is
        found from nothing. then: the program that follows a search before the host looks. own: fields by
        which cells differ: cap_ratio, of the hardness, 0 < ratio ≤ 1, that they bear; yields, compliance that
        they have beside these [mm/MPa]; streak_yields, that of streaks of each, instead of one of all.

        Raises InputError for a load that the hardness cannot carry, ConvergenceError where the tolerance is
        not met.
        """
        loads = self._loads(mean_pressure, approach)
        certified = not self.started if certified is None else certified
        search = self.search_for(gap, own, groups=isinstance(mean_pressure, np.ndarray))
        if own.get("streak_yields") is not None:
            search.streak(streak_window or self._executor.grid.nx)
        request = self.request(compliance, streak_compliance, streak_window, tolerance=self.tolerance)
        request |= {Request.AT_LOAD: loads is not None, Request.CERTIFIED: certified}
        self.started = False
        values, follows = np.full(1, approach) if loads is None else loads, then and then(search)
        status = search.run(request, values, follows)
        if status == UNBALANCED and not request[Request.ANEW]:
            # No shift of a pressure far below the load may reach it; of springs under the gap one does.
            certified = True
            request |= {Request.ANEW: True, Request.RENEWED: True, Request.CERTIFIED: True}
            status = search.run(request, values, follows)
        contact = self._contact_of(search, status)
        if certified:
            contact = replace(contact, certificate=search.certificate())
        if contact.certificate and contact.certificate.fault:
            raise ConvergenceError(
                f"the pressure of the half-space contact cannot be certified: {contact.certificate.fault}."
            )
        self.started = True
        return contact

    def displacement(self) -> Field:
        """Return the displacement under the pressure that was certified last [mm]; lost in a solve."""
        return self._fields["response"]

    def request(
        self, own: float, streak: float, window: int | None, *, tolerance: float
    ) -> dict[Request, float]:
        """Set compliances, see `Influence.set_compliance`; return what a search under them is asked."""
        self.operator.set_compliance(own, streak, window)
        return {
            Request.RESPONSE: self.operator.shortest_response + own,
            Request.LONGER_RESPONSE: LONGER * self.operator.shortest_response + own,
            Request.AT_LOAD: True,
            Request.ANEW: not self.started,
            Request.ROUGH: tolerance >= LOOSE,
            Request.TOLERANCE: tolerance,
        }

    def search_for(self, gap: Field, own: Mapping[str, Field | None], *, groups: bool) -> Search:
        """Return the search for contacts with a gap, caps and compliances; it is made once for each."""
        asked = gap.ptr, {name: field.ptr for name, field in own.items() if field is not None}, groups
        if self._search is None or asked != self._searched:
            self._search = None  # and its memory, before the next takes its own
            self._search = Search(
                self._executor,
                self.operator,
                hardness=self._hardness,
                rules=self._rules,
                fields={"gap": gap, **self._fields},
                **own,
                groups=self._executor.grid.nx if groups else 1,
            )
            self._searched = asked
        return self._search

    def _contact_of(self, search: Search, status: int) -> HalfSpaceContact:
        """Sum up what a search has left. Raises ConvergenceError where it has not come to its end."""
        groups, numbers = search.groups, search.numbers
        if status == UNBALANCED:
            raise ConvergenceError(
                f"the load balance of the half-space missed {self._rules.rough_balance:g} of the load."
            )
        if status != CONVERGED:
            violation = worst_of(groups["violation"], groups["scale"])
            raise ConvergenceError(
                f"the half-space contact did not converge in {numbers['iteration']} iterations: "
                f"complementarity is violated by {groups['violation'].max():.3g} mm, "
                f"{violation:.3g} of the rms height (allowed {self.tolerance:g})."
            )
        return HalfSpaceContact(
            approaches=groups["level"].copy(),
            mean_pressure=float(groups["total"].sum()) / self.operator.cells,
            violation=worst_of(groups["violation"], groups["scale"]),
            cells_in_contact=round(float(groups["touching"].sum())),
            iterations=int(numbers["before"] + numbers["iteration"]),
            transforms=int(numbers["transforms_before"] + numbers["transforms"]),
            pressure_field=self._fields["pressure"],
            gradient_field=self._fields["gradient"],
            executor=self._executor,
            allowed=groups["allowed"].copy(),
        )

    def _loads(self, mean_pressure: float | FloatArray | None, approach: float | None) -> FloatArray | None:
        """Return the sums of pressures that the groups are to carry [MPa]; None at an approach."""
        if mean_pressure is None:
            return None
        means = np.atleast_1d(mean_pressure)
        most = self._hardness * (1.0 + LOAD_TOLERANCE)  # rounding makes a load that is just carried larger
        wrong = means if not means.any() else means[~((means >= 0.0) & (means <= most))]
        if wrong.size:
            raise InputError(
                f"a mean pressure of {wrong[0]:g} MPa is not possible; it must be positive and at most the "
                f"hardness, {self._hardness:g} MPa."
            )
        cells = self.operator.cells
        if isinstance(mean_pressure, np.ndarray):
            cells //= self._executor.grid.nx
        return np.minimum(means, self._hardness) * cells


class HalfSpace(BoundedPressure):
    """Solves contacts of one grid, as `BoundedPressure` says.

    modulus, boundary, datum: as of `Influence`. options: of `BoundedPressure`.
    """

    def __init__(
        self,
        executor: Executor,
        *,
        modulus: float,
        boundary: str = "periodic",
        datum: float | None = None,
        **options: Any,
    ) -> None:
        datum = executor.grid.nx * executor.grid.cell if datum is None else datum
        elastic: dict[str, Any] = {"modulus": modulus, "boundary": boundary, "datum": datum}
        self._like = elastic | {name: options[name] for name in ("hardness", "rules") if name in options}
        #: The solver on wide cells, and its gap, cap ratios and compliances, as far as there are such.
        self._wide: HalfSpace | None = None
        self._wide_fields: dict[str, Field] = {}
        super().__init__(executor, Influence(executor, **elastic), **options)

    def solve(self, gap: Field, *, certified: bool | None = True, **where: Any) -> HalfSpaceContact:
        """Solve a contact as `BoundedPressure` does, from that on cells twice as wide if from nothing."""
        begins = not self.started
        transforms = self._start(gap, **where) if begins and wide_cells_pay(self._executor) else 0
        certified = begins if certified is None else certified
        contact = super().solve(gap, certified=certified, **where)
        return replace(contact, transforms=contact.transforms + transforms)

    def _start(self, gap: Field, *, streak_window: int | None = None, then: Any = None, **where: Any) -> int:
        """Start from the contact on cells twice as wide, of whose transforms four count as one."""
        fine, fields = self._executor, {"gap": gap}
        where.pop("streak_yields", None)  # it begins well enough without
        fields |= {name: where.pop(name) for name in ("cap_ratio", "yields") if where.get(name) is not None}
        if self._wide is None or self._wide_fields.keys() != fields.keys():
            # Of an odd number of cells the last wide one goes over the edge.
            coarse = Grid(-(-fine.grid.nx // 2), -(-fine.grid.ny // 2), 2.0 * fine.grid.cell)
            self._wide = HalfSpace(
                Executor(coarse, device=str(fine.device), threads=fine.threads),
                tolerance=ROUGH,
                max_iterations=ROUGH_ITERATIONS,
                **self._like,
            )
            self._wide_fields = {name: self._wide._executor.zeros() for name in fields}
        wide, targets = self._wide, self._wide_fields
        wide.forget()
        if streak_window is not None:
            where["streak_window"] = max(streak_window // 2, 1)
        try:
            for name, field in fields.items():
                carry(passes.restrict, wide._executor, field, targets[name], fine=fine.grid)
            contact = wide.solve(certified=False, **targets, **where)
        except (ConvergenceError, InputError):
            return 0
        carry(passes.prolong, fine, contact.pressure_field, self.pressure_field, fine=fine.grid)
        self.started, transforms = True, -(-contact.transforms // 4)
        if memory_is_short(fine):
            self._wide, self._wide_fields = None, {}
            del wide, targets, contact
            release(fine.device)
        return transforms


def wide_cells_pay(executor: Executor) -> bool:
    """Tell whether wide cells make a solve shorter, and there is room for them."""
    device, grid = executor.device, executor.grid
    if device.is_cpu:
        return min(grid.shape) >= LEAST_SIDE
    return min(grid.shape) >= LEAST_SIDE_ON_GPU and device.free_memory > FIELDS_ON_GPU * 8 * grid.cells


def memory_is_short(executor: Executor) -> bool:
    """Tell whether a solver on wide cells takes memory worth more than the time of making it anew."""
    device = executor.device
    return device.is_cpu or device.free_memory < FIELDS_OF_SEARCH * 8 * executor.grid.cells


def carry(kernel: Any, executor: Executor, field: Field, target: Field, *, fine: Grid) -> None:
    """Give the field of an executor what another one holds, by a kernel: `restrict` or `prolong`.

    A wide cell gets the mean of its four, `PADDING` where one of them is that, and each of them its value.
    fine: grid of the narrow cells.
    """
    transfer = arguments(passes.Transfer, field=field, target=target, columns=fine.ny)
    launch_once(executor, kernel, transfer)
