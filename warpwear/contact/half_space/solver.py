"""The elastic–plastic half-space: contact of two bodies whose surfaces deform together, 0 ≤ p ≤ H.

The pressure minimises ½ p·(G + c)p + p·g at a given mean pressure or approach; see `search`.
"""

import math
from dataclasses import replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from warpwear.contact.balance import TOLERANCE as LOAD_TOLERANCE
from warpwear.contact.certificate import Certificate
from warpwear.contact.half_space import nested
from warpwear.contact.half_space.contact import HalfSpaceContact, residual_of, worst_of
from warpwear.contact.half_space.influence import Influence, Operator
from warpwear.contact.half_space.on_gpu import DeviceSearch
from warpwear.contact.half_space.passes import Iterate
from warpwear.contact.half_space.search import Search
from warpwear.contact.half_space.transforms import release
from warpwear.engine.executor import Executor, Field
from warpwear.errors import ConvergenceError, InputError
from warpwear.grid import FloatArray
from warpwear.kernels.gpu.half_space.solve import CONVERGED, Told

#: Largest violation of complementarity, over the rms height of the gap.
TOLERANCE = 1.0e-6
MAX_ITERATIONS = 1000
#: Smaller differences of displacements, relative to them, are those of the last digits.
ROUNDING = 16.0 * float(np.finfo(np.float64).eps)
#: Error of the gradient, over the violation left, from which it is made anew.
DRIFT = 0.2
#: Tolerance from which single precision may be enough for a whole search.
LOOSE = 1.0e-5
#: Times that a search goes on from its own result where that cannot be certified.
RENEWALS = 3


