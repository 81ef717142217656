"""Displacements of all cells under a pressure on some of them, and tables that hold half of their rows."""

import numpy as np
import pytest
from cases_half_space import MODULUS, dense_free
from numpy.testing import assert_allclose, assert_array_equal

from warpwear.contact.half_space.influence import (
    Influence,
    apart_shape,
    displace,
    free_quarter,
    free_spectrum,
)
from warpwear.contact.half_space.transforms import ScipyTransforms, unfolded
from warpwear.engine.executor import Executor
from warpwear.grid import FloatArray, Grid


@pytest.fixture
def device(device: str) -> str:
    """On a GPU the transforms need their library."""
    if device != "cpu":
        pytest.importorskip("cupy")
    return device


def pressed(grid: Grid, box: tuple[int, int, int, int]) -> FloatArray:
    """A pressure in a box of first and last row, first and last column."""
    pressure = np.zeros(grid.shape)
    inside = pressure[box[0] : box[1] + 1, box[2] : box[3] + 1]
    inside[:] = np.random.default_rng(4).random(inside.shape)
    return pressure


BOXES = [(0, 0, 0, 0), (8, 8, 10, 10), (3, 5, 0, 4), (0, 8, 0, 10), (2, 8, 6, 9), (4, 4, 5, 5)]


@pytest.mark.parametrize("box", BOXES)
@pytest.mark.parametrize("shape", [(9, 11), (9, 48)])
def test_a_displacement_is_that_of_the_dense_matrix(
    box: tuple[int, int, int, int], shape: tuple[int, int], device: str, threads: int
) -> None:
    """Wherever the pressure lies: at an edge, in a corner, in the middle, on one cell, on all."""
    grid = Grid(*shape, 0.5)
    pressure = pressed(grid, box)
    expected = (dense_free(grid) @ pressure.ravel()).reshape(shape)
    with Executor(grid, device=device, threads=threads) as executor:
        found = executor.zeros()
        displace(executor, executor.field(pressure), found, modulus=MODULUS, box=box)
        assert_allclose(executor.to_numpy(found), expected, rtol=0.0, atol=1e-13 * expected.max())


def test_a_displacement_is_that_of_all_cells_together() -> None:
    """To rounding, on a grid of many blocks, with less padding than as many cells again."""
    grid, box = Grid(220, 300, 0.5), (60, 150, 40, 201)
    with Executor(grid) as executor:
        pressure = executor.field(pressed(grid, box))
        expected, found = executor.zeros(), executor.zeros()
        Influence(executor, modulus=MODULUS, boundary="free").respond(pressure, expected)
        displace(executor, pressure, found, modulus=MODULUS, box=box)
        expected, found = executor.to_numpy(expected), executor.to_numpy(found)
        assert_allclose(found, expected, rtol=0.0, atol=1e-14 * expected.max())
        assert apart_shape(grid, box) == (320, 540)


@pytest.mark.parametrize("shape", [(32, 48), (150, 132)])
@pytest.mark.parametrize("own", [0.0, 0.3])
def test_half_of_a_table_is_all_of_it(shape: tuple[int, int], own: float) -> None:
    """To the last bit, in double and in single precision, with and without a compliance."""
    grid = Grid(shape[0] // 2, shape[1] // 2, 0.5)
    with Executor(grid) as executor:
        pressure = executor.field(np.random.default_rng(1).random(grid.shape))
        quarter, results = free_quarter(grid, MODULUS, shape), []
        assert_array_equal(free_spectrum(grid, MODULUS, shape), unfolded(quarter, shape[0]))
        for whole in (False, True):
            transforms = ScipyTransforms(executor, shape)
            table = transforms.added(transforms.table(quarter), own, np.zeros(shape[0]))
            assert len(table) == shape[0] // 2 + 1
            if whole:
                table = unfolded(table, shape[0])
            for options in ({}, {"single": True}, {"divide": True}):
                found = executor.zeros()
                transforms.filter(pressure, table, found, **options)
                results.append(executor.to_numpy(found))
        for half, all_of_it in zip(results[:3], results[3:], strict=True):
            assert_array_equal(half, all_of_it)
            assert half.any()
