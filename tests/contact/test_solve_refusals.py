"""warpwear.solve_contact: every misuse is a sentence, and what did not converge an error."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from cases_solve import GRID, HEIGHTS

from warpwear import solve_contact
from warpwear.contact.array import memory
from warpwear.contact.array import solve as solve_module
from warpwear.contact.half_space.search import Search
from warpwear.errors import ConvergenceError, InputError
from warpwear.kernels.half_space.solve import LED_NOWHERE

NAN = HEIGHTS.copy()
NAN[3, 5] = math.nan
MISUSES: dict[str, tuple[Any, dict[str, Any], str]] = {
    "nan": (NAN, {}, r"heights\[3, 5\] = nan is not possible \(1 of 3072 are not finite\)"),
    "masked": (
        np.ma.masked_greater(HEIGHTS, 1.0),
        {},
        r"heights of type MaskedArray are not possible \(masked or complex\)",
    ),
    "complex": (HEIGHTS * 1j, {}, r"heights of type ndarray are not possible \(masked or complex\)"),
    "text": ("rough", {}, "heights of type str"),
    "ragged": ([[1.0, 2.0], [3.0]], {}, "heights of type list"),
    "a line": (HEIGHTS[0], {}, r"heights of shape \(48,\) are not possible"),
    "a stack": (HEIGHTS[np.newaxis], {}, r"heights of shape \(1, 64, 48\)"),
    "no cell at all": (HEIGHTS[:0], {}, r"heights of shape \(0, 48\)"),
    "zero cell": (HEIGHTS, {"cell": 0.0}, "cell = 0 is not possible; it must be a positive, finite number"),
    "two cells": (HEIGHTS, {"cell": (1.0, 2.0)}, r"cell = \(1.0, 2.0\) is not possible"),
    "units": (HEIGHTS, {"load": "8 N"}, "load = '8 N' is not possible"),
    "an array": (HEIGHTS, {"load": np.ones(2)}, r"load = array\(\[1., 1.\]\) is not possible"),
    "negative load": (HEIGHTS, {"load": -1.0}, "load = -1 is not possible; it must be a positive"),
    "no load": (HEIGHTS, {"load": None}, "nothing is given; exactly one of load, mean_pressure and approach"),
    "two loads": (
        HEIGHTS,
        {"mean_pressure": 2.0},
        "load = 1 and mean_pressure = 2 are given; exactly one of load, mean_pressure and approach must be",
    ),
    "load and approach": (HEIGHTS, {"approach": 2.0}, "load = 1 and approach = 2 are given"),
    "approach without end": (HEIGHTS, {"load": None, "approach": math.inf}, "approach = inf is not possible"),
    "two laws": (
        HEIGHTS,
        {"stiffness": 2.0},
        "modulus = 1 and stiffness = 2 are given; at most one of modulus and stiffness may be",
    ),
    "no law": (HEIGHTS, {"modulus": None}, "hardness = None is not possible without modulus or stiffness"),
    "modulus": (HEIGHTS, {"modulus": 0}, "modulus = 0 is not possible"),
    "stiffness": (HEIGHTS, {"modulus": None, "stiffness": -3.0}, "stiffness = -3 is not possible"),
    "hardness": (HEIGHTS, {"hardness": math.nan}, "hardness = nan is not possible"),
    "true": (HEIGHTS, {"hardness": True}, "hardness = True is not possible"),
    "tolerance": (HEIGHTS, {"tolerance": 0.0}, "tolerance = 0 is not possible"),
    "boundary": (HEIGHTS, {"boundary": "mirror"}, "boundary = 'mirror' is unknown; allowed are"),
    "boundary of springs": (
        HEIGHTS,
        {"modulus": None, "stiffness": 1.0, "boundary": "free"},
        "boundary = 'free' is only for a half-space",
    ),
    "boundary of the bearing area": (
        HEIGHTS,
        {"modulus": None, "hardness": 1.0, "boundary": "periodic"},
        "boundary = 'periodic' is only for a half-space",
    ),
    "periodic counter-body": (
        HEIGHTS,
        {"counter_radius": 3.0, "boundary": "periodic"},
        'boundary = "periodic" is not possible with counter_radius = 3',
    ),
    "counter": (HEIGHTS, {"counter_radius": -3.0}, "counter_radius = -3 is not possible"),
    "no such key": (
        HEIGHTS,
        {"counter": {"radii": 3.0}},
        "counter has no 'radii'; its keys are shape, radius",
    ),
    "no such shape": (HEIGHTS, {"counter": {"shape": "cone", "radius": 1.0}}, "shape = 'cone' is unknown"),
    "half a crown": (
        HEIGHTS,
        {"counter": {"shape": "crowned", "radius_along": 3.0}},
        "counter of shape 'crowned' needs radius_across",
    ),
    "negative edge": (
        HEIGHTS,
        {"counter": {"shape": "pin", "radius": 1.0, "edge_radius": -1.0}},
        "counter edge_radius = -1 is not possible",
    ),
    "two counter-bodies": (HEIGHTS, {"counter_radius": 3.0, "counter": {"radius": 3.0}}, "give one of them"),
    "other heights": (HEIGHTS, {"counter": np.zeros((3, 3))}, r"counter of shape \(3, 3\) is not possible"),
    "tiny counter-body": (
        HEIGHTS,
        {"counter_radius": 0.01},
        "counter_radius = 0.01 is not possible; it must reach",
    ),
    "too much": (
        HEIGHTS,
        {"hardness": 0.005},
        "load = 1 is not possible; with all cells at the hardness it is 0.96",
    ),
    "too high a mean": (
        HEIGHTS,
        {"load": None, "mean_pressure": 0.6, "hardness": 0.5},
        "mean_pressure = 0.6 is not possible; with all cells at the hardness it is 0.5",
    ),
    "too much for a small counter-body": (
        HEIGHTS,
        {"load": 40.0, "hardness": 1.0, "counter_radius": 3.0},
        "load = 40 is not possible; with all cells at the hardness it is 28",
    ),
    "beyond the mean plane": (
        HEIGHTS,
        {"load": None, "approach": 0.5},
        "approach = 0.5 is not possible; a periodic half-space without a hardness",
    ),
    "device": (HEIGHTS, {"device": "tpu"}, "device = 'tpu' is not there"),
    "threads": (HEIGHTS, {"threads": 0}, "threads = 0 is not possible"),
    "half a thread": (HEIGHTS, {"threads": 1.5}, "threads = 1.5 is not possible"),
}


@pytest.mark.parametrize("case", MISUSES)
def test_misuse_is_told_in_a_sentence(case: str) -> None:
    heights, options, words = MISUSES[case]
    with pytest.raises(InputError, match=words) as refused:
        solve_contact(heights, **{"cell": GRID.cell, "load": 1.0, "modulus": 1.0, **options})
    sentence = str(refused.value)
    assert sentence.endswith(".")
    assert "\n" not in sentence
    assert "mm" not in sentence
    assert "MPa" not in sentence


def test_what_memory_cannot_hold_is_refused(host_with: Callable[[float], None]) -> None:
    host_with(1000)
    with pytest.raises(InputError, match=r"heights of shape \(64, 48\) need 0.0 GiB of memory; the host has"):
        solve_contact(HEIGHTS, cell=1.0, load=1.0, modulus=1.0)


@pytest.mark.parametrize("boundary", ["periodic", "free"])
def test_no_convergence_is_an_error_with_its_residual(boundary: str, monkeypatch: pytest.MonkeyPatch) -> None:
    run = Search.run
    monkeypatch.setattr(Search, "run", lambda *how: run(*how) and LED_NOWHERE)
    with pytest.raises(ConvergenceError, match=r"solve_contact failed: .* of the rms height"):
        solve_contact(HEIGHTS, cell=GRID.cell, load=1.0, modulus=1.0, boundary=boundary)


def test_a_load_that_is_missed_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(solve_module, "LOAD_TOLERANCE", -1.0)
    with pytest.raises(ConvergenceError, match=r"found a mean pressure of 0\.5 instead of 0\.5"):
        solve_contact(HEIGHTS, cell=GRID.cell, mean_pressure=0.5, stiffness=1.0)


def test_a_contact_at_the_edge_is_told() -> None:
    """Beyond the array there is nothing to carry: the area would be cut off without a word."""
    radius, modulus, load = 3.0, 1.0e5, 8.0
    a = (0.75 * load * radius / modulus) ** (1.0 / 3.0)
    with pytest.warns(UserWarning, match=r"the edge of heights, of the shape \(16, 16\)"):
        solve_contact(np.zeros((16, 16)), cell=a / 20, load=load, modulus=modulus, counter_radius=radius)


def test_a_large_contact_says_what_memory_it_needs(
    host_with: Callable[[float], None], capsys: pytest.CaptureFixture[str]
) -> None:
    host_with(100 * 2**30)
    memory.check_memory((1024, 1024), "cpu", "periodic")
    assert not capsys.readouterr().err
    memory.check_memory((8192, 8192), "cpu", "periodic")
    assert (
        "heights of shape (8192, 8192) need up to 5.5 GiB of the host (100.0 GiB free)"
        in capsys.readouterr().err
    )
    with pytest.raises(InputError, match=r"112\.0 GiB of memory; the host has 100\.0 GiB free"):
        memory.check_memory((32768, 32768), "cpu", "free")
