"""Measured files from Python: numbers or texts with units, sentences that name Python's options, tables."""

from pathlib import Path

import numpy as np
import pytest

import warpwear
from warpwear.study.units import parse

GIVEN = {"pixel": "3 um", "height_unit": "um"}


@pytest.fixture
def rough(tmp_path: Path) -> Path:
    """A file of a rough surface with a hollow in its middle."""
    points = np.linspace(-1.0, 1.0, 150)
    bowl = np.maximum(0.0, 1.0 - np.add.outer(points**2, points**2) / 0.1)
    heights = np.random.default_rng(1).normal(0.0, 0.1, (150, 150))
    np.save(tmp_path / "rough.npy", heights - 3.0 * bowl)
    return tmp_path / "rough.npy"


def test_a_number_is_in_mm_and_a_text_has_its_unit(rough: Path) -> None:
    text = warpwear.read_surface(rough, **GIVEN, s_filter="12 um", crop="0.3 mm, 0.24 mm", level="2")
    number = warpwear.read_surface(
        rough, pixel=(0.003, 0.003), height_unit="um", s_filter=0.012, crop=(0.3, (240, "um")), level=2
    )
    assert repr(text) == repr(number)
    assert np.array_equal(text.heights, number.heights)
    assert text.heights.shape == (100, 80)
    assert not text.missing.any()
    wide = warpwear.read_surface(rough, extend="mirror", **GIVEN).surface  # as `run(surface=...)` takes it
    assert np.isfinite(wide.heights(np.linspace(-0.3, 0.3, 5), np.linspace(0.0, 0.1, 2))).all()
    track = [warpwear.read_worn(rough, "track", track_width=w, **GIVEN) for w in (0.2, "200 um")]
    assert track[0].numbers == track[1].numbers


def test_numbers_are_a_row_of_a_table(rough: Path) -> None:
    pytest.importorskip("pandas")
    scar = warpwear.read_worn(rough, "scar", **GIVEN)
    frame = scar.to_dataframe()
    assert frame.shape[0] == 1
    assert frame["scar.volume_mm3"][0] == scar.numbers["scar"]["volume_mm3"] == scar.body.volume
    volume = 0.5 * np.pi * 0.1 * (0.5 * 149 * 0.003) ** 2 * 0.003
    assert scar.body.volume == pytest.approx(volume, rel=0.05)  # of a paraboloid: half of its cylinder


def test_figures_are_written_once(rough: Path, tmp_path: Path) -> None:
    surface = warpwear.read_surface(rough, **GIVEN)
    assert surface.save_figure(tmp_path / "a.svg").stat().st_size > 1000
    with pytest.raises(warpwear.InputError, match=r"a.svg is there already"):
        surface.save_figure(tmp_path / "a.svg")
    with pytest.raises(warpwear.InputError, match="no figure"):
        warpwear.worn_cap(0.8, 0.8, radius=3.0).figure()


def test_sentences_name_options_as_python_does(rough: Path, tmp_path: Path) -> None:
    for refused, sentence in (
        (lambda: warpwear.read_surface(rough), "height_unit is not given and the file"),
        (lambda: warpwear.read_surface(rough, **GIVEN, s_filter="8"), "s_filter = '8': needs its unit"),
        (lambda: warpwear.read_surface(rough, **GIVEN, lambda_c="1 N"), "lambda_c = '1 N': has the wrong"),
        (
            lambda: warpwear.read_worn(rough, "ball", before=rough, **GIVEN),
            "before and ball exclude each other",
        ),
        (lambda: warpwear.read_worn(rough, "scar", line="y, 0.1 mm", **GIVEN), "line and scar exclude"),
        (lambda: warpwear.read_worn(rough, "scar", track_width=1.0, **GIVEN), "track_width needs track"),
        (lambda: warpwear.read_worn(rough, "hole", **GIVEN), "kind = 'hole': allowed is track, scar, ball"),
        (lambda: warpwear.read_profile(rough, height_sign="dwn"), "height_sign = 'dwn' is not allowed"),
        (lambda: warpwear.compare(tmp_path, before=rough), "before needs scar"),
        (lambda: warpwear.compare(tmp_path), "compare needs two runs or more"),
        (lambda: warpwear.new_study(like="skate"), "like is 'skate': allowed is reciprocating"),
        (lambda: warpwear.new_study(rough.with_suffix(".txt")), "a study is a file named .toml"),
    ):
        with pytest.raises(warpwear.InputError) as error:
            refused()
        assert sentence in str(error.value)
        assert "--" not in str(error.value)
    for tests, more, sentence in (
        ([{"diameter": "1 mm"}], {}, "'test.1.diameter' is no key of a test; did you mean 'scar'?"),
        ([{"scra": "1 mm"}], {}, "'test.1.scra' is no key of a test; did you mean 'scar'?"),
        (
            [{"scar": "1 mm"}],
            {"source": "diameter"},
            "source = 'diameter' is not allowed; allowed: volume",
        ),
        ([0.018], {}, "tests[0] = 0.018 must be a mapping such as {'volume': '0.018 mm^3'}; in a file"),
    ):
        with pytest.raises(warpwear.InputError) as error:
            warpwear.calibrate_wear(tests, load="8 N", distance="1 m", **more)  # type: ignore[arg-type]
        assert str(error.value).startswith(sentence)
    with pytest.raises(TypeError, match="'filter' is no option; allowed: pixel, height_unit"):
        warpwear.read_surface(rough, filter=3)  # type: ignore[call-arg]


def test_a_draft_without_a_file_is_the_study_of_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    study = warpwear.new_study(like="pin", changes={"contact.load": "3 N"})
    assert list(tmp_path.iterdir()) == []
    assert warpwear.new_study("pin.toml", like="pin", changes={"contact.load": "3 N"}) == study
    assert study.contact.load == parse("3 N", "N")


def test_a_record_in_memory_is_told_how_to_be_compared(tmp_path: Path) -> None:
    file = tmp_path / "course.csv"
    rows = [f"{0.1 * n},{0.5 + 0.01 * (n % 7)}" for n in range(400)]
    file.write_text("\n".join(["Distance [mm],CoF", *rows]), encoding="utf-8")
    record = warpwear.read_record(file)
    with pytest.raises(
        warpwear.InputError, match=r"takes it in experiments; .* write it, and give its record\.csv"
    ):
        warpwear.compare(record, record)
    with pytest.raises(warpwear.InputError, match=r"course\.csv is given 2 times"):
        warpwear.compare(experiments=[record] * 2)