class BoundedPressure:
    """Solves contacts under one operator; each solve starts from the last one's pressure.

    hardness: H [MPa]. tolerance: of the largest violation of complementarity (|t − λ| where 0 < p < H, λ − t
    where p = 0, t − λ where p = H; t gap after deformation, λ approach), over the rms height of the gap. The
    load is met to 1e-12.
    """

    STATE: ClassVar = {"pressure_field": Field, "_started": bool}

    def __init__(
        self,
        executor: Executor,
        influence: Operator,
        *,
        hardness: float = math.inf,
        tolerance: float = TOLERANCE,
        max_iterations: int = MAX_ITERATIONS,
    ) -> None:
        if not hardness > 0.0:
            raise InputError(f"contact.hardness = {hardness:g} MPa is not possible; it must be positive.")
        self._executor = executor
        self._hardness = hardness
        self._tolerance = tolerance
        self._max_iterations = max_iterations
        self._influence = influence
        self._iterate = Iterate(executor, influence, hardness)
        self._started = False
        #: Displacement under the pressure that was certified last, where a device has made it.
        self._displaced: Any = None

    @property
    def on_device(self) -> DeviceSearch | None:
        """What makes whole solves at a load, where there is that."""
        return None

    @property
    def started(self) -> bool:
        """Whether the next solve has a pressure to start from."""
        return self._started

    def forget(self) -> None:
        """Start the next solve from nothing."""
        self._started = False

    def go_on(self) -> None:
        """Start the next solve from what `pressure_field` holds."""
        self._started = True

    @property
    def pressure_field(self) -> Field:
        """Where the next solve starts after `go_on`, to be changed in place between 0 and H [MPa]."""
        return self._iterate.pressure

    def solve(
        self,
        gap: Field,
        *,
        mean_pressure: float | FloatArray | None = None,
        approach: float | None = None,
        compliance: float = 0.0,
        streak_compliance: float = 0.0,
        streak_window: int | None = None,
        parts: Field | None = None,
        certified: bool | None = True,
    ) -> HalfSpaceContact:
        """Solve the contact at a mean pressure [MPa] or at an approach [mm].

        mean_pressure: of all cells; or an array, of each row visited, under an operator that ties no rows to
        each other: each then has an approach and an rms height of its own, and may carry nothing. gap: from
        the mean planes [mm]. compliance: c of every cell beside the half-space's [mm/MPa]: K ΔL of both
        bodies for an implicit step of wear. streak_compliance: K ΔL of a body that the other slides over,
        under pressures averaged along x, see `Influence`. streak_window: cells of that mean; None: the whole
        line. parts: of the hardness, 0 < part ≤ 1, that cells bear; None: all of it. certified: whether to
        certify the pressure, for one more pair of transforms; None: if it is found from nothing.

        Raises InputError for a load that the hardness cannot carry, ConvergenceError where the tolerance is
        not met.
        """
        asked = self._asked(mean_pressure, approach)
        self._iterate.set_parts(parts)
        compliances = compliance, streak_compliance, streak_window
        certified = not self._started if certified is None else certified
        transforms = 0 if self._started else self._start(gap, asked, approach, compliances, parts)
        iterations = 0
        for renewal in range(1 + RENEWALS):
            search = None if asked is None or self._iterate.parts > 1 else self.on_device
            if search is not None and asked is not None:
                contact = self._solve_on(search, gap, float(asked.item()), compliances, parts)
            else:
                rough = self._tolerance >= LOOSE and not renewal
                contact = self._search(gap, asked, approach, compliances, rough)
            iterations, transforms = iterations + contact.iterations, transforms + contact.transforms
            contact = replace(contact, iterations=iterations, transforms=transforms)
            if not certified:
                return contact
            certificate = self.certificate_of(gap, contact, asked, compliances)
            if not certificate.fault:
                return replace(contact, certificate=certificate)
            # What the search added up has drifted: it goes on from the gradient made anew.
        self._started = False
        raise ConvergenceError(
            f"the pressure of the half-space contact cannot be certified: {certificate.fault}."
        )

    def _start(
        self,
        gap: Field,
        asked: FloatArray | None,
        approach: float | None,
        compliances: tuple[float, float, int | None],
        parts: Field | None,
    ) -> int:
        """Find a first pressure, where there is a way to; the pairs of transforms that it took."""
        return 0

    def certificate_of(
        self,
        gap: Field,
        contact: HalfSpaceContact,
        asked: FloatArray | None,
        compliances: tuple[float, float, int | None],
    ) -> Certificate:
        """Certify the pressure field as it stands, at the approaches of a contact. It does not change.

        asked: Σ p of each part [MPa]; None at an approach. compliances: own, streak and window, as of the
        solve of the contact.
        """
        displaced = self._displaced = None
        if asked is not None and self._iterate.parts == 1 and self.on_device is not None:
            displaced = self._displaced = self.on_device.displacement()
        else:
            self._influence.set_compliance(*compliances)
        terms = {"approaches": contact.approaches, "scale": contact.scale, "allowed": contact.allowed}
        return self._iterate.certificate(gap, asked, displaced=displaced, **terms)

    def displacement(self) -> Any:
        """Displacement under the pressure that was certified last [mm]; lost in a solve.

        Where a device made the whole solve it is an array of that, shape (nx, ny); else a field.
        """
        return self._iterate.fields["response"] if self._displaced is None else self._displaced

    def _search(
        self,
        gap: Field,
        asked: FloatArray | None,
        approach: float | None,
        compliances: tuple[float, float, int | None],
        rough: bool,
    ) -> HalfSpaceContact:
        """Search as `solve` says, pass by pass. rough: begin in single precision."""
        cells, compliance = self._iterate.cells, compliances[0]
        self._influence.set_compliance(*compliances)
        done = self._influence.transforms
        moments = self._iterate.moments(gap)
        response = self._influence.shortest_response + compliance
        stiffness = 1.0 / response
        if not self._started:
            level = moments.mean if approach is None else np.full(1, approach)
            unit = stiffness * (moments.mean - moments.lowest)
            carried = self._iterate.foundation(gap, stiffness=stiffness, level=level)
            self._iterate.take_trial(
                np.zeros(1) if asked is None else self._iterate.balance(asked, *carried, unit=unit)
            )
            self._started = True
        search = Search(self._iterate, asked, approach, stiffness)
        state = self._iterate.begin(gap, single=rough)
        for iteration in range(self._max_iterations + 1):
            level = search.level(state)
            violation = np.maximum(np.maximum(state.highest - level, level - state.lowest), 0.0)
            yielded = np.abs(level) + response * state.total / cells
            scale = np.where(moments.rms > 0.0, moments.rms, yielded)
            allowed = np.maximum(self._tolerance * scale, ROUNDING * yielded)
            off = residual_of(state.total, asked)
            loaded = abs(off) <= LOAD_TOLERANCE
            if self._iterate.drift > DRIFT * max(float(violation.min()), float(allowed.min())):
                state = self._iterate.begin(gap)
                continue
            if loaded and (violation <= allowed).all():
                return HalfSpaceContact(
                    approaches=level,
                    mean_pressure=float(state.total.sum()) / self._influence.cells,
                    violation=worst_of(violation, scale),
                    load_residual=off,
                    cells_in_contact=round(float(state.touching.sum())),
                    iterations=iteration,
                    transforms=self._influence.transforms - done,
                    pressure_field=self._iterate.pressure,
                    gradient_field=self._iterate.gradient,
                    executor=self._executor,
                    cells=self._influence.cells,
                    scale=scale,
                    allowed=allowed,
                )
            moved = search.move(state, level, loaded=loaded)
            if moved is None:
                break
            state = moved
        self._started = False
        raise self._not_converged(iteration, float(violation.max()), worst_of(violation, scale))

    def _not_converged(self, iterations: int, violation: float, relative: float) -> ConvergenceError:
        return ConvergenceError(
            f"the half-space contact did not converge in {iterations} iterations: complementarity is "
            f"violated by {violation:.3g} mm, {relative:.3g} of the rms height (allowed {self._tolerance:g})."
        )

    def _solve_on(
        self,
        search: DeviceSearch,
        gap: Field,
        asked: float,
        compliance: tuple[float, float, int | None],
        parts: Field | None,
    ) -> HalfSpaceContact:
        """Solve as `solve` does, in one launch."""
        stiffness = 1.0 / (self._influence.shortest_response + compliance[0])
        anew, self._started = not self._started, False
        found = search.solve(
            gap, asked=asked, stiffness=stiffness, compliance=compliance, anew=anew, parts=parts
        )
        violation = found[Told.VIOLATION]
        relative = violation / found[Told.SCALE] if violation else 0.0
        if found[Told.STATUS] != CONVERGED:
            raise self._not_converged(round(found[Told.ITERATION]), violation, relative)
        self._started = True
        scale = found[Told.SCALE]
        yielded = abs(found[Told.LEVEL]) + found[Told.TOTAL] / self._influence.cells / stiffness
        return HalfSpaceContact(
            approaches=np.full(1, found[Told.LEVEL]),
            mean_pressure=found[Told.TOTAL] / self._influence.cells,
            violation=relative,
            load_residual=found[Told.TOTAL] / asked - 1.0,
            cells_in_contact=round(found[Told.TOUCHING]),
            iterations=round(found[Told.ITERATION]),
            transforms=round(found[Told.TRANSFORMS]),
            pressure_field=self._iterate.pressure,
            gradient_field=self._iterate.gradient,
            executor=self._executor,
            cells=self._influence.cells,
            scale=np.full(1, scale),
            allowed=np.full(1, max(self._tolerance * scale, ROUNDING * yielded)),
        )

    def _asked(self, mean_pressure: float | FloatArray | None, approach: float | None) -> FloatArray | None:
        """Sums of the pressures that the parts are to carry [MPa]; None at an approach."""
        if (mean_pressure is None) == (approach is None):
            raise InputError("a half-space contact needs either a mean pressure or an approach.")
        self._iterate.divide(mean_pressure.size if isinstance(mean_pressure, np.ndarray) else None)
        if mean_pressure is None:
            return None
        means = np.atleast_1d(mean_pressure)
        wrong = means if not means.any() else means[~((means >= 0.0) & (means <= self._hardness))]
        if wrong.size:
            raise InputError(
                f"a mean pressure of {wrong[0]:g} MPa is not possible; it must be positive and at most the "
                f"hardness, {self._hardness:g} MPa."
            )
        return means * self._iterate.cells


