"""The package as NumPy users hold it: heights as arrays in."""

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_front_door import same, study_of

import warpwear
from warpwear import InputError, Result, Study
from warpwear.runs.step import RunStep
from warpwear.study.surface import surface_in


def rough(shape: tuple[int, int], *, seed: int = 1) -> np.ndarray[Any, Any]:
    """Heights [mm] of a smooth random field, 1 µm rms, with a mean of 5 µm that says nothing."""
    spectrum = np.fft.rfft2(np.random.default_rng(seed).normal(size=shape))
    waves = np.hypot(*np.meshgrid(np.fft.fftfreq(shape[0]), np.fft.rfftfreq(shape[1]), indexing="ij"))
    heights = np.fft.irfft2(spectrum * np.exp(-((waves / 0.05) ** 2)), s=shape)
    return heights / heights.std() * 1.0e-3 + 5.0e-3


def test_an_array_of_the_studys_own_surface_gives_its_contact(device: str, threads: int) -> None:
    study = study_of()
    heights = surface_in(study).heights(study.cells.x, study.cells.y)
    named = warpwear.run(study, device=device, threads=threads)
    given = warpwear.run(study, surface=heights, device=device, threads=threads)
    for name in ("area_contact", "wear_depth_disc", "pressure_std", "cof"):
        np.testing.assert_allclose(given.history[name], named.history[name], rtol=1e-9)
    # Heights count from their mean, so approaches do.
    shift = named.history["approach"] - given.history["approach"]
    np.testing.assert_allclose(shift, -heights.mean(), atol=1e-12)


def test_where_an_array_stands_says_nothing() -> None:
    heights = rough((75, 75))
    one, other = (warpwear.run(study_of(), surface=heights + offset) for offset in (0.0, 0.125))
    np.testing.assert_allclose(other.history["approach"], one.history["approach"], atol=1e-15)
    np.testing.assert_allclose(other.snapshot(-1).wear_disc, one.snapshot(-1).wear_disc, atol=1e-15)


@pytest.mark.parametrize("preset", ["v3-fine", "two-scale", "track"])
def test_the_folder_of_an_array_runs_again_by_itself(preset: str, tmp_path: Path) -> None:
    changes = {"grid__cell": "10 um"} if preset == "two-scale" else {}
    study = study_of(preset, **changes)
    heights = rough((study.track.rows if study.is_swept else study.cells.nx, study.cells.ny))
    out = tmp_path / "out"
    kept = warpwear.run(study, surface=heights, out=out, plots=False)
    same(kept, warpwear.run(study, surface=heights))
    np.testing.assert_array_equal(np.load(out / "surface.npy"), heights)
    same(kept, warpwear.run(Study.load(out)))
    same(kept, warpwear.run(kept.study))
    assert Study.load(out) == kept.study
    kept.close()
    moved = tmp_path / "elsewhere"
    shutil.move(out, moved)
    with Result.open(moved) as result:
        assert result.study.disc.surface == str((moved / "surface.npy").resolve())
        assert Study.load(moved) == result.study
        same(result, warpwear.run(Study.load(moved)))


def test_what_the_disc_was_before_is_gone(tmp_path: Path) -> None:
    np.save(tmp_path / "disc.npy", np.zeros((40, 40)))
    measured = study_of().replace(
        {
            "disc.surface": str(tmp_path / "disc.npy"),
            "disc.pixel": "50 um",
            "disc.height_unit": "um",
            "disc.height_sign": "down",
            "disc.sliding_axis": "y",
            "disc.crop": ["1 mm", "1 mm"],
            "disc.extend": "mirror",
            "disc.s_filter": "100 um",
            "disc.level": 4,
        }
    )
    heights = rough((75, 75))
    same(warpwear.run(measured, surface=heights), warpwear.run(study_of(), surface=heights))
    with warpwear.run(measured, surface=heights, out=tmp_path / "out", plots=False) as kept:
        same(kept, warpwear.run(kept.study))
        assert kept.study.disc.young == measured.disc.young


