"""Filters of waves, which programs contain, against NumPy's transforms."""

from typing import Any

import numpy as np
import pytest
import warp as wp

from warpwear.contact.half_space import convolution
from warpwear.contact.half_space.convolution import Convolution
from warpwear.contact.half_space.filters import CupyFilter, ScipyFilter, filter_of
from warpwear.contact.half_space.influence import padded_shape
from warpwear.contact.half_space.transforms import Grids
from warpwear.engine.executor import Executor
from warpwear.engine.program import Program
from warpwear.grid import FloatArray, Grid

#: On a GPU the transforms need their library.
pytestmark = pytest.mark.transforms

#: Error over the largest value; measured were 1e-7 to 6e-7, and 2e-16 to 1e-15.
ERROR: dict[Any, float] = {np.float32: 1e-6, np.float64: 2e-15}
SHAPES = [
    ((32, 32), (32, 32)),
    ((20, 18), (20, 18)),
    ((75, 90), (75, 90)),
    ((16, 8), (32, 16)),
    ((33, 47), (80, 96)),
    ((100, 61), (200, 128)),
    ((5, 130), (9, 540)),
    ((57, 40), (57, 40)),
    ((38, 152), (38, 152)),
    ((77, 58), (77, 58)),
    ((13, 26), (13, 26)),
    ((49, 34), (121, 62)),
    ((19, 11), (38, 22)),
    ((31, 14), (74, 28)),
    ((199, 10), (398, 20)),
    ((200, 1), (400, 1)),
    ((30, 2), (60, 2)),
    ((1, 24), (1, 48)),
    ((1, 1), (1, 1)),
]
#: Of odd rows.
ODD = [
    ((7, 11), (7, 11)),
    ((45, 15), (45, 15)),
    ((20, 18), (49, 45)),
    ((38, 75), (38, 75)),
    ((6, 199), (6, 199)),
]
#: Of larger primes.
UNFIT = [((150, 257), (150, 257)), ((211, 12), (211, 12)), ((11, 422), (11, 422))]


