"""Projected conjugate gradients find a pressure between bounds that carries a load, as a device's program.

A trial step is clipped to 0 ≤ p ≤ H and shifted to the load, then the minimum along the way to it is taken,
so that every iterate is feasible, none is worse than the last, and an iteration costs one pair of transforms,
two with the preconditioner |q| E*/2. Its origin is Polonsky and Keer 1999, Wear 231, 206; Almqvist et al.
2007, Tribol. Int. 40, 574 added the cap, Vollebregt 2014, J. Comput. Phys. 257, 333 the preconditioner.

Each group of rows may have a load of its own, and then a level and a shift of its own; the length and the
memory of a step are common. Together they are one problem, whose matrix has a block for each group.

The passes are in `kernels.half_space.passes`, the rules in `decisions` and `steps` beside it.
"""

from collections.abc import Mapping
from contextlib import AbstractContextManager, nullcontext
from functools import cached_property
from typing import Any

import numpy as np

from warpwear.contact.balance import TOLERANCE
from warpwear.contact.certificate import LOAD_TOLERANCE, Certificate, Certifier
from warpwear.contact.half_space.influence import Influence
from warpwear.engine.executor import Executor, Field, arguments
from warpwear.engine.numbers import Mirror, Numbers
from warpwear.engine.program import Program
from warpwear.grid import FloatArray
from warpwear.kernels.cells import LANES, NONE
from warpwear.kernels.half_space import decisions, passes, solve, steps
from warpwear.kernels.half_space.solve import Flag, Request, SearchRules

#: Stands for no cap: kernels compare with it.
NO_CAP = float(NONE)
#: Number of cells from which responses to steps are computed in single precision.
LEAST_SINGLE = 2**14


