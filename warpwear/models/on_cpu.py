"""Blocks of steps of a small contact on a CPU: one launch makes many, and their history is read in one piece.

Where a step asks for more than the launch can do, it makes no further, and that step is made by itself.
"""

from collections.abc import Callable, Iterator, Sequence
from itertools import accumulate, cycle
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
from warpwear.history.recorder import Step
from warpwear.kernels import blocks
from warpwear.kernels.blocks import BALANCE, MEMORY
from warpwear.kernels.cells import EXTENTS
from warpwear.laws.task import ContactTask

#: Steps of a block at most: interrupts and checkpoints wait for its end.
LONGEST_BLOCK = 500
#: Balance, sums and maxima of a step.
Found = tuple[Balance, dict[str, float], dict[str, float]]


class Block:
    """Steps of one contact in one launch of a kernel of `kernels.blocks`.

    inputs: of the kernel, those that follow the block. columns: names of what the kernel leaves of a step,
    sums and maxima in turns. stiffness: room for that of a row of cells. changes: that are remembered of the approach.
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
            blocks.Rules,
            tolerance=TOLERANCE,
            most=MAX_EVALUATIONS,
            hopeless=HOPELESS,
            first_reach=FIRST_REACH,
            surely=SURELY,
            digits=DIGITS,
            steps_ahead=STEPS_AHEAD,
        )
        self._arguments = arguments(
            blocks.Block,
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
        extents: dict[str, float],
        *,
        changes: Sequence[float] = (),
        **memory: float,
    ) -> tuple[list[Found], dict[str, float]]:
        """Make steps of a plan; return balance, sums and maxima of those made, and the memory after them.

        plan: of numbers by `kernels.blocks.PLAN`; steps: at most, of the plan's. extents: touched so far. memory, changes: by `kernels.blocks.MEMORY`.
        """
        begin = dict.fromkeys(MEMORY, 0.0) | memory | {name: extents[name] for name in EXTENTS}
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
        now.steps = steps
        while True:
            now.limit, now.asked = tiles.limit, tiles.asked
            inputs = [now, *self._inputs]
            self._executor.launch(
                self._kernel, inputs=inputs, outputs=[], over=tiles, chunks=[(0, 1)], often=True
            )
            if not known[MEMORY.index("asks")]:
                break
            tiles.reach(known[MEMORY.index("reach")], margin=known[MEMORY.index("margin")])
        made: list[Found] = []
        for row in found[: int(known[0])].tolist():
            base, offset, cap, residual, evaluations = row[: ends[0]]
            balance = Balance(base, offset, cap, residual, evaluations=int(evaluations))
            total: dict[str, float] = {}
            most: dict[str, float] = {}
            for kept, names, start, end in zip(cycle((total, most)), self._columns, ends, ends[1:], strict=False):
                kept.update(zip(names, row[start:end], strict=True))
            made.append((balance, total, most))
        return made, dict(zip(MEMORY, known.tolist(), strict=False))


def in_launches(
    steps: int,
    launch: Callable[[int], Sequence[Found]],
    enter: Callable[[int, Found], Step],
    alone: Callable[[int], Step],
) -> Iterator[tuple[int, Step]]:
    """Yield steps in order, each with the number of those that the state is ahead of it.

    launch: makes steps from a number on, perhaps none; enter: books one of them; alone: makes and books one.
    """
    done = 0
    while done < steps:
        made = launch(done)
        for left, found in zip(reversed(range(len(made))), made, strict=True):
            yield left, enter(done, found)
            done += 1
        if not made:
            yield 0, alone(done)
            done += 1
