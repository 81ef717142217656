"""The programs of a contact that slides: of many steps in a row, and of one before and after its balance."""

from collections.abc import Callable
from typing import Literal

from warpwear.contact.search import LoadSearch
from warpwear.engine.executor import SMALL, Arguments, Executor
from warpwear.engine.program import Program
from warpwear.kernels import sliding, sliding_steps
from warpwear.laws.task import ContactTask
from warpwear.models.features.feature import Place
from warpwear.models.features.features import Features, asks
from warpwear.models.track.tiles import SlidingTiles


class StepPrograms:
    """Makes the programs of steps, each when it is first asked for.

    place: what they work on, but for the springs of a search. tile_bounds: what is kept of every tile.
    features: what a study adds. highest: finds the largest gap before any wear [mm].
    """

    def __init__(
        self,
        executor: Executor,
        task: ContactTask,
        tiles: SlidingTiles,
        place: Place,
        tile_bounds: Arguments,
        features: Features,
        *,
        highest: Callable[[], float],
    ) -> None:
        self._executor, self._task, self._tiles, self._highest = executor, task, tiles, highest
        self._place, self._tile_bounds, self.features = place, tile_bounds, features
        #: Searches by whether the cells are rigid; programs by that too, and whether threads share them.
        self._searches: dict[bool, LoadSearch] = {}
        self._programs: dict[tuple[str, bool, bool], Program] = {}

    def search(self, *, rigid: bool) -> LoadSearch:
        """Return the search of steps whose cells are rigid or not."""
        if rigid not in self._searches:
            task, cells = self._task, self.features.cells
            search = LoadSearch(
                self._executor,
                self._place.bodies.gap,
                self._tiles,
                load=task.load,
                hardness=task.hardness,
                stiffness=None if rigid else cells.stiffness,
                cap_ratio=cells.cap_ratio,
                tolerance=task.load_tolerance if rigid else None,
                knots=task.knots,
            )
            if rigid:
                search.springs.highest = self._highest()
            self._searches[rigid] = search
        return self._searches[rigid]

    def program(self, name: Literal["steps", "search", "wear"], *, rigid: bool) -> Program:
        """Return the program of many steps, or of one before or after its balance, of rigid cells or not."""
        steps, shares = self._place.steps, self._executor.is_shared and self._tiles.cells > SMALL
        steps.is_rigid = int(rigid)  # each time: a program is recorded when first run
        if (name, rigid, shares) not in self._programs:
            search = self.search(rigid=rigid)
            records = 1 if name == "steps" else 2  # for one step alone recording does not pay
            program = Program(self._executor, shares=shares, records=records)
            self._programs[name, rigid, shares] = program
            self._tiles.features = self.features
            if name == "steps":
                program.decide(sliding_steps.begin, steps)
                with program.loop(steps.stepping):
                    self._add_search(program, search)
                    self._add_wear(program, search)
            elif name == "search":
                self._add_search(program, search, whole=True)
            else:
                self._add_wear(program, search)
        return self._programs[name, rigid, shares]

    def _add_search(self, program: Program, search: LoadSearch, *, whole: bool = False) -> None:
        """Add the beginning of a step: what its cells are like, which can touch, and the balance.

        whole: whether all cells are to be seen, not only those of the tiles listed.
        """
        place = self._place._replace(springs=search.springs)
        with self.features.enclosing("at_beginning", program):
            program.decide(sliding_steps.begin_search, search.springs, place.steps)
            self.features.ask("before_search", program, place)
            if whole:
                self.features.ask("make_all", program, place)
            self._tiles.make_listed(program)
            search.add_to(program)
            self._tiles.add_to(program)
            program.decide(sliding_steps.end_search, search.springs, place.steps)

    def _add_wear(self, program: Program, search: LoadSearch) -> None:
        """Add the end of a step: the wear of both bodies, what follows it, and its row."""
        place, tiles = self._place._replace(springs=search.springs), self._tiles
        slides, springs, listed, cells, bodies, tables, steps = (
            *(place.slides, place.springs, place.listed, self.features.cells),
            *(place.bodies, place.tables, place.steps),
        )
        with (
            self.features.enclosing("at_beginning", program),
            program.branch(steps.solved),
        ):
            self.features.ask("before_wear", program, place)
            program.launch(
                sliding.wear_step,
                *(*listed, slides, springs, cells, bodies, self._tile_bounds, tables),
                chunks=lambda: tiles.chunks,
            )
            self.features.ask("after_wear", program, place)
        self.features.ask("between", program, place)
        with self.features.enclosing("at_end", program):
            if any(asks(one, "end_step") for one in self.features):
                with program.branch(steps.solved):
                    self.features.ask("end_step", program, place)
            program.decide(sliding_steps.record, springs, steps, tables, self._tile_bounds.rows)
            self.features.ask("after_part", program, place)
