"""A program does what it says: loops, branches and passes, however it is replayed."""

import gc
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import warp as wp
from numpy.testing import assert_array_equal

from warpwear.engine.executor import Executor, arguments
from warpwear.engine.program import Program, launch_once
from warpwear.grid import FloatArray, Grid
from warpwear.kernels import native_code

wp.set_module_options(native_code.options())

ROWS, COLUMNS = 60, 16
LIMIT = 1.0e6


@wp.func_native("store_sum(table, 0, slot, part);")
def store_part(table: wp.array2d(dtype=wp.float64), slot: wp.int32, part: wp.float64): ...


@wp.func_native("return sum_of_line(table, 0, 0, table.shape[1]);")
def total_of(table: wp.array2d(dtype=wp.float64)) -> wp.float64: ...


@wp.struct
class Numbers:
    factor: wp.float64
    more: wp.array(dtype=wp.float64)


@wp.struct
class Collatz:
    """A number and the flags that follow from it; how often each number changes on its way to 1."""

    number: wp.array(dtype=wp.int32)
    start: wp.array(dtype=wp.int32)
    is_odd: wp.array(dtype=wp.int32)
    is_even: wp.array(dtype=wp.int32)
    goes_on: wp.array(dtype=wp.int32)
    is_left: wp.array(dtype=wp.int32)
    changes: wp.array(dtype=wp.int32)


@wp.kernel
def begin(c: Collatz):
    """Take the next number."""
    if wp.tid() == 0:
        c.number[0] = c.start[0]
        c.goes_on[0] = wp.where(c.number[0] > 1, 1, 0)


@wp.kernel
def change(times: wp.int32, plus: wp.int32, parts: wp.int32, c: Collatz):
    """Multiply the number, add to it, divide it."""
    if wp.tid() == 0:
        c.number[0] = (times * c.number[0] + plus) // parts
        start = c.start[0]
        c.changes[start] = c.changes[start] + 1


@wp.kernel
def judge(c: Collatz):
    """Say what is to be done with the number."""
    if wp.tid() == 0:
        c.is_odd[0] = c.number[0] % 2
        c.is_even[0] = 1 - c.is_odd[0]
        c.goes_on[0] = wp.where(c.number[0] > 1, 1, 0)


@wp.kernel
def end(c: Collatz):
    """Go to the next number, as long as there are some."""
    if wp.tid() == 0:
        c.start[0] = c.start[0] - 1
        c.is_left[0] = wp.where(c.start[0] > 0, 1, 0)


@wp.kernel
def grow(
    first_slot: wp.int32,
    slots: wp.int32,
    numbers: Numbers,
    values: wp.array2d(dtype=wp.float64),
    table: wp.array2d(dtype=wp.float64),
):
    """Multiply all values by a number and add another one to them; leave their sum."""
    slot = first_slot + wp.tid() // wp.block_dim()
    part = wp.float64(0.0)
    for row in range(slot, values.shape[0], slots):
        for column in range(wp.tid() % wp.block_dim(), values.shape[1], wp.block_dim()):
            values[row, column] = numbers.factor * values[row, column] + numbers.more[0]
            part += values[row, column]
    store_part(table, slot, part)


@wp.kernel
def weigh(
    limit: wp.float64,
    table: wp.array2d(dtype=wp.float64),
    searching: wp.array(dtype=wp.int32),
    rounds: wp.array(dtype=wp.int32),
):
    """Go on until the sum is above a limit."""
    total = total_of(table)
    if wp.tid() == 0:
        rounds[0] = rounds[0] + 1
        searching[0] = wp.where(total < limit, 1, 0)


class Growing:
    """Values that grow in a program until their sum is above a limit."""

    def __init__(self, device: str, threads: int, *, chunks: Any = None, **options: bool) -> None:
        self.executor = Executor(Grid(ROWS, COLUMNS, 1.0), device=device, threads=threads)
        slots = self.executor.slots_of(ROWS)
        start = 1.0 / (1.0 + np.arange(ROWS * COLUMNS).reshape(ROWS, COLUMNS))
        self.values = wp.array(start, dtype=wp.float64, device=device)
        self.more = wp.array([0.25], dtype=wp.float64, device=device)
        self.searching, self.rounds = (wp.array([n], dtype=wp.int32, device=device) for n in (1, 0))
        table = wp.zeros((1, slots), dtype=wp.float64, device=device)
        self.numbers = arguments(Numbers, factor=1.25, more=self.more)
        self.program = Program(self.executor, **options)
        with self.program.loop(self.searching):
            self.program.launch(grow, self.numbers, self.values, table, slots=slots, chunks=chunks)
            self.program.decide(weigh, LIMIT, table, self.searching, self.rounds)

    def run(self) -> tuple[FloatArray, int]:
        """Values and rounds after another run; they begin anew."""
        self.executor.put(self.searching, 1)
        self.executor.put(self.values, 1.0 / (1.0 + np.arange(ROWS * COLUMNS).reshape(ROWS, COLUMNS)))
        self.executor.put(self.rounds, 0)
        self.program.run()
        return self.values.numpy().copy(), int(self.rounds.numpy()[0])


