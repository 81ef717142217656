"""Patches of fine cells share the load of a macro contact, on two scales."""

import math
from collections.abc import Iterator, Sequence
from typing import ClassVar

import numpy as np
import warp as wp

from warpwear.contact.balance import stiffness_of
from warpwear.contact.search import bends_of
from warpwear.engine.executor import Arguments, Executor, Field, arguments
from warpwear.engine.numbers import Numbers
from warpwear.engine.program import Program
from warpwear.engine.tiles import tile_extremes
from warpwear.grid import FloatArray
from warpwear.history.recorder import Step, StepColumns
from warpwear.history.recorder_patches import PatchLedger, Worn
from warpwear.history.snapshot import Snapshot
from warpwear.kernels import patches as passes
from warpwear.kernels.cells import EXTENTS, PATCH_MAXIMA, PATCH_SUMS
from warpwear.kernels.two_scale import pressing
from warpwear.kernels.two_scale import steps as kernels
from warpwear.laws.archard import wear_in_steps
from warpwear.laws.patches import Patches
from warpwear.laws.task import ContactTask
from warpwear.models.model import Model
from warpwear.models.patches.cells import PatchContact
from warpwear.models.patches.shares import LoadSharing, SmoothContact
from warpwear.models.patches.wear import PatchWear

#: Work of a patch where no cell has touched yet, over that of one where all have.
LEAST_WORK = 0.05
#: Steps of a block at most, and numbers of every patch that it leaves.
LONGEST_BLOCK, MOST_NUMBERS = 64, 2**20


