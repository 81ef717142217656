"""Blocks of steps of a small contact on a CPU: one launch makes many, and their history is read in one piece.

Where a step asks for more than the launch can do, it makes no further, and that step is made by itself.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import accumulate
from typing import Any

import numpy as np
import warp as wp

from warpwear.contact.balance import (
    DIGITS,
    FIRST_REACH,
    HOPELESS,
    MAX_EVALUATIONS,
    STEPS_AHEAD,
    SURELY,
    TOLERANCE,
    Balance,
)
from warpwear.engine.executor import Arguments, Executor, Field, arguments
from warpwear.engine.tiles import TileList
from warpwear.grid import FloatArray
from warpwear.history.recorder import Ledger, Step
from warpwear.kernels.blocks import steps as block_steps
from warpwear.kernels.blocks.steps import BALANCE, MEMORY
from warpwear.kernels.cells import EXTENTS
from warpwear.laws.task import ContactTask
from warpwear.models.booking import Found


class Block:
    """Steps of one contact in one launch of a kernel of `kernels.blocks`.

    inputs: of the kernel, those that follow the block. columns: names of what the kernel leaves of a step,
    sums and maxima in turns. stiffness: room for that of a row of cells. changes: of the approach, that are
    remembered.
    """

    def __init__(
        self,
        executor: Executor,
        task: ContactTask,
        kernel: Any,
        inputs: Sequence[Arguments],
        columns: Sequence[Sequence[str]],
        *,
        stiffness: Field = None,
        changes: int = 0,
    ) -> None:
        self._executor, self._kernel, self._inputs = executor, kernel, inputs
        self._columns, self._changes = columns, changes
        rules = arguments(
            block_steps.Rules,
            tolerance=TOLERANCE,
            most=MAX_EVALUATIONS,
            hopeless=HOPELESS,
            first_reach=FIRST_REACH,
            surely=SURELY,
            digits=DIGITS,
            steps_ahead=STEPS_AHEAD,
        )
        self._arguments = arguments(
            block_steps.Block,
            rules=rules,
            sums=executor.partials(2),
            stiffness=executor.zeros(1) if stiffness is None else stiffness,
            load=task.load,
            hardness=task.hardness,
            cell_area=executor.grid.cell_area,
        )

    def run(
        self,
        plan: FloatArray,
        steps: int,
        tiles: TileList,
        ledger: Ledger,
        memory: Mapping[str, float],
        *,
        changes: Iterable[float] = (),
    ) -> tuple[Found, dict[str, float]]:
        """Make steps of a plan; return balance, sums and maxima of those made, and the memory after them.

        plan: numbers of each step by `kernels.blocks.steps.PLAN`; steps: at most. ledger: of the contact.
        memory, changes: by `kernels.blocks.steps.MEMORY`.
        """
        changes = [*changes]
        begin = dict.fromkeys(MEMORY, 0.0) | dict(memory) | {name: ledger.most[name] for name in EXTENTS}
        known = np.full(len(MEMORY) - 1 + self._changes, -1.0)
        known[: len(MEMORY) - 1] = [*begin.values()][:-1]
        known[len(MEMORY) - 1 :][: len(changes)] = changes
        if self._changes:
            known[MEMORY.index("oldest")] = len(changes) % self._changes
        ends = [*accumulate((len(names) for names in self._columns), initial=len(BALANCE))]
        found, now = np.zeros((steps, ends[-1])), self._arguments
        now.plan, now.memory, now.found = (
            wp.array(values, dtype=wp.float64, device="cpu", copy=False) for values in (plan, known, found)
        )
        now.within = wp.array(ledger.within, dtype=wp.float64, device="cpu")
        now.steps = steps
        while True:
            now.limit, now.asked = tiles.limit, tiles.asked
            inputs = [now, *self._inputs]
            self._executor.launch(
                self._kernel, inputs=inputs, outputs=[], over=tiles, chunks=[(0, 1)], often=True
            )
            if not known[MEMORY.index("asks")]:
                break
            tiles.reach(float(known[MEMORY.index("reach")]), margin=float(known[MEMORY.index("margin")]))
        made = int(known[0])
        of_steps = np.ascontiguousarray(found[:made].T)
        base, offset, cap, residual, evaluations, reference = of_steps[: ends[0]]
        groups = [
            dict(zip(names, of_steps[end:], strict=False))
            for names, end in zip(self._columns, ends, strict=False)
        ]
        total, most = ({k: v for group in groups[i::2] for k, v in group.items()} for i in (0, 1))
        none = np.zeros(made)  # no ties: a launch makes no such step
        balance: Any = (base, offset, cap, residual, none, none, evaluations)
        return Found(made, Balance(*balance), reference, total, most), dict(
            zip(MEMORY, known.tolist(), strict=False)
        )


def in_launches(
    steps: int, launch: Callable[[int], tuple[int, Iterable[Step]]], alone: Callable[[int], Step]
) -> Iterator[tuple[int, Step]]:
    """Yield steps in order, each with the number of those that the state is ahead of it.

    launch: makes steps from a number on, perhaps none, and books them; alone: makes and books one.
    """
    done = 0
    while done < steps:
        made, booked_now = launch(done)
        yield from zip(reversed(range(made)), booked_now, strict=True)
        if not made:
            yield 0, alone(done)
        done += max(made, 1)