def expected(more: float = 0.25) -> tuple[FloatArray, int]:
    values = 1.0 / (1.0 + np.arange(ROWS * COLUMNS).reshape(ROWS, COLUMNS))
    rounds = 0
    while rounds == 0 or values.sum() < LIMIT:
        values, rounds = 1.25 * values + more, rounds + 1
    return values, rounds


def test_a_loop_ends_by_its_decision(device: str, threads: int) -> None:
    """Also when it is replayed, and when it is not recorded: with the same bits."""
    values, rounds = expected()
    growing = Growing(device, threads)
    bits, count = growing.run()
    np.testing.assert_allclose(bits, values, rtol=1e-13)
    assert count == rounds > 10
    for other in (growing, Growing(device, threads, records=False), Growing(device, threads, shares=False)):
        again, count = other.run()
        assert_array_equal(again, bits)
        assert count == rounds


def test_threads_change_no_bit(threads: int) -> None:
    many = Growing("cpu", threads)
    (bits, rounds), (expected_bits, expected_rounds) = many.run(), Growing("cpu", 1).run()
    assert many.executor.is_shared == (threads > 1)
    assert rounds == expected_rounds
    assert_array_equal(bits, expected_bits)


@pytest.mark.parametrize("records", [True, False])
def test_what_lies_in_arrays_may_change(device: str, threads: int, records: bool) -> None:
    growing = Growing(device, threads, records=records)
    growing.run()
    growing.executor.put(growing.more, 0.5)
    values, rounds = growing.run()
    wanted, wanted_rounds = expected(more=0.5)
    np.testing.assert_allclose(values, wanted, rtol=1e-13)
    assert rounds == wanted_rounds < expected()[1]


def test_numbers_stay_as_they_were_recorded(device: str) -> None:
    growing = Growing(device, 1)
    values, _ = growing.run()
    growing.numbers.factor = 2.0
    assert_array_equal(growing.run()[0], values)


def test_a_recording_is_replayed_without_the_host(watch: Callable[..., None]) -> None:
    """The host makes no launch; of a program that is not recorded, it makes each."""
    counts = [0]

    def count(*_: Any) -> None:
        counts[-1] += 1

    watch(wp.Launch, "launch", count)
    recorded, walked = Growing("cpu", 1), Growing("cpu", 1, records=False)
    recorded.run()
    for growing in (recorded, walked):
        counts.append(0)
        growing.run()
    assert counts[1:] == [0, 2 * expected()[1]]


def test_chunks_are_asked_for_anew_in_each_round(threads: int) -> None:
    """Of two threads, which then share the slots in ever other ways: the values are the same."""
    rng, calls = np.random.default_rng(3), []

    def chunks() -> list[tuple[int, int]]:
        middle = int(rng.integers(0, ROWS + 1))
        calls.append(middle)
        return [chunk for chunk in ((0, middle), (middle, ROWS)) if chunk[1] > chunk[0]]

    growing = Growing("cpu", threads, chunks=chunks)
    values, rounds = growing.run()
    assert_array_equal(values, Growing("cpu", 1).run()[0])
    assert len(calls) == (rounds if threads > 1 else 0)


def changes_of(number: int) -> int:
    changes = 0
    while number > 1:
        number, changes = 3 * number + 1 if number % 2 else number // 2, changes + 1
    return changes


