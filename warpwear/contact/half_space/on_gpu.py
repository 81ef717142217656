"""The search of the half-space solver on a GPU as one captured graph: a solve is a launch and a reading.

The rules are those of `search`; what follows from a pass is decided on the device, as a word to
the host and back takes longer than a pass. Of one part: rows with loads of their own go pass by pass.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import warp as wp

from warpwear.contact.balance import HOPELESS, MAX_EVALUATIONS, TOLERANCE
from warpwear.contact.half_space import search
from warpwear.contact.half_space.filters import Filter, filter_of
from warpwear.contact.half_space.influence import Influence
from warpwear.contact.half_space.passes import EVERY, NO_CAP, ROUGH_BALANCE, SCATTERED, Iterate
from warpwear.contact.half_space.transforms import arrays_of
from warpwear.engine.executor import Executor, Field, arguments
from warpwear.errors import ConvergenceError
from warpwear.kernels.cells import LANES
from warpwear.kernels.gpu.half_space import balance, descent, filters
from warpwear.kernels.gpu.half_space.solve import UNBALANCED, Numbers, Rules, Solve, Told

BLOCK = 256  # threads
BLOCKS = 528  # at most: four for each of the 132 multiprocessors of a large GPU
LINES = 9  # sums and maxima of a pass at most
#: Blocks of a test on a CPU, of one thread each.
BLOCKS_ON_CPU = 3


class DeviceSearch:
    """Solves contacts of one part at a load, on the fields of an iterate.

    tolerance, rounding, max_iterations: as of `solver.BoundedPressure`.
    """

    def __init__(
        self,
        executor: Executor,
        iterate: Iterate,
        influence: Influence,
        *,
        hardness: float,
        tolerance: float,
        rounding: float,
        max_iterations: int,
    ) -> None:
        self._executor, self._device, self._influence = executor, executor.device, influence
        for kernel in (balance.moments, descent.begin, filters.residual):
            executor.load(kernel)  # which no graph can while it is captured
        grid, self._gap, self._pressure = executor.grid, executor.zeros(), iterate.pressure
        columns = executor.vectors * LANES
        blocks = BLOCKS_ON_CPU if self._device.is_cpu else min(BLOCKS, -(-grid.nx * columns // BLOCK))
        self._far = filter_of(executor, influence.far_shape, np.float64)
        # The inverse runs before the response, which then writes all that it reads: one memory for both.
        self._near = filter_of(executor, grid.shape, np.float32, within=self._far)
        self._rules = arguments(
            Rules,
            elastic_fraction=search.ELASTIC_FRACTION,
            whole_step=search.WHOLE_STEP,
            shortest_useful=search.SHORTEST_USEFUL_STEP,
            outward=search.OUTWARD,
            plain_steps=search.PLAIN_STEPS,
            patience=search.PATIENCE,
            tolerance=tolerance,
            rounding=rounding,
            of_load=TOLERANCE,
            rough_balance=ROUGH_BALANCE,
            hopeless=HOPELESS,
            evaluations=MAX_EVALUATIONS - 1,
            iterations=max_iterations,
            scattered=SCATTERED,
            every=EVERY,
            cap=min(hardness, NO_CAP),
            cells=float(influence.cells),
        )
        self._solve = arguments(
            Solve,
            ny=grid.ny,
            columns=columns,
            pitch=influence.far_shape[1],
            **{name: self._numbers_of(field) for name, field in {"gap": self._gap, **iterate.fields}.items()},
            given=self._far.given.flatten(),
            made=self._far.made.flatten(),
            given_near=self._near.given.flatten(),
            made_near=self._near.made.flatten(),
            bound=wp.zeros(grid.cells, dtype=wp.uint8, device=self._device),
            weights=wp.zeros(3, dtype=wp.float32, device=self._device),
            wraps=influence.wraps,
            found=wp.zeros((LINES, blocks), dtype=wp.float64, device=self._device),
            rules=self._rules,
            asked=wp.zeros(2, dtype=wp.float64, device=self._device),
            told=wp.zeros(len(Told), dtype=wp.float64, device=self._device),
            numbers=wp.zeros(1, dtype=Numbers, device=self._device),
            **{name: self._flag() for name in ("searching", "balancing", "near", "extends")},
        )
        self._lines = [
            wp.zeros(n, dtype=wp.float64, device=self._device) for n in (self._far.shape[0], grid.nx)
        ]
        self._compliance: tuple[float, float, int | None] | None = None
        self._tables: list[Field] = [
            wp.array(table, dtype=wp.float64, device=self._device, copy=False)
            for table in (influence.elastic, influence.near_elastic)
        ]
        pinned = self._device.is_cuda
        self._asked, self._told = (
            wp.zeros(place.size, dtype=wp.float64, device="cpu", pinned=pinned)
            for place in (self._solve.asked, self._solve.told)
        )
        self._parts: Field | None = None
        self._graphs: dict[bool, Any] = {}  # by whether they start anew

    def solve(
        self,
        gap: Field,
        *,
        asked: float,
        stiffness: float,
        compliance: tuple[float, float, int | None],
        anew: bool,
        parts: Field | None = None,
    ) -> Mapping[Told, float]:
        """Solve a contact; returns what it tells at its end.

        asked: sum of the pressures [MPa]. stiffness: of a cell's own response [N/mm³]. compliance: own,
        streak and window, as of `influence.Operator.set_compliance`. anew: whether to start from nothing.
        parts: of the hardness, that cells bear; None: all of it.
        Raises ConvergenceError where the load cannot be balanced.
        """
        if compliance != self._compliance:
            self._compliance = compliance
            for place, values in zip(self._lines, self._influence.lines(*compliance), strict=True):
                place.assign(values)
            self._solve.weights.assign(list(self._influence.weights(*compliance)))
        wp.copy(self._gap, gap)
        self._take_parts(parts)
        self._asked.numpy()[:] = asked, stiffness
        if self._device.is_cpu:
            self._launch_all(anew)
        else:
            wp.capture_launch(self._graph(anew))
            wp.synchronize_stream(self._device.stream)
        found = dict(zip(Told, self._told.numpy().tolist(), strict=True))
        if found[Told.STATUS] == UNBALANCED:
            raise ConvergenceError(
                f"the load balance of the half-space missed {ROUGH_BALANCE:g} of the load."
            )
        return found

    def displacement(self) -> Any:
        """Displacement under the present pressure, by the last solve's compliances, shape (nx, ny) [mm]."""
        nx, ny = self._executor.grid.shape
        with arrays_of(self._executor) as (xp, view):
            xp.asarray(self._far.given)[:nx, :ny] = view(self._pressure)
        self._respond()
        return self.made

    @property
    def made(self) -> Any:
        """The displacement that was asked for last, shape (nx, ny) [mm]."""
        nx, ny = self._executor.grid.shape
        return self._far.made[:nx, :ny]

    def _take_parts(self, parts: Field | None) -> None:
        """Bound cells by these parts of the hardness; graphs hold whether there are any."""
        if (parts is None) != (self._parts is None):
            self._parts = None if parts is None else self._executor.zeros()
            none = wp.zeros(0, dtype=wp.float64, device=self._device)
            self._solve.parts = none if self._parts is None else self._numbers_of(self._parts)
            self._graphs.clear()
        if parts is not None and self._parts is not None:
            wp.copy(self._parts, parts)

    def _graph(self, anew: bool) -> Any:
        if anew not in self._graphs:
            for made in (self._far, self._near):
                made.transform()  # once before a capture: the library loads what it needs
            with wp.ScopedCapture(device=self._device) as capture:
                self._launch_all(anew)
            self._graphs[anew] = capture.graph
        return self._graphs[anew]

    def _launch_all(self, anew: bool) -> None:
        solve = self._solve
        wp.copy(solve.asked, self._asked)
        wp.launch(balance.start, dim=1, inputs=[solve], device=self._device)
        for _ in range(2):
            self._pass(balance.moments, balance.reckon_moments)
        if anew:
            self._pass(balance.spring, balance.weigh)
            wp.capture_while(solve.balancing, self._balance)
            self._pass(balance.take)
        self._pass(descent.present)
        self._respond()
        self._pass(descent.begin)
        self._pass(descent.advance, descent.judge)
        wp.capture_while(solve.searching, self._iterate)
        wp.copy(self._told, solve.told)

    def _iterate(self) -> None:
        wp.capture_if(self._solve.near, self._precondition)
        self._pass(descent.products, descent.aim)
        self._pass(descent.direction, balance.weigh)
        wp.capture_while(self._solve.balancing, self._balance)
        self._pass(descent.step)
        self._respond()
        self._pass(descent.respond, descent.go)
        self._pass(descent.advance, descent.judge)

    def _balance(self) -> None:
        self._pass(balance.carried, balance.weigh)

    def _precondition(self) -> None:
        self._pass(filters.scatter, filters.judge_scatter)
        self._pass(filters.residual)
        wp.capture_if(self._solve.extends, self._extend)
        self._filter(self._near, filters.divide_waves, self._tables[1], self._lines[1])
        wp.capture_if(self._solve.extends, self._gather)

    def _extend(self) -> None:
        near = self._solve.given_near, self._solve.made_near
        self._pass(filters.extend, inputs=near)
        self._pass(filters.extend, inputs=near[::-1])

    def _gather(self) -> None:
        self._pass(filters.gather)
        self._pass(filters.give)

    def _respond(self) -> None:
        self._filter(self._far, filters.pass_waves, self._tables[0], self._lines[0])

    def _filter(self, waves: Filter, kernel: Any, table: Field, line: Field) -> None:
        waves.forward()
        inputs = [table, line, waves.scale]
        wp.launch(kernel, dim=table.shape, inputs=inputs, outputs=[waves.waves], device=self._device)
        waves.back()

    def _pass(self, kernel: Any, decision: Any = None, *, inputs: tuple[Field, ...] = ()) -> None:
        """Launch a pass over the cells, and what decides by its sums and maxima. inputs: more of the pass."""
        block = 1 if self._device.is_cpu else BLOCK  # one thread on a CPU: for tests
        for what, blocks, more in ((kernel, self._solve.found.shape[1], inputs), (decision, 1, ())):
            if what is not None:
                arguments = [self._solve, *more]
                wp.launch(what, dim=blocks * block, inputs=arguments, device=self._device, block_dim=block)

    def _numbers_of(self, field: Field) -> Field:
        """A field seen as single numbers, shape (rows × columns,)."""
        shape = field.size * LANES
        return wp.array(ptr=field.ptr, dtype=wp.float64, shape=shape, device=self._device, copy=False)

    def _flag(self) -> Field:
        return wp.zeros(1, dtype=wp.int32, device=self._device)
