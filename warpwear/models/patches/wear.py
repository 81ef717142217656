"""Bodies of patches wear by a stored pressure: both in one proportion, or each by its own materials."""

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
import warp as wp

from warpwear.contact.half_space.search import NO_CAP
from warpwear.engine.executor import Executor, Field, arguments
from warpwear.engine.numbers import Numbers
from warpwear.engine.program import Program
from warpwear.grid import FloatArray
from warpwear.history.recorder_patches import PatchLedger, Worn
from warpwear.kernels import wear_from_pressure
from warpwear.kernels.cells import LANES, MAXIMA, PATCH_MAXIMA, PATCH_SUMS, PressureSum, names_of
from warpwear.kernels.sliding import Bodies, RowSums, Slide
from warpwear.kernels.wear_from_pressure import Pressed
from warpwear.laws.archard import BODIES, wear_in_steps
from warpwear.laws.patches import Patches
from warpwear.laws.task import ContactTask
from warpwear.models.features.feature import Place
from warpwear.models.features.features import Features
from warpwear.models.features.materials import steps_above
from warpwear.models.track.bodies import SlidingBodies
from warpwear.models.unworn import layout_of

#: The wear of each body, where that is kept apart; the kernel takes that of both for the counter-body's.
APART = ("wear_counter", "wear_disc")
#: Other sums and maxima of a step.
SUMMED = tuple(name for name in PATCH_SUMS if name not in ("worn", "wearing"))
LARGEST = tuple(name for name in PATCH_MAXIMA if name != "worn")
PRESSED = names_of(PressureSum)