@pytest.mark.parametrize("records", [True, False])
def test_loops_and_branches_stand_within_each_other(device: str, records: bool) -> None:
    """Numbers by the rule of Collatz, whose courses differ: from 30 down to 1."""
    most = 30
    with Executor(Grid(ROWS, COLUMNS, 1.0), device=device) as executor:
        numbers = {name: wp.zeros(1, dtype=wp.int32, device=device) for name in Collatz.vars}
        numbers["changes"] = wp.zeros(most + 1, dtype=wp.int32, device=device)
        c = arguments(Collatz, **numbers)
        program = Program(executor, records=records)
        with program.loop(c.is_left):
            program.decide(begin, c)
            program.decide(judge, c)
            with program.loop(c.goes_on):
                with program.branch(c.is_odd):
                    program.decide(change, 3, 1, 1, c)
                with program.branch(c.is_even):
                    program.decide(change, 1, 0, 2, c)
                program.decide(judge, c)
            program.decide(end, c)
        for _ in range(2):
            executor.put(c.start, most)
            executor.put(c.is_left, 1)
            executor.put(c.changes, 0)
            program.run()
            assert c.changes.numpy().tolist() == [0, *map(changes_of, range(1, most + 1))]
        program.run()  # none is left: nothing changes
        assert c.changes.numpy().tolist() == [0, *map(changes_of, range(1, most + 1))]


def test_a_step_of_the_host_stands_in_a_loop(device: str, threads: int) -> None:
    """It ends a recording on a CPU; on a GPU it is captured. What is before it is done before it."""
    growing = Growing(device, threads)
    executor, seen = growing.executor, []
    before, after = (wp.zeros_like(growing.values) for _ in range(2))
    table = wp.zeros((1, ROWS), dtype=wp.float64, device=device)

    def copies() -> None:
        seen.append(1)
        wp.copy(after, before)

    program = Program(executor)
    with program.loop(growing.searching):
        program.launch(grow, growing.numbers, before, table, slots=ROWS)
        program.call(copies)
        program.launch(grow, arguments(Numbers, factor=1.0, more=growing.more), after, table, slots=ROWS)
        program.decide(weigh, LIMIT, table, growing.searching, growing.rounds)
    for _ in range(2):
        before.zero_()
        after.zero_()
        executor.put(growing.searching, 1)
        program.run()
        assert before.numpy().min() > 0.0
        assert_array_equal(after.numpy(), before.numpy() + 0.25)
        assert after.numpy().sum() >= LIMIT
    rounds = int(growing.rounds.numpy()[0])
    assert len(seen) == (1 if executor.device.is_cuda else rounds)


def test_nothing_is_added_to_a_program_that_has_run() -> None:
    growing = Growing("cpu", 1)
    growing.run()
    with pytest.raises(AssertionError):
        growing.program.decide(weigh, LIMIT, growing.values, growing.searching, growing.rounds)


def test_what_python_forgets_in_the_middle_of_a_recording(device: str) -> None:
    """Nothing is freed then: a plan of cuFFT that is freed ends the recording of a GPU."""
    growing = Growing(device, 1)
    circle: list[Any] = []
    circle.append(circle)  # so that only the garbage collector frees it
    if device != "cpu":
        cufft = pytest.importorskip("cupy").cuda.cufft
        circle.append(cufft.PlanNd((64, 64), None, 1, 0, None, 1, 0, cufft.CUFFT_D2Z, 1, "C", 1, None))
    kept = [circle]
    del circle

    def forgets() -> None:
        kept.clear()
        if gc.isenabled():  # then it may begin at any time
            gc.collect()

    table = wp.zeros((1, ROWS), dtype=wp.float64, device=device)
    program = Program(growing.executor)
    program.launch(grow, growing.numbers, growing.values, table, slots=ROWS)
    program.call(forgets)
    program.launch(grow, growing.numbers, growing.values, table, slots=ROWS)
    program.run()
    start = 1.0 / (1.0 + np.arange(ROWS * COLUMNS).reshape(ROWS, COLUMNS))
    np.testing.assert_allclose(growing.values.numpy(), 1.25 * (1.25 * start + 0.25) + 0.25, rtol=1e-15)


def test_a_launch_of_its_own(device: str, threads: int) -> None:
    growing = Growing(device, threads)
    table = wp.zeros((1, ROWS), dtype=wp.float64, device=device)
    before = growing.values.numpy().copy()
    launch_once(growing.executor, grow, growing.numbers, growing.values, table, slots=ROWS)
    np.testing.assert_allclose(growing.values.numpy(), 1.25 * before + 0.25, rtol=1e-15)
    np.testing.assert_allclose(table.numpy().sum(), growing.values.numpy().sum(), rtol=1e-13)