class HalfSpace(BoundedPressure):
    """Solves contacts of one grid, as `BoundedPressure` says.

    modulus: E* of both bodies [MPa]. boundary: "periodic" or "free". on_device: whether a solve at a load is
    one launch; by default on a GPU.
    """

    def __init__(
        self,
        executor: Executor,
        *,
        modulus: float,
        boundary: str = "periodic",
        hardness: float = math.inf,
        tolerance: float = TOLERANCE,
        max_iterations: int = MAX_ITERATIONS,
        on_device: bool | None = None,
    ) -> None:
        self._like: dict[str, Any] = {
            "modulus": modulus,
            "boundary": boundary,
            "hardness": hardness,
            "on_device": on_device,
        }
        self._wide: HalfSpace | None = None
        influence = Influence(executor, modulus=modulus, boundary=boundary)
        super().__init__(
            executor, influence, hardness=hardness, tolerance=tolerance, max_iterations=max_iterations
        )
        self._operator = influence
        self._searches_on_device = executor.device.is_cuda if on_device is None else on_device

    @cached_property
    def on_device(self) -> DeviceSearch | None:
        """What makes whole solves at a load, where there is that; made after a start on wide cells.

        So its memory is not held beside theirs.
        """
        if not self._searches_on_device:
            return None
        return DeviceSearch(
            self._executor,
            self._iterate,
            self._operator,
            hardness=self._hardness,
            tolerance=self._tolerance,
            rounding=ROUNDING,
            max_iterations=self._max_iterations,
        )

    def _start(
        self,
        gap: Field,
        asked: FloatArray | None,
        approach: float | None,
        compliances: tuple[float, float, int | None],
        parts: Field | None,
    ) -> int:
        """Start from the contact on cells twice as wide, of whose transforms four count as one."""
        fine = self._executor
        if not nested.pays(fine):
            return 0
        if self._wide is None:
            grid = nested.wider(fine.grid)
            self._wide = HalfSpace(
                Executor(grid, device=str(fine.device), threads=fine.threads),
                tolerance=nested.TOLERANCE,
                max_iterations=nested.MAX_ITERATIONS,
                **self._like,
            )
        wide, on = self._wide, self._wide._executor
        own, streak, window = compliances
        wide.forget()
        try:
            found = wide.solve(
                nested.gather(fine, gap, on),
                mean_pressure=None if asked is None else float(asked.item()) / fine.grid.cells,
                approach=approach,
                compliance=own,
                streak_compliance=streak,
                streak_window=None if window is None else max(window // 2, 1),
                parts=None if parts is None else nested.gather(fine, parts, on),
                certified=False,
            )
        except (ConvergenceError, InputError):
            return 0
        nested.spread(on, found.pressure_field, fine, self._iterate.pressure)
        self._started, transforms = True, -(-found.transforms // 4)
        if nested.is_short(fine):
            self._wide = None
            del wide, on, found
            release(fine.device)
        return transforms
