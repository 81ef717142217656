"""What is refused of a result file, and what is not."""

from pathlib import Path

import warpwear
from warpwear import Study


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
