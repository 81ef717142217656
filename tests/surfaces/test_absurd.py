"""Files that read well and mean nothing are refused or doubted; what a study says against it is told."""

from pathlib import Path

import numpy as np
import pytest

from warpwear import InputError, Study, run
from warpwear.cli.surface import describe
from warpwear.surfaces.measured import read_measured

X = np.linspace(-0.01, 0.01, 5)
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
    # levelling leaves rounding of a tilt
    path = saved(tmp_path, 3.0 + np.add.outer(0.001 * np.arange(40), 0.02 * np.arange(40)))
    figure = tmp_path / "flat.png"
    given = {"pixel": "1 um", "height_unit": "um"}
    page = describe(path, given, figure=figure)
    assert "roughness        none: the surface is flat" in page
    assert "no Ra" in page
    assert figure.is_file()


def text_file(path: Path) -> Path:
    x, y = np.meshgrid(np.arange(40) * 1.0, np.arange(30) * 1.0, indexing="ij")
    z = 0.1 * np.sin(x / 5.0) + 0.05 * np.cos(y / 3.0)
    table = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    np.savetxt(path, table, header="x [um]\ty [um]\tz [um]", delimiter="\t")
    return path


def test_an_override_is_told_with_both_values(tmp_path: Path) -> None:
    path = text_file(tmp_path / "disc.xyz")
    told = read_measured(path, pixel=(2e-3, 2e-3), height_unit="nm").notices(X, X)
    assert any("disc.height_unit = nm overrides the unit that the file states, µm" in t for t in told)
    assert any("disc.pixel = 2 × 2 µm overrides the pixel that the file states, 1 × 1 µm" in t for t in told)


def test_the_same_value_is_no_override(tmp_path: Path) -> None:
    path = text_file(tmp_path / "disc.xyz")
    for surface in (read_measured(path), read_measured(path, pixel=(1e-3, 1e-3), height_unit="µm")):
        assert not [t for t in surface.notices(X, X) if "overrides" in t]


@pytest.mark.parametrize(("extend", "expected"), [("mirror", "mirrored: 2.5 × 3.3 copies"), ("refuse", None)])
def test_copies_are_counted(tmp_path: Path, extend: str, expected: str | None) -> None:
    surface = read_measured(text_file(tmp_path / "disc.xyz"), extend=extend)
    wide = np.linspace(-0.05, 0.05, 101)
    told = [t for t in surface.notices(wide, wide) if "copies" in t]
    assert told == [] if expected is None else expected in told[0]