class Search:
    """Looks for a pressure under one operator, on one gap.

    fields: arrays of `solve.Fields` by name; its gap is from the mean planes [mm]. cap_ratio: parts of the
    hardness that cells bear; None: all of it. yields: compliance of each cell beside the operator's [mm/MPa];
    None: none. streak_yields: that of cells under the mean along x that passes them, of so many cells as
    `streak` is told. groups: 1, all rows together, or as
    many as the executor has rows, each of which has a load of its own. tiled: whether gradients are extended
    tile by tile, as a CPU does by default. After a run `numbers` and `groups` hold what the search knows, by
    the names of `kernels.half_space.solve`.
    """

    def __init__(
        self,
        executor: Executor,
        operator: Influence,
        *,
        hardness: float,
        rules: SearchRules,
        fields: Mapping[str, Field],
        cap_ratio: Field | None = None,
        yields: Field | None = None,
        streak_yields: Field | None = None,
        groups: int,
        tiled: bool | None = None,
    ) -> None:
        self._executor, self._operator = executor, operator
        device, grid = executor.device, executor.grid
        on_cpu = device.is_cpu
        self._single = operator.is_one and on_cpu and operator.cells >= LEAST_SINGLE
        self._yields = yields is not None
        self._streaks: Any = None
        if streak_yields is not None:
            streaks = {"yields": streak_yields, "yielded": executor.zeros(), "window": 1}
            self._streaks = arguments(solve.Streaks, device, **streaks)
        self._extends = operator.is_one and not self._yields
        self._few = rules.few if self._extends and on_cpu and hardness < NO_CAP and groups == 1 else 0
        #: Whether what is extended is gathered tile by tile.
        self._tiled = on_cpu if tiled is None else tiled
        rows = grid.nx * (1 if self._tiled else 2) * self._extends
        gathered = rows, LANES * executor.vectors * self._extends
        slots = grid.nx if groups > 1 else executor.slots_of(grid.nx)

        told = vars(rules) | {"few": self._few, "tiled": int(self._tiled)}
        told["single_rounding"] *= self._single
        loads = {"load_tolerance": TOLERANCE, "certified_load": LOAD_TOLERANCE}
        loads["group_cells"] = float(operator.cells / (grid.nx if groups > 1 else 1))
        self._kernel_rules = Numbers(solve.Rules, device, written=False, **told, **loads)
        #: The search as kernels take it.
        self.arguments = arguments(
            solve.Solve,
            device,
            columns=grid.ny,
            wraps_along=int(operator.wraps[0]),
            wraps_across=int(operator.wraps[1]),
            rules=self._kernel_rules.array,
            fields=arguments(
                solve.Fields,
                device,
                **fields,
                cap=min(hardness, NO_CAP),
                cap_ratio=executor.zeros(0) if cap_ratio is None else cap_ratio,
                yields=executor.zeros(0) if yields is None else yields,
                gathered=gathered,
            ),
            request=len(Request),
            loads=groups,
            visited=operator.visited,
            groups=groups,
            table=(solve.LINES, slots),
            flags=len(Flag),
        )
        if self._extends:
            self.arguments.neighbours = operator.neighbours
        if self._few:
            self._room = room_for_few(self._few, device, operator.far_shape, *operator.coefficients())
        self._proof = Certifier(executor, self.arguments.fields, groups=groups, visited=operator.visited)
        self._inputs = Mirror(self.arguments.request, self.arguments.loads)
        self._mirror = Mirror(self.arguments.numbers, self.arguments.groups, self._proof.arguments.groups)
        self._slots = slots
        #: Ranges of slots for the threads, as of `Program.launch`.
        self._chunks = None if operator.chunks is None else lambda: operator.chunks or [(0, slots)]

    def streak(self, window: int) -> None:
        """Tell over how many cells along x the pressures are averaged that pass a cell."""
        self._executor.put(self._streaks.window, window)

    def run(self, request: Mapping[Request, float], loads: FloatArray, then: Program | None = None) -> int:
        """Search; return how it ended, by the numbers of `kernels.half_space.solve`.

        loads: Σ p of each group [MPa], or their approaches [mm] where these are prescribed. then: a program
        that runs before the host reads the results.
        """
        values = np.array([request.get(name, 0.0) for name in Request])
        loads = np.resize(loads, self.arguments.loads.shape)
        self._inputs.write(values, loads)
        self._program.run()
        if then is not None:
            then.run()
        return self.read()

    def bear(self, load: float) -> None:
        """Tell the load of one group, Σ p [MPa], to programs that ask otherwise what is in its request."""
        self._inputs.values[1][...] = load
        self._inputs.send()

    def read(self) -> int:
        """Read what the last search left; return how it ended."""
        numbers, groups, proven = self._mirror.read()
        visited = 1 if len(groups) == 1 else int(self._operator.visited.numpy()[0])
        self.numbers, self.groups, self._proven = numbers[0], groups[:visited], proven[:visited]
        return int(self.numbers["status"])

    @property
    def reached(self) -> dict[str, Field]:
        """Return the arrays with approach and certificate, by names of `half_space.passes.ContactReach`."""
        return {"groups": self.arguments.groups, "proven": self._proof.arguments.groups}

    def certificate(self) -> Certificate:
        """Return the certificate of the last pressure, whose search must have been asked for one."""
        return Certificate.of(self._proven, cell_area=self._executor.grid.cell_area)

    @cached_property
    def _program(self) -> Program:
        program = Program(self._executor)
        self.add_to(program)
        return program

    def add_to(self, program: Program) -> None:
        """Add a search, and the certificate where its pressure is to have one."""
        search, proof = self.arguments, self._proof
        program.decide(decisions.begin, search)
        with program.loop(self.arguments.flags, Flag.SOLVING):
            self._search(program)
            program.decide(decisions.conclude, search, proof.arguments)
            with program.branch(self.arguments.flags, Flag.CERTIFIES):
                self._respond(program, "pressure", single=False)
                proof.add_to(program, self._chunks)
                program.decide(decisions.accept, search, proof.arguments)

    def _search(self, program: Program) -> None:
        """Add the start of a search, and its iteration, which repeats until a decision ends it."""
        search = self.arguments
        program.decide(decisions.start, search)
        for _ in range(2):  # about 0, then about the mean
            self._pass(program, passes.moments)
            program.decide(decisions.measure, search)
        with program.branch(self.arguments.flags, Flag.ANEW):
            self._pass(program, passes.springs)
            self._balance(program)
            self._pass(program, passes.take)
        self._renew(program)
        self._judge(program)
        with program.loop(self.arguments.flags, Flag.SEARCHING):
            if self._single:  # in double precision a gradient stays good
                with program.branch(self.arguments.flags, Flag.RENEWS):
                    self._renew(program)
            with self._only_if(program, Flag.MOVES, self._single):
                if self._few:
                    with program.branch(self.arguments.flags, Flag.MOVES_FEW):
                        self._move_few(program)
                with self._only_if(program, Flag.STEPS, bool(self._few)):
                    self._step(program)
            self._judge(program)

    def _judge(self, program: Program) -> None:
        """Go along the step that was decided on, and judge what that leaves."""
        self._pass(program, passes.advance)
        program.decide(decisions.judge, self.arguments)

    def _only_if(self, program: Program, flag: Flag, asks: bool) -> AbstractContextManager[None]:
        """Make what follows depend on a flag if `asks`; else do it always, as a branch costs a GPU time."""
        return program.branch(self.arguments.flags, flag) if asks else nullcontext()

    def _renew(self, program: Program) -> None:
        """Compute the gradient anew from the present pressure."""
        search = self.arguments
        if search.fields.cap_ratio.shape[0]:
            self._pass(program, passes.bound)
        with self._only_if(program, Flag.RENEWS_EXACTLY, self._single):
            self._respond(program, "pressure", single=False)
        if self._single:
            with program.branch(self.arguments.flags, Flag.RENEWS_ROUGHLY):
                self._respond(program, "pressure", single=True)
        self._pass(program, passes.gradient)
        program.decide(decisions.renew, search)

    def _step(self, program: Program) -> None:
        """Choose a trial, shift it to the load, and go towards it as far as the least energy."""
        search = self.arguments
        with program.branch(self.arguments.flags, Flag.PRECONDITIONS):
            self._precondition(program)
        self._pass(program, passes.products)
        program.decide(steps.aim, search)
        with program.branch(self.arguments.flags, Flag.DESCENDS):
            self._pass(program, passes.direction)
            self._balance(program)
            self._respond_to_step(program)
            program.decide(steps.go, search)

    def _balance(self, program: Program) -> None:
        """Shift the trial, whose sums the pass before has left, until it carries the load."""
        program.decide(decisions.begin_balance, self.arguments)
        with program.loop(self.arguments.flags, Flag.BALANCING):
            self._pass(program, passes.carried)
            program.decide(decisions.balance, self.arguments)

    def _respond_to_step(self, program: Program) -> None:
        self._pass(program, passes.step)
        self._respond(program, "step", single=self._single)
        self._pass(program, passes.curvature)

    def _precondition(self, program: Program) -> None:
        """Make the descent of the free cells from their gradient, extended to the others where that pays."""
        trial = self.arguments.fields.trial
        if self._extends:
            self._pass(program, passes.scatter)
            program.decide(steps.judge_scatter, self.arguments)
        with self._only_if(program, Flag.EXTENDS_NOT, self._extends and self._tiled):
            self._pass(program, passes.residual)
        self._go_beyond(program, passes.extend, (0, 1))
        self._operator.add_inverse(program, trial, trial)
        self._go_beyond(program, passes.gather, (2, 3, 4))

    def _go_beyond(self, program: Program, by_tiles: Any, numbers: tuple[int, ...]) -> None:
        """Weigh by compliances; extend free cells, or gather, by tiles or by passes of these numbers."""
        if self._yields:
            self._pass(program, passes.weigh)
        if not self._extends:
            return
        with program.branch(self.arguments.flags, Flag.EXTENDS):
            if self._tiled:
                program.launch(by_tiles, self.arguments, slots=-(-self._executor.grid.nx // passes.ROWS))
                return
            for number in numbers:
                self._pass(program, passes.extend_once, number)

    def _move_few(self, program: Program) -> None:
        """Solve the few cells that may still change between 0, free and the cap directly, all at once."""
        search = self.arguments
        self._pass(program, steps.count_open, self._room)
        program.decide(steps.place_open, search, self._room)
        with program.branch(self.arguments.flags, Flag.AIMED_AT_FEW):
            self._pass(program, steps.list_open, self._room)
            program.decide(steps.aim_few, search, self._room)
        with program.branch(self.arguments.flags, Flag.AIMED_AT_FEW):
            self._respond_to_step(program)
            program.decide(steps.go_few, search)

    def _respond(self, program: Program, field: str, *, single: bool) -> None:
        fields = self.arguments.fields
        self._operator.add_response(program, getattr(fields, field), fields.response, single=single)
        if self._yields:
            self._pass(program, passes.yield_to_step if field == "step" else passes.yield_to_pressure)
        if self._streaks:
            self._pass(program, passes.streak, self._streaks, field == "step")
            self._pass(program, passes.add_streaks, self._streaks)

    def _pass(self, program: Program, kernel: Any, *more: Any) -> None:
        program.launch(kernel, self.arguments, *more, slots=self._slots, chunks=self._chunks)


def room_for_few(most: int, device: Any, shape: tuple[int, int], elastic: Field, along: Field) -> Any:
    """Return the arrays for the cells that are moved at once.

    elastic, along: the operator's coefficients, see `Influence.coefficients`. shape: on which these wrap.
    """
    names = ("row", "column", "slope", "low", "high", "change", "side", "next", "free", "order", "rest")
    sizes = dict.fromkeys(names, most) | {"pair": 2 * most, "matrix": most**2}
    sizes |= dict.fromkeys(("equations", "factor"), most * (most + 2))
    wraps = {"rows": shape[0], "columns": shape[1]}
    return arguments(solve.ActiveSet, device, **sizes, **wraps, elastic=elastic, along=along)