def test_anything_with_heights_is_a_surface() -> None:
    class Waves:
        def heights(self, x: np.ndarray[Any, Any], y: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
            return 1.0e-3 * np.cos(20.0 * x)[:, None] * np.cos(30.0 * y)[None, :]

        def notices(self, x: np.ndarray[Any, Any], y: np.ndarray[Any, Any]) -> list[str]:
            return []

        def record(self) -> dict[str, Any]:
            return {"kind": "waves"}

    study = study_of()
    heights = Waves().heights(study.cells.x, study.cells.y)
    same(warpwear.run(study, surface=Waves()), warpwear.run(study, surface=heights))
    same(warpwear.run(study, surface=heights.tolist()), warpwear.run(study, surface=heights))


def test_a_run_on_an_array_is_resumed_with_it_alone(tmp_path: Path) -> None:
    study, heights, out = study_of(), rough((75, 75)), tmp_path / "out"
    whole = warpwear.run(study, surface=heights)

    def stop(step: RunStep) -> None:
        if step.index == 20:
            raise TimeoutError("enough")

    with pytest.raises(TimeoutError):
        warpwear.run(study, surface=heights, out=out, plots=False, callback=stop)
    with pytest.raises(InputError, match=r"cannot go on: the disc's heights are not what they were"):
        warpwear.run(study, surface=heights + rough((75, 75), seed=2), out=out, plots=False, resume=True)
    with pytest.raises(InputError, match=r"is of another study .*disc"):
        warpwear.run(study, out=out, plots=False, resume=True)
    with warpwear.run(study, surface=heights, out=out, plots=False, resume=True) as resumed:
        same(resumed, whole)
    with pytest.raises(InputError, match="holds a run on another surface"):
        warpwear.run(study, surface=2.0 * heights, out=out, plots=False, resume=True)
    with warpwear.run(Study.load(out), out=out, plots=False, resume=True) as finished:
        same(finished, whole)


@pytest.mark.parametrize(
    ("preset", "surface", "message"),
    [
        ("v3-fine", np.zeros((75, 74)), r"the shape \(75, 74\); an array of the shape \(75, 75\) .*20 µm"),
        ("v3-fine", np.zeros(75), r"surface of shape \(75,\) are not possible"),
        ("track", np.zeros((75, 75)), r"surface has the shape \(75, 75\).*of the track"),
        ("v3-fine", np.full((75, 75), np.nan), r"surface\[0, 0\] = nan is not possible \(5625 of 5625"),
        ("v3-fine", "disc.sur", r"surface is a str; .*belongs in disc\.surface"),
        ("v3-fine", rough((75, 75)) * 1e5, r"disc\.height_unit|unit"),
        ("v1", np.zeros((150, 150)), r"does not apply to study\.model = 'macro'"),
    ],
)
def test_what_is_no_surface_is_refused(preset: str, surface: Any, message: str, tmp_path: Path) -> None:
    study = Study.load("v1") if preset == "v1" else study_of(preset)
    with pytest.raises(InputError, match=message):
        warpwear.run(study, surface=surface, out=tmp_path / "out")
    with pytest.raises(InputError, match=message):
        next(iter(warpwear.steps(study, surface=surface)))
    assert not (tmp_path / "out").exists()


def disc_elsewhere(folder: Path) -> Study:
    """A study of the user's own file, which has the name of the one that runs save."""
    folder.mkdir()
    np.save(folder / "surface.npy", rough((75, 75), seed=7))
    keys = {"surface": str(folder / "surface.npy"), "pixel": "20 um", "height_unit": "mm"}
    return study_of().replace({f"disc.{key}": value for key, value in keys.items()})


def test_heights_of_a_run_that_is_replaced_are_gone(tmp_path: Path) -> None:
    out, other = tmp_path / "out", disc_elsewhere(tmp_path / "elsewhere")
    warpwear.run(study_of(), surface=rough((75, 75)), out=out, plots=False).close()
    with warpwear.run(other, out=out, plots=False, overwrite=True) as replaced:
        assert not (out / "surface.npy").exists()
        assert replaced.study.disc.surface == other.disc.surface
    np.save(out / "surface.npy", rough((75, 75)))  # by hand: another's file of that name misleads nobody
    with Result.open(out) as opened:
        assert opened.study == Study.load(out) == other
    with warpwear.run(other, out=out, plots=False, overwrite=True) as again:
        assert (out / "surface.npy").is_file()
        assert again.study == other


def test_a_folder_is_run_again_in_place_on_its_own_heights(tmp_path: Path) -> None:
    out, heights = tmp_path / "out", rough((75, 75))
    first = warpwear.run(study_of(), surface=heights, out=out, plots=False)
    with warpwear.run(out, out=out, plots=False, overwrite=True) as second:
        same(first, second)
    shutil.move(out, tmp_path / "moved")
    with Result.open(tmp_path / "moved") as moved:
        assert Study.load(tmp_path / "moved") == moved.study
        same(moved, warpwear.run(moved.study))
    first.close()


@pytest.mark.parametrize(
    "surface", [np.ma.masked_less(rough((75, 75)), 5.0e-3), rough((75, 75)) + 0j, [[1j] * 75] * 75]
)
def test_masked_and_complex_heights_are_refused(surface: Any) -> None:
    with pytest.raises(InputError, match=r"^surface of type .* must be real numbers, none of them masked\.$"):
        warpwear.run(study_of(), surface=surface)


def test_an_attribute_called_heights_is_no_surface() -> None:
    class Record:
        heights = 3

    with pytest.raises(InputError, match="surface is a Record; an array of heights in mm is expected"):
        warpwear.run(study_of(), surface=Record())


def test_what_a_surface_raises_is_raised() -> None:
    class Broken:
        def heights(self, x: Any, y: Any) -> Any:
            raise ZeroDivisionError("mine")

    with pytest.raises(ZeroDivisionError, match="mine"):
        warpwear.run(study_of(), surface=Broken())
