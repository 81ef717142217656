"""A program holds passes over cells, decisions, loops and branches: written once, replayed on a device.

    program = Program(executor)
    with program.loop(searching):           # while searching[0] is not 0
        program.launch(carried, fields)     # a pass: a slot is a row of cells on a CPU, a block on a GPU
        program.decide(judge, fields)       # one slot: reads what the pass has left, and writes `searching`
    program.run()

What follows from a pass is decided on the device: a program asks the host nothing. A GPU replays it as a
graph. A CPU replays it as a recorded loop on one core, as long as no pass is large enough to be shared among
threads. Such passes, and `call`, which is a step of the host, end a recording: the host then goes from one to
the next and reads the flags of loops and branches. All three ways make the same launches in the same order.

A launch is recorded with the arguments that it was added with: numbers among them stay. What changes from
one run to the next has to be in arrays. A recording knows a kernel by its module and its name, so that
overloads of a generic kernel need names of their own.
"""

import gc
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import warp as wp

from warpwear.engine.executor import BLOCK, GATE, Executor, Field
from warpwear.kernels.native_code import RANGED

Chunks = Sequence[tuple[int, int]]


class Launch:
    """Launches a kernel, shared among threads where its chunks say so.

    chunks: ranges of slots for the threads, or a function that returns them anew for each run. slots: their
    number; None for a decision, whose kernel takes neither the first slot nor their number.
    """

    def __init__(
        self,
        executor: Executor,
        kernel: Any,
        arguments: Sequence[Any],
        slots: int | None,
        chunks: Chunks | Callable[[], Chunks],
    ) -> None:
        self._executor, self._chunks = executor, chunks
        self._kernel = executor.load(kernel)  # a recording cannot load it
        self._slots, self._arguments = slots, arguments
        self._takes_range = self._kernel in RANGED
        self._commands: list[tuple[Any, tuple[int, int]]] = []
        #: Whether it is one loop on one core, which a recording can hold.
        self.is_recordable = not executor.is_shared or not (callable(chunks) or len(chunks) > 1)
        if self.is_recordable:
            self._command(0, (0, slots or 1))

    def run(self) -> None:
        """Launch the kernel over all of its slots."""
        if self.is_recordable:
            with GATE:
                self._commands[0][0].launch()
            return
        chunks = self._chunks() if callable(self._chunks) else self._chunks
        commands = [self._command(number, chunk) for number, chunk in enumerate(chunks)]
        with GATE:
            self._executor.on_threads([command.launch for command in commands])

    def _command(self, number: int, chunk: tuple[int, int]) -> Any:
        """Return the recorded launch of one thread, over a range of slots."""
        (first, end), device = chunk, self._executor.device
        width = 1 if device.is_cpu else BLOCK
        is_range = self._takes_range and device.is_cpu
        if number == len(self._commands):
            place = [] if self._slots is None else [first, *[end] * self._takes_range, self._slots]
            command = wp.launch(
                self._kernel,
                dim=1 if is_range else (end - first) * width,
                inputs=[*place, *self._arguments],
                device=device,
                block_dim=width,
                record_cmd=True,
            )
            self._commands.append((command, chunk))
            return command
        command, (first_before, end_before) = self._commands[number]
        if is_range:
            command.set_param_at_index_from_ctype(1, end)
        elif end - first != end_before - first_before:
            command.set_dim(end - first)
        if first != first_before:
            command.set_param_at_index_from_ctype(0, first)
        self._commands[number] = command, chunk
        return command


@dataclass(frozen=True)
class Call:
    """Calls a step of the host, such as a transform of a library; on a GPU one that a stream can capture."""

    run: Callable[[], Any]
    is_recordable: bool


class Branch:
    """Runs parts of a program, one after another, under a flag of the device or under none.

    flag: array of one number, 0 to skip the parts. repeats: whether it is read again after the last part.
    """

    def __init__(self, flag: Field | None = None, *, repeats: bool = False) -> None:
        self.nodes: list[Node] = []  # parts
        self._flag, self._repeats = flag, repeats

    @property
    def is_recordable(self) -> bool:
        """Tell whether a CPU can replay this part from a recording."""
        return all(node.is_recordable for node in self.nodes)

    def run(self) -> None:
        """Run all parts, as often as the flag says."""
        if self._flag is None:
            self._run_all()
        elif self._repeats:
            wp.capture_while(self._flag, self._run_all)
        else:
            wp.capture_if(self._flag, self._run_all)

    def _run_all(self) -> None:
        for node in self.nodes:
            node.run()

    def record(self, device: Any) -> None:
        """Record the parts that can be recorded, in as few recordings as possible; the flag stays."""
        recorded: list[Node] = []
        together = Branch()
        for node in [*self.nodes, None]:
            if node is not None and node.is_recordable:
                together.nodes.append(node)
                continue
            if together.nodes:
                recorded.append(Recording(together, device))
                together = Branch()
            if isinstance(node, Branch):
                node.record(device)
            if node is not None:
                recorded.append(node)
        self.nodes = recorded