class TwoScaleModel(Model):
    """Patches touch and wear in one task: they share the load by one approach, or as a smooth contact says.

    Approaches and gaps count from the mean planes, so that the worn mean height of a patch, which closes the
    loop back to the macro contact, is part of its gap.

    executor: on `patches.grid`. heights: of the disc over its mean plane [mm], shape of the domain.
    """

    STATE: ClassVar = {
        "contact": PatchContact,
        "_ledger": PatchLedger,
        "_smooth": SmoothContact,
        "sharing": LoadSharing,
        "_memory": Numbers,
        "_courses": dict,
        "_wears": PatchWear,
    }
    SCRATCH: ClassVar = ("_books", "_now", "_steps", "_state", "_work", "_chunks", "_pressure")

    def __init__(self, task: ContactTask, patches: Patches, heights: FloatArray, executor: Executor) -> None:
        self.task, self.patches = task, patches
        self._executor = executor
        executor.foresee([passes.wear, *([pressing.judge] if task.prescribed_loads else [])])
        self.contact = PatchContact(task, patches, heights, executor)
        self._ledger = PatchLedger(task, patches)
        self.book = self._ledger.book
        contact = self.contact
        shared = {"gap": contact.gap, "unworn": contact.initial, "together": contact.features}
        self._wears = PatchWear(task, patches, executor, self._ledger, **shared)
        self._smooth = SmoothContact(task, patches, executor) if task.prescribed_loads else None
        like = {"load": task.load, "area": patches.area, "hardness": task.hardness}
        self.sharing = LoadSharing(executor, contact.lowest, **like)
        self.longest_block = max(1, min(LONGEST_BLOCK, MOST_NUMBERS // patches.count))
        count, device, rows = patches.count, executor.device, self.longest_block
        #: By which the approaches of the next step are foreseen: of the bodies, and of every patch.
        self._memory = Numbers(kernels.Memory, device, ahead=-1.0)
        names = "start", "deflection", "giving", "reached", "base_next", "offset_next"
        courses = arguments(kernels.Courses, device, **dict.fromkeys(names, count))
        self._courses: dict[str, Field] = {name: getattr(courses, name) for name in names}
        self._courses["reached"].fill_(-math.inf)
        self._books = arguments(
            kernels.Books,
            device,
            ahead=self.contact.surfaces.trial,
            sums=(len(PATCH_SUMS), count),
            maxima=(len(PATCH_MAXIMA), count),
            rows=(rows, len(kernels.HEADER) + len(PATCH_SUMS) + len(PATCH_MAXIMA)),
            loads=(rows, count),
            areas=(rows, count),
        )
        follows = task.uses_bulk_stiffness and task.bulk_updated and isinstance(task.bulk_stiffness, str)
        self._now = Numbers(kernels.CurrentStep, device)
        self._steps = arguments(
            kernels.Steps,
            device,
            load=self.sharing.load,
            lowest=float(contact.lowest.min()),
            cell=patches.domain.cell,
            cell_area=patches.domain.cell_area,
            weight=patches.weight,
            follows=task.bulk_stiffness_at(1.0) if follows else 0.0,
            sprung=int(task.uses_bulk_stiffness),
            # By features wear changes what cells bear; and bends are of one step.
            looks_ahead=int(self._smooth is None and not self.contact.features and not len(task.knots)),
            bends=bends_of(task.knots, executor, task.compliance, float(task.implicit)),
            within=wp.vec4d(*self._ledger.within),
            plan=(rows + 1, 3),
            now=self._now.array,
            memory=self._memory.array,
            search=self.sharing.search.array,
            flags=self.sharing.flags,
        )
        self._state = self._steps, self.sharing.curves, courses
        self._work = np.full(count, LEAST_WORK * patches.side**2)
        self._chunks: list[tuple[int, int]] = []
        self._find, self._wear, self._many = (Program(executor) for _ in range(3))
        contact.ask("make_all", self._find, self._wears.slides.array)
        self._add_find(self._find, contact.surfaces)
        self._add_wear(self._wear)
        contact.ask("after_part", self._wear, self._wears.slides.array)
        flags = self.sharing.flags
        with self._many.loop(flags.stepping):
            self._add_find(self._many, contact.surfaces)
            with self._many.branch(flags.balanced):
                self._add_wear(self._many)
        self._pressure: Field = None
        self._press_program = Program(executor)
        #: Search and pressures of bodies whose wear is kept apart.
        self._find_apart: Program | None = None

    def _add_find(self, program: Program, surfaces: Arguments) -> None:
        """Add the search for the approaches of a step to a program."""
        curves, smooth = self.sharing.curves, self._smooth
        state = self._state

        def evaluate() -> None:
            self._pass(program, passes.carried, self._steps, curves, surfaces)

        if smooth is None:
            program.decide(kernels.begin, *state)
            self.sharing.add_to(program, evaluate)
            return
        program.decide(pressing.begin, self._steps, curves, smooth.smooth, smooth.brackets)
        smooth.add_to(program, self.sharing, evaluate)

    def _add_wear(self, program: Program) -> None:
        """Add the wear of a step whose approaches are solved to a program."""
        state = self._state
        program.decide(kernels.foresee, *state)
        self._pass(program, passes.wear, *state, self.contact.surfaces, self._books)
        program.decide(kernels.end, *state, self._books)

    def _pass(self, program: Program, kernel: object, *inputs: object) -> None:
        """Add a pass over all patches to a program."""
        chunks = self._chunks  # not self, which holds the program: models are given up within a run
        program.launch(kernel, *inputs, slots=self.patches.count, chunks=lambda: chunks)

    @property
    def in_blocks(self) -> bool:
        """Tell whether the device takes the next steps by itself."""
        return not self.contact.features

    def replay(
        self, increments: Sequence[float], then: float | None
    ) -> tuple[int, Iterator[Step | StepColumns]]:
        """Make steps on the device, fewer where the contact grows to the edge, or to another material."""
        count = self._wears.together(increments)
        if not count:
            return super().replay(increments, then)
        increments, then = increments[:count], increments[count] if count < len(increments) else then
        removals = self._begin(increments, then)
        self._many.run()
        results = zip(self._results(self._now["number"]), increments, removals, strict=False)
        return self._now["number"], (self._ledger.enter_worn(*result) for result in results)

    def check(self) -> None:
        """Raise ConvergenceError where the load could not be shared."""
        if not self.sharing.is_balanced:
            smooth = self._smooth
            raise self.sharing.failure() if smooth is None else smooth.failure(self.sharing)

    def advance(self, increment: float, *, with_pressure: bool = False, then: float | None = None) -> Step:
        """Share the load, then slide by the increment [mm] and wear both bodies.

        then: the next increment, where it is known [mm]; the pass that wears evaluates for it as well.

        Raises ConvergenceError when the load cannot be shared.
        """
        distance, features = self._ledger.row["distance"], self.contact.features
        if not self._wears.together([increment]):
            return self._advance_apart(increment, with_pressure=with_pressure)
        removals = self._begin([increment], then)
        self._wears.slides.set(start=distance, end=distance + increment)
        self._find.run()
        self.check()
        field = self._press() if with_pressure or features else None
        pressure = self.patches.on_domain(self._executor.to_numpy(field)) if with_pressure else None
        self._wear.run()
        worn = next(self._results(1))
        features.enter({"bare": float(self.contact.bare.numpy().sum())}, worn.total, worn.most)
        return self._ledger.enter_worn(worn, increment, removals[0], pressure)

    def _advance_apart(self, increment: float, *, with_pressure: bool) -> Step:
        """Make a step as `advance` does, of bodies whose wear is kept apart."""
        wears, sharing = self._wears, self.sharing
        (removals,) = self._begin([increment], None)
        for load in (sharing.load, self._steps.load):  # of patches, whose cells may have other caps by now
            load.hardness = min(max(m.hardness for m in p.materials) for p in self.task.profiles or ())
        self._memory.set(ahead=-1.0)  # what was evaluated ahead is of cells with nothing of their own
        wears.begin(increment, removals)
        if self._find_apart is None:
            self._pressure, self._find_apart = self._executor.zeros(), Program(self._executor)
            surfaces = self.contact.surfaces_of(wears.features.cells)
            self._add_find(self._find_apart, surfaces)
            self._find_apart.decide(kernels.foresee, *self._state)
            inputs = self._steps, sharing.curves, surfaces, self._pressure
            self._pass(self._find_apart, passes.pressures, *inputs)
        self._find_apart.run()
        self.check()
        pressure = self.patches.on_domain(self._executor.to_numpy(self._pressure)) if with_pressure else None
        wears.wear(self._pressure, visited=self.patches.count, gradient=self._pressure)
        search = sharing.search.values
        approach = search["common_base"], search["bracket"][0]
        numbers = {"evaluations": search["evaluations"], "approach": approach}
        worn = wears.worn(np.arange(self.patches.count), increment, **numbers)
        return self._ledger.enter_worn(worn, increment, removals, pressure)

    def snapshot(self, step: Step, distance: float) -> Snapshot:
        """Return the fields after the last step, which was asked for its pressure, at its distance [mm]."""
        assert step.pressure is not None
        read = self._executor.to_numpy
        gap, initial = read(self.contact.gap), read(self.contact.initial)
        fields = self._wears.fields(step.pressure, gap=gap, worn=gap - initial)
        return self._ledger.snapshot(step, distance, self.patches, **fields)

    def below_bounds(self) -> float:
        """Compare with the lowest gap of every tile before any wear, see `Model.below_bounds`."""
        now = tile_extremes(np.minimum, self.contact.gap, lines=self.patches.side)
        return float((self.contact.surfaces.lowest.numpy() - now).max())

    def _begin(self, increments: Sequence[float], then: float | None) -> list[tuple[float, float]]:
        """Plan steps; return K ΔL of counter-body and disc in each [mm³/N].

        then: the increment after them [mm], where it is known.
        """
        task, row = self.task, self._ledger.row
        known = [*increments, *([] if then is None else [then])]
        removals = [(k, of_disc) for k, of_disc in wear_in_steps(task.wear, row["distance"], known).tolist()]
        flexibility = 1.0 / self._ledger.foundation
        plan = self._steps.plan.numpy()
        plan[:, 0] = -1.0  # where no step follows
        for number, removal in enumerate(map(sum, removals)):
            stiffness = stiffness_of(task.compliance + (removal if task.implicit else 0.0))
            plan[number] = removal, stiffness, flexibility
        if not self._executor.device.is_cpu:
            self._steps.plan.assign(plan)
        extents = [self._ledger.most[name] for name in EXTENTS]
        self._now.set(mean=row["pressure_mean"], number=0, steps=len(increments), extents=extents)
        self.sharing.flags.stepping.fill_(1)
        self._chunks[:] = self._executor.split_rows(self._work)
        return removals

    def _press(self) -> Field:
        """Return the pressure of every cell at the solved approaches [MPa]."""
        if self._pressure is None:
            self._pressure = self._executor.zeros()
            inputs = self._steps, self.sharing.curves, self.contact.surfaces, self._pressure
            self._pass(self._press_program, passes.pressures, *inputs)
            if self.contact.features:
                self.contact.add_bare(self._press_program, self._pressure, self._wears.slides.array)
        self._press_program.run()
        return self._pressure

    def _results(self, count: int) -> Iterator[Worn]:
        """Yield what the first steps of the plan have left."""
        books = self._books
        rows, loads, areas = (table.numpy()[:count] for table in (books.rows, books.loads, books.areas))
        touched = books.sums.numpy()[PATCH_SUMS.index("touched")]
        self._work = touched + LEAST_WORK * self.patches.side**2
        for row, load, area in zip(rows.tolist(), loads.copy(), areas.copy(), strict=True):
            base, offset, reference, evaluations, *sums = row
            total = dict(zip(PATCH_SUMS, sums, strict=False))
            most = dict(zip(PATCH_MAXIMA, sums[len(PATCH_SUMS) :], strict=True))
            yield Worn(total, most, load, area, (base, offset), reference, int(evaluations))