class Case:
    """A table, a line and values to filter, and what comes out by NumPy."""

    def __init__(self, shape: tuple[int, int], *, divides: bool) -> None:
        draw = np.random.default_rng(1)
        self.shape, self.divides = shape, divides
        self.table = draw.random((shape[0] // 2 + 1, shape[1] // 2 + 1))
        self.line = 0.3 * draw.random(shape[0] // 2 + 1)
        self.table[0, 0] = self.line[0] = 0.0  # divided by it makes 0

    def __call__(self, values: FloatArray) -> FloatArray:
        """What is expected of values, shape (nx, ny)."""
        modes = np.arange(self.shape[0])
        factor = (self.table + self.line[:, np.newaxis])[np.minimum(modes, self.shape[0] - modes)]
        if self.divides:
            factor = np.divide(1.0, factor, out=np.zeros_like(factor), where=factor > 0.0)
        filtered = np.fft.irfft2(np.fft.rfft2(values, s=self.shape) * factor, s=self.shape)
        return np.asarray(filtered[: values.shape[0], : values.shape[1]])

    def of(self, executor: Executor) -> Any:
        """The line on a device."""
        return wp.array(self.line, dtype=wp.float64, device=executor.device)


@pytest.mark.parametrize("divides", [False, True])
@pytest.mark.parametrize("kind", [np.float32, np.float64])
@pytest.mark.parametrize(("cells", "shape"), SHAPES + ODD + UNFIT)
def test_a_filter_is_that_of_numpy(
    cells: tuple[int, int], shape: tuple[int, int], kind: Any, divides: bool, threads: int, device: str
) -> None:
    """Whatever the radices and the padding, and in place."""
    case, values = Case(shape, divides=divides), np.random.default_rng(2).normal(size=cells)
    expected = case(values)
    with Executor(Grid(*cells, 1.0), device=device, threads=threads) as executor:
        made = filter_of(executor, case.table, shape, kind)
        if device == "cpu":
            assert isinstance(made, Convolution if convolution.fits(shape) else ScipyFilter)
        field, out, line = executor.field(values.copy(), padding=7.0), executor.zeros(), case.of(executor)
        for target in (out, field):
            program = Program(executor)
            made.add_to(program, field, line, target, divides=divides)
            program.run()
        assert executor.to_numpy(out) == pytest.approx(expected, abs=ERROR[kind] * abs(expected).max())
        assert (executor.to_numpy(field) == executor.to_numpy(out)).all()
        padding = field.numpy().reshape(cells[0], -1)[:, cells[1] :]
        assert (padding == 7.0).all()


@pytest.mark.parametrize("kind", [np.float32, np.float64])
@pytest.mark.parametrize(("cells", "shape"), SHAPES)
def test_filters_of_a_library_are_those_of_kernels(
    cells: tuple[int, int], shape: tuple[int, int], kind: Any
) -> None:
    """Their kernels are those of a GPU, too."""
    case, values = Case(shape, divides=False), np.random.default_rng(2).normal(size=cells)
    with Executor(Grid(*cells, 1.0), threads=1) as executor:
        out = executor.zeros()
        program = Program(executor)
        ScipyFilter(executor, Grids.whole(executor), case.table, shape, kind).add_to(
            program, executor.field(values), case.of(executor), out
        )
        program.run()
        expected = case(values)
        assert executor.to_numpy(out) == pytest.approx(expected, abs=ERROR[kind] * abs(expected).max())


@pytest.mark.parametrize("kind", [np.float32, np.float64])
@pytest.mark.parametrize(
    ("side", "padded"), [(6, 6), (6, 12), (20, 20), (20, 48), (14, 38), (7, 7), (15, 15)]
)
def test_squares_are_filtered_one_by_one(
    side: int, padded: int, kind: Any, threads: int, device: str
) -> None:
    """Those that are visited, whatever was when the program was recorded; and the mean of a table changes."""
    count, columns = 5, 8 * -(-side // 8)
    case, values = (
        Case((padded, padded), divides=False),
        np.random.default_rng(2).normal(size=(5, side, side)),
    )
    with Executor(Grid(count, side * columns, 1.0), device=device, threads=threads) as executor:
        rows = np.full((count, side, columns), 7.0)
        rows[:, :, :side] = values
        grids = Grids.squares(executor, side)
        made = filter_of(executor, case.table, case.shape, kind, grids=grids)
        out, program = executor.field(np.full((count, side * columns), 9.0)), Program(executor)
        made.add_to(program, executor.field(rows.reshape(count, -1)), case.of(executor), out)
        for visited, mean in ((2, 0.0), (4, 0.5), (5, 0.7)):
            grids.visited.assign([visited])
            case.table[0, 0] = mean
            made.set_mean(mean)
            program.run()
            result = executor.to_numpy(out).reshape(count, side, columns)
            expected = np.array([case(square) for square in values[:visited]])
            allowed = ERROR[kind] * abs(expected).max()
            assert result[:visited, :, :side] == pytest.approx(expected, abs=allowed)
            assert (result[visited:] == 9.0).all()
            assert (result[:, :, side:] == 9.0).all()


@pytest.mark.parametrize(
    ("cells", "shape"),
    [
        ((40, 36), (80, 72)),
        ((45, 31), (45, 31)),
        ((57, 76), (57, 76)),
        ((33, 21), (77, 46)),
        ((45, 7), (211, 7)),
    ],
)
@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_threads_change_nothing(
    cells: tuple[int, int], shape: tuple[int, int], kind: Any, two_threads: int
) -> None:
    """To the last bit."""
    case, values, results = Case(shape, divides=True), np.random.default_rng(2).normal(size=cells), []
    for count in (1, two_threads):
        with Executor(Grid(*cells, 1.0), threads=count) as executor:
            assert executor.is_shared == (count > 1)
            field, program = executor.field(values.copy()), Program(executor)
            filter_of(executor, case.table, shape, kind).add_to(
                program, field, case.of(executor), field, divides=True
            )
            program.run()
            results.append(np.array(executor.to_numpy(field)))
    assert (results[0] == results[1]).all()


@pytest.mark.parametrize("kind", [np.float32, np.float64])
@pytest.mark.parametrize("shape", [(57, 40), (22, 154), (13, 199), (35, 75)])
def test_a_division_undoes_a_multiplication(shape: tuple[int, int], kind: Any, device: str) -> None:
    """Of every mode that there is; the mean is not."""
    case, values = Case(shape, divides=False), np.random.default_rng(2).normal(size=shape)
    case.table += 0.5
    case.table[0, 0] = 0.0
    with Executor(Grid(*shape, 1.0), device=device) as executor:
        made, program = filter_of(executor, case.table, shape, kind), Program(executor)
        field, line = executor.field(values), case.of(executor)
        for divides in (False, True):
            made.add_to(program, field, line, field, divides=divides)
        program.run()
        expected = values - values.mean()
        allowed = 2.0 * ERROR[kind] * abs(expected).max()  # two filters one after another
        assert executor.to_numpy(field) == pytest.approx(expected, abs=allowed)


def test_filters_share_memory(device: str) -> None:
    """One of single precision works in that of one of double precision, before it or after it."""
    cells, shapes = (24, 20), ((48, 40), (24, 20))
    values = np.random.default_rng(2).normal(size=cells)
    with Executor(Grid(*cells, 1.0), device=device) as executor:
        cases = [Case(shape, divides=False) for shape in shapes]
        far = filter_of(executor, cases[0].table, shapes[0], np.float64)
        near = filter_of(executor, cases[1].table, shapes[1], np.float32, within=far)
        if device == "cpu":
            assert isinstance(far, Convolution)
            assert isinstance(near, Convolution)
            assert [place.ptr for place in near.memory] == [place.ptr for place in far.memory]
        else:
            assert isinstance(far, CupyFilter)
            assert isinstance(near, CupyFilter)
            assert near.waves.ptr == far.waves.ptr
        field, outs = executor.field(values), [executor.zeros() for _ in range(2)]
        program = Program(executor)
        for made, case, out in zip((far, near), cases, outs, strict=True):
            made.add_to(program, field, case.of(executor), out)
        for _ in range(2):
            program.run()
            for kind, case, out in zip((np.float64, np.float32), cases, outs, strict=True):
                expected = case(values)
                allowed = ERROR[kind] * abs(expected).max()
                assert executor.to_numpy(out) == pytest.approx(expected, abs=allowed)


def test_lengths_of_larger_primes_do_not_fit() -> None:
    """They are left to SciPy; all others fit, and so does whatever a free boundary is padded to."""
    largest = convolution.LARGEST_PRIME
    assert convolution.fits((largest, 2 * largest))
    assert convolution.fits((64, largest))
    assert convolution.fits((64, 1))
    assert convolution.fits((1, 2))
    assert not convolution.fits((211, 64))
    assert not convolution.fits((64, 211))
    assert not convolution.fits((64, 422))
    for size in range(2, 400):
        assert convolution.fits(padded_shape(Grid(size, size + 7, 1.0)))
    for size in range(1, largest):
        assert convolution.fits((size, size))