class PatchWear:
    """Wears the bodies of patches by a stored pressure, and sums up what that does to each.

    What both have lost is one field, in one proportion, until a cell can reach another material: from then on
    that of each body is kept. Until then no step differs from one of bodies without materials.

    patches: in the order in which they are stored. shared: with their model, by name: "gap", as worn; "worn",
    by both bodies in one proportion, or "unworn", the gap before [mm]; and "together", the features of bodies
    without materials.
    """

    STATE: ClassVar = {"is_apart": bool, "bodies": SlidingBodies, "_apart": Features}
    SCRATCH: ClassVar = ("slides", "_shared", "_sums", "_maxima", "_disc", "_programs", "_place")

    def __init__(
        self, task: ContactTask, patches: Patches, executor: Executor, ledger: PatchLedger, **shared: Any
    ) -> None:
        self._task, self._executor, self.ledger = task, executor, ledger
        self._layout, count = layout_of(executor, patches), patches.count
        self._shared, self._together = shared, shared["together"]
        steps = {"window": 1, "rows": count, "end_column": executor.vectors * LANES}
        self.slides = Numbers(Slide, executor.device, written=False, **steps)
        self._place = Place(self.slides.array)
        self._sums, self._maxima, self._disc = (
            wp.zeros(shape, dtype=wp.float64, device=executor.device)
            for shape in ((len(PressureSum), count), (len(MAXIMA), count), count)
        )
        self._programs: dict[tuple[str, bool], Program] = {}
        self.is_apart = False
        self.bodies: SlidingBodies | None = None
        self._apart: Features | None = None
        if task.profiles is not None:
            rows = (*(None,) * 4, 1, 1 if task.wear[0].wears else None)
            fields = {n: executor.zeros(r) for n, r in zip(SlidingBodies.FIELDS, rows, strict=True)}
            self.bodies = SlidingBodies(**fields, columns=(0, executor.grid.ny))
            self._apart = Features.of(task, executor, self.bodies.fields)

    @property
    def features(self) -> Features:
        """Return what the study adds to the next step."""
        return self._apart if self.is_apart and self._apart is not None else self._together

    def together(self, increments: Sequence[float]) -> int:
        """Return how many of the next steps [mm] wear both bodies in one proportion."""
        if self.bodies is None:
            return len(increments)
        if self.is_apart or self._together:
            return 0
        removals = wear_in_steps(self._task.wear, self.ledger.row["distance"], increments)
        of_bodies = dict(zip(BODIES, removals.T, strict=True))
        return steps_above(self._task, self._executor.grid.cell_area, self.ledger.most, of_bodies)

    def begin(self, increment: float, removals: tuple[float, float]) -> float:
        """Begin a step of an increment [mm]; return the compliance that wear lends all cells [mm³/N].

        removals: K ΔL of both bodies [mm³/N]. What cells have of their own is made, and the gap of bodies
        whose wear is kept apart.
        """
        row = self.ledger.row
        if not self.is_apart and not self.together([increment]):
            self._part()
        k = removals if self.is_apart else (sum(removals), 0.0)
        way = {"start": row["distance"], "end": row["distance"] + increment}
        reference = row["pressure_mean"]  # the scatter is summed about a value near the mean
        own = self._task.compliance
        self.slides.set(**way, reference=reference, own=own, k_counter=k[0], k_disc=k[1])
        host: Any = self
        for one in self.features:
            one.prepare(host, increment, removals)
        lends = sum(one * ratio for one, ratio in zip(k, self.features.ratios(1), strict=True))
        self.slides.set(compliance=lends)
        program, is_new = self._program("begin")
        if is_new and self.bodies is not None and self.is_apart:
            self.features.ask("before_search", program, self._place)
            bodies = arguments(Bodies, **self.bodies.fields)
            cells = self.features.sources, self.features.cells
            gap = self._shared["gap"]  # which serves as the means, of which none are made
            launched = self.slides.array, bodies, *cells, gap, gap
            program.launch(wear_from_pressure.gaps, *launched)
        elif is_new:
            self.features.ask("make_all", program, self._place)
        program.run()
        return lends

    def wear(self, pressure: Field, *, visited: int, gradient: Field, on_both: Field | None = None) -> None:
        """Wear the bodies of the first patches by a pressure [MPa].

        on_both: by which they wear at K of the step, where that is not the pressure itself. Fields are those
        of the first call.
        """
        self.slides.set(rows=visited)
        program, is_new = self._program("wear")
        if is_new:
            own = {} if on_both is None else {"on_counter": on_both, "on_disc": on_both}
            fields = {"pressure": pressure, "means": pressure, "gradient": gradient} | own
            cap = min(self._task.hardness, NO_CAP)
            pressed = arguments(Pressed, **fields, cells=self.features.cells, cap=cap)
            if self.is_apart and self.bodies is not None:
                bodies = self.bodies.fields
            else:
                bodies = {"counter": self._shared["gap"], "wear_counter": self._shared["worn"]}
            place = self._place._replace(pressed=pressed)
            self.features.ask("before_wear", program, place)
            tables = arguments(RowSums, worn_disc=self._disc), self._sums, self._maxima
            worn = self.slides.array, self._layout, pressed, arguments(Bodies, **bodies)
            program.launch(wear_from_pressure.wear, *worn, *tables, slots=self._sums.shape[1])
            self.features.ask("after_part", program, self._place)
        program.run()

    def worn(self, order: Any, increment: float, *, wearing: float = 0.0, **others: Any) -> Worn:
        """Return what a step over an increment [mm] has done.

        order: of the patches visited, their places among the macro cells. wearing: pressures over which
        bodies wear by K of the step, summed [MPa].
        """
        visited = len(order)
        table, maxima = (numbers.numpy()[:, :visited] for numbers in (self._sums, self._maxima))
        summed = dict(zip(PRESSED, table, strict=True))
        highest = dict(zip(MAXIMA, maxima.max(axis=1).tolist(), strict=True))
        wears: tuple[str, ...] = ("worn",)
        summed["worn"], highest["worn"] = summed["wear_counter"], highest["wear_counter"]
        if self.is_apart:
            wears, summed["wear_disc"] = APART, self._disc.numpy()[:visited]
        sums = {name: np.zeros(self._sums.shape[1]) for name in (*SUMMED, *wears)}
        for name, values in sums.items():
            values[order] = summed[name]
        sums["wearing"] = np.array([wearing])
        most = {name: highest[name] for name in (*LARGEST, *wears)}
        worn = self.ledger.worn(sums, most, reference=self.slides["reference"], **others)
        self.features.row(increment, worn.total)
        self.features.enter({"bare": float(summed["bare"].sum())}, worn.total, worn.most)
        return worn

    def fields(self, pressure: FloatArray, **together: FloatArray) -> dict[str, FloatArray]:
        """Return the fields of a snapshot under a pressure [MPa], as they are stored.

        together: gap, and wear of both bodies [mm], as they are where that is not kept apart.
        """
        fields, read = together, self._executor.to_numpy
        if self.is_apart and self.bodies is not None:
            fields = {name: read(getattr(self.bodies, name)) for name in APART}
            fields["gap"] = read(self.bodies.counter) - read(self.bodies.disc)
        return fields | (self._apart or self._together).fields(pressure)

    def _part(self) -> None:
        """Keep apart from now on what each body has lost."""
        assert self.bodies is not None
        host, bodies = {n: f.numpy() for n, f in self._shared.items() if n != "together"}, self.bodies
        gap = host["gap"]
        both = host["worn"] if "worn" in host else gap - host["unworn"]
        counter, disc = (part * both for part in self._task.wear_fractions)
        worn = {"wear_counter": counter, "wear_disc": disc, "disc": -disc, "counter": gap - disc}
        for name, values in worn.items():
            getattr(bodies, name).assign(values)
        if bodies.reached.shape[0] > 1:
            bodies.reached.assign((both > 0.0).astype(float))
        self.is_apart = True

    def _program(self, name: str) -> tuple[Program, bool]:
        """Return a program of steps as the next one is, and whether it is new and empty."""
        said = name, self.is_apart
        is_new = said not in self._programs
        if is_new:
            self._programs[said] = Program(self._executor)
        return self._programs[said], is_new
