"""What is changed in one place is changed for every pass: the law of a cell, and the sums of a step."""

import subprocess
import sys
from enum import IntEnum

import pytest

from warpwear.kernels import native_code
from warpwear.kernels.cells import TABLES, PressureSum, TrackSum, WearSum

#: Cells stiffen with their overlap u [mm], p = u / c (1 + 100 u / mm), and only law.h says so. Bodies wear at
#: rest, on a track and in patches; each run checks its loads and volumes, and one its last pressures.
STIFFENING = """
import numpy as np
from warpwear.kernels import native_code

read, law = native_code._text, native_code._text("law.h")
for straight, bent in (
    ("return overlap", "return (1.0 + 100.0 * clipped(overlap, Real(1.0))) * overlap"),
    ("slope_on_spring(Real, Real)", "slope_on_spring(Real overlap, Real)"),
    ("return 1.0;", "return 1.0 + 200.0 * overlap;"),
    ("IS_STRAIGHT = true", "IS_STRAIGHT = false"),
):
    assert straight in law
    law = law.replace(straight, bent)
native_code._text = lambda name: law if name == "law.h" else read(name)

import warpwear

for name in ("v3-fine", "track", "two-scale"):
    study = warpwear.Study.load(name).replace({"grid.cell": "10 um", "sliding.distance": "6 mm"})
    one, two = (warpwear.run(study, threads=threads) for threads in (1, 2))
    np.testing.assert_array_equal(one.history["area_contact"], two.history["area_contact"])
    if name == "v3-fine":
        last = one.snapshots[-1]
        c = 1e-3 * (study.wear.counter.value + study.wear.disc.value) * one.history["increment"][-1]
        u = one.history["approach"][-1] - (last.gap - c * last.pressure)
        expected = np.clip(u / c * (1.0 + 100.0 * u), 0.0, study.contact.hardness)
        np.testing.assert_allclose(last.pressure, np.where(u > 0.0, expected, 0.0), rtol=1e-6)
"""


@pytest.mark.parametrize("table", [WearSum, TrackSum, PressureSum])
def test_every_sum_of_a_step_is_made(table: type[IntEnum]) -> None:
    """One that is named and never made would be 0; one that is made without a name does not compile."""
    text = "".join(path.read_text(encoding="utf-8") for path in native_code.FOLDER.rglob("*.h"))
    assert [line.name for line in table if f"{table.__name__}::{line.name}) +=" not in text] == []


@pytest.mark.parametrize("table", TABLES)
def test_lines_are_numbered_in_their_order(table: type[IntEnum]) -> None:
    """Those of C++ are."""
    assert [*table] == [*range(len(table))]


@pytest.mark.slow
def test_a_law_that_bends_is_written_in_one_header() -> None:
    """Passes that search, that wear, and that foresee the next step go by it, and so does what is left."""
    command = [sys.executable, "-W", "ignore", "-c", STIFFENING]
    process = subprocess.run(command, capture_output=True, text=True, timeout=600)
    assert process.returncode == 0, process.stderr[-2000:]
