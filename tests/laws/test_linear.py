"""Linear systems against LAPACK's solutions, and those that do not fix every unknown."""

import numpy as np
import pytest

from warpwear.laws.linear import least_squares, solve


@pytest.mark.parametrize("count", [1, 2, 91, 256])
def test_solutions_are_those_of_lapack(count: int) -> None:
    rng = np.random.default_rng(count)
    root, right = rng.normal(size=(count, 2 * count)), rng.normal(size=(count, 3))
    matrix = root @ root.T
    np.testing.assert_allclose(solve(matrix, right), np.linalg.solve(matrix, right), rtol=1e-9, atol=1e-12)


def test_unknowns_that_are_not_fixed_are_zero() -> None:
    """Their equations hold all the same, and no rounding is blown up."""
    rng = np.random.default_rng(3)
    root = rng.normal(size=(30, 12))
    matrix = root @ root.T
    right = matrix @ rng.normal(size=(30, 1))
    x = solve(matrix, right, rcond=1e-12)
    assert np.count_nonzero(x) == 12
    np.testing.assert_allclose(matrix @ x, right, atol=1e-11)
    assert not solve(np.zeros((2, 2)), np.zeros((2, 1))).any()


def test_what_is_not_a_number_does_not_vanish() -> None:
    matrix = np.eye(3)
    matrix[1, 1] = np.nan
    assert np.isnan(solve(matrix, np.ones((3, 1)))).any()
    assert np.isnan(solve(np.eye(3), np.full((3, 1), np.nan))).all()


def test_least_squares_are_those_of_lapack() -> None:
    rng = np.random.default_rng(4)
    design, values = rng.normal(size=(50, 4)), rng.normal(size=50)
    expected = np.linalg.lstsq(design, values, rcond=None)[0]
    np.testing.assert_allclose(least_squares(design, values), expected, rtol=1e-13)
