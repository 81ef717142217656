"""What solve_contact refuses, or tells of, in its arguments and in what it finds."""

import warnings
from functools import partial
from pathlib import Path
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


def test_a_measured_surface_brings_its_cell(tmp_path: Path) -> None:
    np.save(tmp_path / "disc.npy", HEIGHTS)
    read = partial(warpwear.read_surface, tmp_path / "disc.npy", height_unit="um")
    surface = read(pixel="2 um")
    contact = warpwear.solve_contact(surface, mean_pressure=2e3, modulus=1e5)
    assert contact.cell == 0.002
    plain = warpwear.solve_contact(surface.heights, cell=0.002, mean_pressure=2e3, modulus=1e5)
    np.testing.assert_array_equal(contact.pressure, plain.pressure)
    for heights, cell, text in (
        (surface, 2e-6, r"cell = 2e-06 is not possible with pixels of \(0\.002, 0\.002\) mm; squares"),
        (read(pixel=("2 um", "3 um")), None, r"pixels of \(0\.002, 0\.003\) mm; squares are the cell"),
        (HEIGHTS, "2 um", r"cell = '2 um' is not possible; it must be a positive, finite number, without a"),
        (HEIGHTS, None, "cell = None is not possible"),
    ):
        with pytest.raises(InputError, match=text):
            warpwear.solve_contact(heights, cell=cell, mean_pressure=2e3, modulus=1e5)


def test_two_bodies_have_one_modulus() -> None:
    assert warpwear.effective_modulus((2e5, 0.3), (1e5, 0.2)) == pytest.approx(1 / (0.91 / 2e5 + 0.96 / 1e5))
    with pytest.raises(InputError, match=r"poisson = 0\.7"):
        warpwear.effective_modulus((2e5, 0.7), (1e5, 0.2))
