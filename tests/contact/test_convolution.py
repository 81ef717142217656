"""Convolutions in single precision beside those of NumPy."""

import numpy as np
import pytest

from warpwear.contact.half_space import convolution
from warpwear.contact.half_space.convolution import Convolution
from warpwear.contact.half_space.influence import padded_shape
from warpwear.engine.executor import Executor
from warpwear.grid import Grid

#: Of the largest value: measured were 1e-7 to 6e-7.
SINGLE = 1e-6


def even_table(shape: tuple[int, int], seed: int) -> np.ndarray:
    """A table that is even in both directions, as all responses are."""
    table = np.random.default_rng(seed).random((shape[0], shape[1] // 2 + 1))
    return table + table[-np.arange(shape[0]) % shape[0]]


@pytest.mark.parametrize(
    ("cells", "shape"),
    [
        ((32, 32), (32, 32)),
        ((20, 18), (20, 18)),
        ((75, 90), (75, 90)),
        ((16, 8), (32, 16)),
        ((33, 47), (80, 96)),
        ((100, 61), (200, 128)),
        ((5, 130), (9, 540)),
    ],
)
@pytest.mark.parametrize("threads", [1, 2])
def test_a_convolution_is_that_of_numpy(
    cells: tuple[int, int], shape: tuple[int, int], threads: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever the radices and the padding, and in place."""
    monkeypatch.setattr("warpwear.engine.executor.CELLS_PER_THREAD", 100)
    table, values = even_table(shape, 1), np.random.default_rng(2).normal(size=cells)
    expected = np.fft.irfft2(np.fft.rfft2(values, s=shape) * table, s=shape)[: cells[0], : cells[1]]
    with Executor(Grid(*cells, 1.0), threads=threads) as executor:
        made = Convolution(executor, shape)
        field, factors = executor.field(values, padding=7.0), made.table(table)
        out = executor.zeros()
        made.apply(field, factors, out)
        assert executor.to_numpy(out) == pytest.approx(expected, abs=SINGLE * abs(expected).max())
        made.apply(field, factors, field)
        assert (executor.to_numpy(field) == executor.to_numpy(out)).all()
        padding = field.numpy().reshape(cells[0], -1)[:, cells[1] :]
        assert (padding == 7.0).all()


def test_lengths_of_other_factors_do_not_fit() -> None:
    """They are left to SciPy, and so are odd rows; whatever a free boundary is padded to fits."""
    assert convolution.fits((64, 60))
    assert not convolution.fits((64, 61))
    assert not convolution.fits((64, 14))
    assert not convolution.fits((11, 64))
    for size in range(2, 400):
        assert convolution.fits(padded_shape(Grid(size, size + 7, 1.0)))
