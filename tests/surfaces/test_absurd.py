"""Files that read well and mean nothing are refused or doubted."""

from pathlib import Path

import numpy as np
import pytest

from warpwear import InputError, Study, run
from warpwear.measured.surface_command import SurfaceOptions, describe
from warpwear.surfaces.measured import read_measured

RANDOM = np.random.default_rng(3)
GIVEN = {"pixel": (1e-3, 1e-3), "height_unit": "um"}


def saved(folder: Path, heights: np.ndarray) -> Path:
    np.save(folder / "disc.npy", heights)
    return folder / "disc.npy"


@pytest.mark.parametrize(("share", "reads"), [(0.3, True), (0.49, True), (0.6, False), (0.999, False)])
def test_more_than_half_missing_is_refused(tmp_path: Path, share: float, reads: bool) -> None:
    heights = RANDOM.normal(size=(60, 60))
    heights.ravel()[RANDOM.permutation(3600)[: round(share * 3600)]] = np.nan
    path = saved(tmp_path, heights)
    if reads:
        assert np.isfinite(read_measured(path, **GIVEN).levelled).all()
    else:
        with pytest.raises(InputError, match=r"% of its points missing: allowed are at most 50 %"):
            read_measured(path, **GIVEN)


def test_heights_that_no_instrument_gives(tmp_path: Path) -> None:
    heights = RANDOM.normal(size=(20, 20))
    heights[3, 3] = 1e308
    with pytest.raises(InputError, match=r"has heights beyond 10000 mm"):
        read_measured(saved(tmp_path, heights), **GIVEN)


def test_micrometres_called_millimetres_are_doubted(tmp_path: Path) -> None:
    path = saved(tmp_path, RANDOM.normal(size=(40, 40)))
    x = np.linspace(-5.0, 5.0, 21)
    fine = read_measured(path, **GIVEN)
    assert not [t for t in fine.notices(1e-3 * x, 1e-3 * x) if "right?" in t]
    path = saved(tmp_path, 0.2 * RANDOM.normal(size=(40, 40)))
    doubted = read_measured(path, pixel=(0.5, 0.5), height_unit="mm")
    assert any("is the file's unit, mm, right?" in t for t in doubted.notices(x, x))


def test_a_result_is_no_measurement(tmp_path: Path) -> None:
    pytest.importorskip("SurfaceTopography")
    study = Study.load("v3-fine").replace({"grid.cell": "20 um", "sliding.distance": "0 mm"})
    run(study, out=tmp_path / "run", plots=False).close()
    with pytest.raises(InputError, match=r"is a result of warpwear; 'warpwear export'"):
        read_measured(tmp_path / "run" / "result.h5", **GIVEN)


def test_a_flat_has_a_page_and_a_figure(tmp_path: Path) -> None:
    path = saved(tmp_path, np.zeros((40, 40)))
    figure = tmp_path / "flat.png"
    given = {"pixel": "1 um", "height_unit": "um"}
    page = describe(path, SurfaceOptions(figure=figure, preparation=given))
    assert "Sq 0" in page
    assert figure.is_file()
