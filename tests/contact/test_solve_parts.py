"""warpwear.solve_contact looks for a small contact where it is and works in blocks of rows: little memory."""

import tracemalloc
from functools import cache
from typing import Any

import numpy as np
import pytest
from cases_half_space import rough
from cases_solve import HEIGHTS
from numpy.testing import assert_allclose

from warpwear import solve_contact
from warpwear.contact.array import elastic, memory, workplace
from warpwear.contact.half_space.solver import HalfSpace
from warpwear.engine import staging
from warpwear.errors import InputError
from warpwear.grid import Grid

#: On a GPU the transforms need their library.
pytestmark = pytest.mark.transforms


def test_the_largest_contact_of_a_gpu_needs_little_of_its_host(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Beside the heights, 8 GiB here, the pressure and the gap: measured were 26 GiB in all."""
    there = {"the host": 26 * 2**30, "cuda:0": 130 * 2**30}
    monkeypatch.setattr(memory, "free_memory", lambda device: there)
    monkeypatch.setattr(memory, "find_device", lambda device: None)
    monkeypatch.setattr(memory, "release", lambda device: None)
    memory.check_memory((32768, 32768), "cuda:0", "periodic")
    assert "24.0 GiB of the host (26.0 GiB free) and 124.0 GiB of cuda:0" in capsys.readouterr().err
    there["the host"] = 18 * 2**30
    with pytest.raises(InputError, match=r"24\.0 GiB of memory; the host has 18\.0 GiB free"):
        memory.check_memory((32768, 32768), "cuda:0", "periodic")


@pytest.mark.parametrize("counter_radius", [None, 30.0])
def test_blocks_of_rows_change_nothing(
    monkeypatch: pytest.MonkeyPatch, device: str, counter_radius: float | None
) -> None:
    options: dict[str, Any] = {"cell": 0.5, "mean_pressure": 0.02, "modulus": 2.0, "hardness": 0.5}
    options |= {"counter_radius": counter_radius, "tolerance": 1e-9, "device": device}
    whole = solve_contact(HEIGHTS, **options)
    monkeypatch.setattr(staging, "TOGETHER", 500)
    blocks = solve_contact(HEIGHTS, **options)
    largest = whole.pressure.max()
    assert_allclose(blocks.pressure, whole.pressure, rtol=0.0, atol=1e-9 * largest)
    assert_allclose(blocks.gap, whole.gap, rtol=0.0, atol=1e-9 * np.ptp(HEIGHTS))
    assert blocks.load == pytest.approx(whole.load, rel=1e-12)


#: Heights of a rough free surface whose contact lies in a part of it, loads and approaches.
TOP = rough(Grid(160, 152, 0.25), shortest=30, rms=0.02)
TOP -= 0.004 * np.add.outer((Grid(160, 1, 0.25).x - 3.0) ** 2, (Grid(1, 152, 0.25).y + 4.0) ** 2)
GUESSES: dict[str, Any] = {
    "as it is": None,
    "one cell": lambda *_: (80, 80, 76, 76),
    "elsewhere": lambda *_: (0, 20, 120, 151),
    "unknown": lambda *_: None,
}


OF_PARTS: dict[str, Any] = {"modulus": 1.0, "boundary": "free", "tolerance": 1e-9, "cell": 0.25}


@cache
def wholly_solved(width: int, hardness: float | None, device: str) -> Any:
    """The contact where all cells are looked at from the start."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(elastic, "_guess", lambda *_: (0, 159, 0, width - 1))
        options = OF_PARTS | {"hardness": hardness, "device": device}
        return solve_contact(TOP[:, :width], mean_pressure=0.002, **options)


@pytest.mark.parametrize("guess", GUESSES)
@pytest.mark.parametrize("hardness", [None, 0.05])
@pytest.mark.parametrize("width", [152, 149])
def test_a_contact_of_a_part_is_that_of_all_cells(
    guess: str, hardness: float | None, width: int, device: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Wherever it is looked for first."""
    heights = TOP[:, :width]
    options = OF_PARTS | {"hardness": hardness, "device": device}
    whole = wholly_solved(width, hardness, device)
    assert 0 < np.count_nonzero(whole.pressure) < 0.3 * heights.size
    if GUESSES[guess] is not None:
        monkeypatch.setattr(elastic, "_guess", GUESSES[guess])
    for asked in ({"mean_pressure": 0.002}, {"approach": whole.approach}):
        found = solve_contact(heights, **asked, **options)
        assert found.approach == pytest.approx(whole.approach, rel=1e-8)
        assert_allclose(found.pressure, whole.pressure, atol=2e-6 * whole.pressure.max())
        assert_allclose(found.gap, whole.gap, atol=1e-8 * np.ptp(heights))
        assert found.residual <= 1e-9


def test_a_contact_is_looked_for_where_it_is() -> None:
    """Small windows are what memory and time go by: the first one does, and is not much larger."""
    solved: list[tuple[int, int]] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(workplace, "HalfSpace", watched(solved))
        asked = {"load": 0.5}
        for _ in range(2):
            workplace._kept.clear()  # solvers that are kept are not made again
            found = solve_contact(TOP, cell=0.25, modulus=1.0, boundary="free", **asked)
            asked = {"approach": found.approach}
            rows, columns = (np.flatnonzero(found.pressure.any(axis=axis)) for axis in (1, 0))
            wide, window = solved
            assert max(wide) <= elastic.WIDE_CELLS
            assert window[0] * window[1] < 0.5 * TOP.size
            assert np.ptp(rows) < window[0] <= 1.5 * np.ptp(rows) + 32
            assert np.ptp(columns) < window[1] <= 1.5 * np.ptp(columns) + 32
            solved.clear()


def watched(solved: list[tuple[int, int]]) -> type[HalfSpace]:
    """A solver that notes the shapes of its grids."""

    class Watched(HalfSpace):
        def __init__(self, executor: Any, **options: Any) -> None:
            solved.append(executor.grid.shape)
            super().__init__(executor, **options)

    return Watched


def test_a_small_contact_takes_little_memory() -> None:
    """The fields that it works on are as large as its window, and all cells are displaced in few."""
    heights = -np.add.outer(Grid(512, 1, 1.0).x ** 2, Grid(1, 512, 1.0).y ** 2) / 1e4
    options: dict[str, Any] = {"cell": 1.0, "modulus": 1.0, "boundary": "free", "tolerance": 1e-4}
    solve_contact(heights[:64, :64], load=10.0, **options)  # what is made once
    asked = {"load": 136.0}
    for _ in range(2):
        tracemalloc.start()
        found = solve_contact(heights, **asked, **options)
        asked = {"approach": found.approach}
        peak = tracemalloc.get_traced_memory()[1] / heights.nbytes
        tracemalloc.stop()
        assert 0.01 < found.area / found.nominal_area < 0.2
        assert peak < 7.0
