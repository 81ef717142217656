"""What solve_contact refuses, or tells of, in its arguments and in what it finds."""

import warnings
from typing import Any

import numpy as np
import pytest

import warpwear
from warpwear.errors import InputError

HEIGHTS = np.random.default_rng(0).normal(size=(32, 32))
LAW = {"cell": 1.0, "modulus": 1.0}


@pytest.mark.parametrize(
    "heights",
    [
        np.full((4, 4), "2020-01-01", dtype="datetime64[D]"),
        np.full((4, 4), 3, dtype="timedelta64[s]"),
        np.full((4, 4), "1.5"),
        [["1", "2"], ["3", "4"]],
        np.zeros((4, 4), dtype=[("z", float)]),
        np.full((4, 4), "1.5", dtype=object),
    ],
    ids=["dates", "times", "text", "lists of text", "structures", "objects"],
)
def test_what_is_no_height_is_refused(heights: Any) -> None:
    with pytest.raises(InputError, match=r"they must be real numbers"):
        warpwear.solve_contact(heights, mean_pressure=0.01, **LAW)


@pytest.mark.parametrize("change", [{"cell": 1e300}, {"cell": 1e-300}, {"modulus": 1e200}])
def test_sizes_beyond_all_measure_are_refused(change: dict[str, float]) -> None:
    (name,) = change
    with pytest.raises(InputError, match=rf"{name} = .* is not possible; its size must be from 1e-100 to"):
        warpwear.solve_contact(HEIGHTS, mean_pressure=0.01, **LAW | change)
    with pytest.raises(InputError, match=r"heights up to .* are not possible"):
        warpwear.solve_contact(1e200 * HEIGHTS, mean_pressure=0.01, **LAW)


@pytest.mark.parametrize("tolerance", [1e9, 1.0, 0.02, 1e-15, 1e-90])
def test_tolerances_that_mean_nothing_are_refused(tolerance: float) -> None:
    with pytest.raises(InputError, match=r"tolerance = .*; it must be from 1e-14 to 0.01"):
        warpwear.solve_contact(HEIGHTS, mean_pressure=0.01, tolerance=tolerance, **LAW)


def test_a_contact_of_few_cells_is_told() -> None:
    with pytest.warns(UserWarning, match=r"the contact is of \d cells, .*, 9 in contact or more"):
        contact = warpwear.solve_contact(HEIGHTS, mean_pressure=1e-4, **LAW)
    assert np.count_nonzero(contact.pressure) < 9
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warpwear.solve_contact(HEIGHTS, mean_pressure=0.05, **LAW)
