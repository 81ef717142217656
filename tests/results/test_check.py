"""What is refused of a result file, and what is not."""

import math
from pathlib import Path

import h5py
import pytest

import warpwear
from warpwear import InputError, Study
from warpwear.results.seal import HEADER


def test_result_of_a_small_contact_on_a_large_grid_is_whole(tmp_path: Path) -> None:
    """Its pressures are zero but for a few cells, and blocks of zeros take no room."""
    changes = {
        "grid.cell": "5 um",
        "grid.extent": "2 mm",
        "contact.load": "0.5 N",
        "sliding.distance": "6 um",
    }
    study = Study.load("v3-fine").replace({**changes, "output.snapshots": []})
    warpwear.run(study, out=tmp_path / "run", plots=False).close()
    with warpwear.Result.open(tmp_path / "run") as result:
        assert abs(result.snapshot(-1).pressure.sum() * 25.0e-6 - 0.5) < 1e-9


@pytest.mark.parametrize("value", [0.0, math.nan])
@pytest.mark.parametrize("name", ["grid/x", "grid/y", "history/load", "history/patch_across", "history/cof"])
def test_places_and_columns_that_no_run_has_are_a_sentence(name: str, value: float, tmp_path: Path) -> None:
    """Whoever made such a file took its seal off, so that only what it holds tells."""
    short = {"grid.cell": "20 um", "sliding.distance": "6 um", "output.snapshots": []}
    short |= {"friction.law": "shear-strength", "friction.shear_strength": "400 MPa"}
    warpwear.run(Study.load("v3-fine").replace(short), out=tmp_path / "run", plots=False).close()
    path = tmp_path / "run" / "result.h5"
    with h5py.File(path, "r+") as file:
        file[name][...] = value
    with path.open("r+b") as raw:
        raw.write(bytes(HEADER))
    if name == "history/cof" and math.isnan(value):  # is not known
        warpwear.Result.open(tmp_path / "run").close()
        return
    with pytest.raises(InputError, match=f"its {name} "):
        warpwear.Result.open(tmp_path / "run")