class Recording:
    """Holds parts of a program as a graph that a device replays."""

    is_recordable = False  # a second time

    def __init__(self, block: Branch, device: Any) -> None:
        self._block = block  # keeps the arrays alive that the graph reads
        with GATE, _nothing_collected(), wp.ScopedCapture(device=device) as capture:
            block.run()
        self._graph = capture.graph

    def run(self) -> None:
        """Replay the graph."""
        wp.capture_launch(self._graph)


#: A part of a program runs at once, or is added to a recording where it is recordable.
Node = Launch | Call | Branch | Recording


@contextmanager
def _nothing_collected() -> Iterator[None]:
    """Keep Python's garbage collector still: a plan of cuFFT that it frees would end a GPU's recording."""
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


class Program:
    """Runs passes and decisions on an executor. Nothing can be added once it has run.

    shares: whether threads share its passes, where there are enough cells; else it is of one core. records:
    at which run it is recorded, 0 for never: that takes about as long as making a few of its launches.
    """

    def __init__(self, executor: Executor, *, shares: bool = True, records: int = 1) -> None:
        self._executor, self._shares = executor, shares
        self._whole = Branch()
        self._open = [self._whole]
        self._records, self._runs = records, 0

    def launch(
        self,
        kernel: Any,
        *arguments: Any,
        slots: int | None = None,
        chunks: Chunks | Callable[[], Chunks] | None = None,
    ) -> None:
        """Add a pass: a kernel that takes the first slot, the number of slots and the arguments.

        slots: by default those of the executor's grid, see `Executor.slots_of`. chunks: ranges of them for
        the threads, or a function that returns them; by default rows of equal cost.
        """
        executor = self._executor
        slots = executor.slots_of(executor.grid.nx) if slots is None else slots
        if not self._shares:
            chunks = [(0, slots)]
        elif chunks is None:
            chunks = executor.equal_chunks(slots)
        self._add(Launch(executor, kernel, arguments, slots, chunks))

    def decide(self, kernel: Any, *arguments: Any) -> None:
        """Add a decision: a kernel of one slot, which takes the arguments alone."""
        self._add(Launch(self._executor, kernel, arguments, None, [(0, 1)]))

    def call(self, function: Callable[[], Any]) -> None:
        """Add a step of the host. On a GPU it is captured: it only queues work in the device's stream."""
        self._add(Call(function, self._executor.device.is_cuda))

    @contextmanager
    def loop(self, flags: Field, place: int = 0) -> Iterator[None]:
        """Repeat what is added within while a number of flags, int32, is not 0."""
        yield from self._within(Branch(flags[place : place + 1], repeats=True))

    @contextmanager
    def branch(self, flags: Field, place: int = 0) -> Iterator[None]:
        """Do what is added within if a number of flags, int32, is not 0."""
        yield from self._within(Branch(flags[place : place + 1]))

    @contextmanager
    def on(self, executor: Executor) -> Iterator[None]:
        """Add what is added within for the grid of another executor of this device."""
        own, self._executor = self._executor, executor
        try:
            yield
        finally:
            self._executor = own

    def run(self) -> None:
        """Replay the program; on a GPU it is queued."""
        self._runs += 1
        if self._runs == self._records:
            self._whole.record(self._executor.device)
        self._whole.run()

    def _within(self, block: Branch) -> Iterator[None]:
        self._add(block)
        self._open.append(block)
        try:
            yield
        finally:
            self._open.pop()

    def _add(self, node: Node) -> None:
        assert not self._runs
        self._open[-1].nodes.append(node)


def launch_once(executor: Executor, kernel: Any, *arguments: Any, **options: Any) -> None:
    """Launch a kernel now, in a program of its own; arguments and options as of `Program.launch`."""
    program = Program(executor, records=False)
    program.launch(kernel, *arguments, **options)
    program.run()
