"""What a person writes is not misread, and what plays no part, or another than expected, says so."""

import math
import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fuzzing import watched

import warpwear
from warpwear import InputError, Study, StudyWarning
from warpwear.clock import lasting
from warpwear.runs import console
from warpwear.study.surface import surface_in

SMALL = {"grid.cell": "10 um", "sliding.distance": "30 mm", "output.snapshots": []}


def test_a_rotation_is_counted_in_turns() -> None:
    """30 minutes at 60 rpm are 1800 laps, whose frequency makes the time axis."""
    turning = Study.load("track").replace(
        {"sliding.track_radius": "5 mm", "sliding.duration": "30 min", "sliding.frequency": "60 rpm"}
    )
    still = turning.replace({"sliding.speed": None})
    assert still.sliding.total == pytest.approx(1800.0 * 2.0 * math.pi * 5.0)
    assert still.sliding.mean_speed == pytest.approx(2.0 * math.pi * 5.0)
    assert not [notice for notice in still.notices() if "speed" in notice]
    assert any("sliding.speed = 20 mm/min makes the time axis" in notice for notice in turning.notices())
    counted = still.replace({"sliding.revolutions": 100, "sliding.kinematics": "stationary"})
    assert counted.sliding.total == pytest.approx(100.0 * 2.0 * math.pi * 5.0)
    assert counted.sliding.mean_speed == pytest.approx(2.0 * math.pi * 5.0)
    to_and_fro = Study.load("v3").replace({"sliding.frequency": "2 Hz", "sliding.speed": None})
    assert to_and_fro.sliding.mean_speed == pytest.approx(2.0 * 2.0 * 30.0)


def test_a_hardness_that_plays_no_part_says_so() -> None:
    study = Study.load("v3-fine")
    assert not [notice for notice in study.notices() if "hardness" in notice]
    beside = study.replace({"disc.hardness": "2 GPa"})
    assert beside.hardness == study.hardness
    (told,) = [notice for notice in beside.notices() if "hardness" in notice]
    assert told.startswith(
        "contact.hardness = 590 MPa is the largest pressure of a cell: disc.hardness = 2000 MPa"
    )
    again = Study(
        **tomllib.loads(study.to_toml())
    )  # where those of the materials stand as keys, and as assumed
    assert not [notice for notice in again.notices() if "hardness" in notice]


def test_a_coefficient_without_a_unit_says_whose_hardness_it_takes() -> None:
    bare = Study.load("v3-fine").replace({"wear.counter": 1e-4})
    assert bare.notices() == [
        "wear.counter = 0.0001 without a unit: k of V = k F L / H, for both bodies with contact.hardness = "
        "590 MPa. A K has one, such as '1e-4 mm^3/N/m'."
    ]
    nested = bare.replace({"wear.disc": 2e-4, "counter.hardness": "3 GPa"}).model_dump(exclude_unset=True)
    del nested["contact"]["hardness"]
    softer = Study(**nested)
    assert softer.wear_coefficients == pytest.approx((1e-4 / 1520.0, 2e-4 / 1520.0))
    assert any(
        "wear.counter = 0.0001 and wear.disc = 0.0002 without a unit: k" in n and "1520 MPa" in n
        for n in softer.notices()
    )
    assert Study.load("v3-fine").replace({"wear.counter": 0}).notices() == []


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[friction]\ncoefficient = 0,55", r"is not TOML: .*line 2, .*: 0,55 is written 0\.55\.$"),
        ("[contact]\nload = 8 N # x", r"is not TOML: .*: 8 N is written \"8 N\", in quotes\.$"),
        ("[contact]\nload = 8,5 N", r"is not TOML: .*: 8,5 N is written \"8\.5 N\", in quotes\.$"),
        ("[contact]\nload = 5 5", r"is not TOML: [^:]*\.$"),
        ("a." * 50_000 + "a = 1", r"is not TOML: line 1 has a key of more than 32 parts\.$"),
        ("[x]\n" + "'a b' . " * 50_000 + "a = 1", r"line 2 has a key of more than 32 parts"),
        ("x = {" + "a." * 50_000 + "a = 1}", r"line 1 has a key of more than 32 parts"),
        ("x" * 2_000_000, r"is not TOML: it is longer than 1,000,000 characters\.$"),
        ('"' * 900_000, r"is not TOML"),
        ("a " * 450_000 + ".", r"is not TOML"),
    ],
    ids=[
        "decimal comma",
        "no quotes",
        "both",
        "neither",
        "dots",
        "quoted",
        "inline",
        "long",
        "quotes",
        "spaces",
    ],
)
def test_toml_that_is_none_is_told_soon(text: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_text(text, encoding="utf-8")
    with watched(), pytest.raises(InputError, match=message):
        Study.load(path)


def test_a_track_too_long_for_a_measured_disc_names_the_track(tmp_path: Path) -> None:
    np.save(tmp_path / "disc.npy", np.random.default_rng(0).normal(scale=1e-3, size=(400, 400)))
    study = Study.load("track").replace(
        {
            "disc.surface": str(tmp_path / "disc.npy"),
            "disc.pixel": "5 um",
            "disc.height_unit": "mm",
            "sliding.track": "full",
        }
    )
    turning = study.replace({"sliding.track_radius": "5 mm"})
    found = r"^sliding\.track = full.* needs 31\.\d+ mm .*disc\.surface has 2 mm .*track = '2 mm' or less"
    for asked in (study, turning):
        with pytest.raises(InputError, match=found):
            surface_in(asked)
    surface_in(study.replace({"sliding.track": "2 mm"}))
    surface_in(study.replace({"disc.extend": "mirror"}))


def test_snapshots_come_of_themselves_and_change_no_step() -> None:
    """About four, log-spaced, where none are asked for; an empty list is the end alone."""
    sections = Study.load("v3-fine").replace(SMALL).model_dump(exclude_unset=True)
    del sections["output"]
    study = Study(**sections)
    assert study.output.snapshots == "auto"
    assert 'snapshots = "auto"' in study.to_toml()
    alone = study.replace({"output.snapshots": []})
    assert Study(**tomllib.loads(alone.to_toml())).output.snapshots == ()
    for changes in ({}, {"sliding.kinematics": "swept", "sliding.track": "3.2 mm"}):
        with pytest.warns(StudyWarning):
            kept, end = warpwear.run(study.replace(changes)), warpwear.run(alone.replace(changes))
        assert end.snapshot_distances.tolist() == [30.0]
        for name, column in kept.history.items():
            assert np.array_equal(column, end.history[name], equal_nan=True)
        distance = kept.history["distance"]
        asked = [distance[np.searchsorted(distance, part)] for part in (0.03, 0.3, 3.0, 30.0)]
        assert kept.snapshot_distances.tolist() == sorted(set(asked))
        assert kept.at("3 mm").distance == pytest.approx(3.0, rel=0.3)
    assert len(warpwear.run(study.replace({"sliding.distance": "0 mm"})).snapshots) == 1


def test_too_few_cells_are_a_warning_with_the_size_that_would_do(capsys: pytest.CaptureFixture[str]) -> None:
    coarse = {"grid.cell": "0.1 mm", "grid.extent": "2 mm"}
    study = Study.load("v3-fine").replace(SMALL | coarse | {"sliding.distance": "0.3 mm"})
    result = warpwear.run(study, progress=True)
    told = [line for line in capsys.readouterr().err.splitlines() if "in contact, so" in line]
    assert len(told) == 1
    found = re.fullmatch(
        r"warning: To begin with only (\d) cells? (?:is|are) in contact, so .* mean nothing: "
        r"grid\.cell = 100 µm is too large, (\d+) µm would do \(20 cells\)\.",
        told[0],
    )
    assert found is not None
    assert int(found[1]) == result.history["cells_in_contact"][0]
    enough = study.replace({"grid.cell": f"{found[2]} um", "grid.extent": f"{48 * int(found[2])} um"})
    assert warpwear.run(enough, progress=True).history["cells_in_contact"].min() >= 20
    assert "warning: " not in capsys.readouterr().err


def test_a_coefficient_that_is_given_is_called_an_input() -> None:
    """Every run ends there: summary and figure say so, and name the shear strength that it was fitted to."""
    study = Study.load("v3-fine").replace(SMALL)
    ends = {}
    for when in ("end", "initial"):
        result = warpwear.run(study.replace({"friction.coefficient": 0.55, "friction.calibrate": when}))
        summary = result.summary
        assert summary["cof_input"] == when
        area = result.history["area_contact"][-1 if when == "end" else 0]
        assert summary["shear_strength_MPa"] == pytest.approx(0.55 * 8.0 / area)
        text = str(result)
        assert f" at {'the end' if when == 'end' else 'first'} (given)" in text
        assert text.count("(given)") == 1
        assert ("An input" in result._repr_html_()) == (when == "end")
        title = result.plot.cof().axes[0].get_title()
        assert "calibrated to 0.55" in title
        ends[when] = summary["shear_strength_MPa"], text
    limit = 1520.0 / (3.0 * math.sqrt(3.0))  # AISI 304, the softer of the two
    assert ends["end"][0] < limit < ends["initial"][0]
    assert "MPa, more than the softer body bears" in ends["initial"][1]
    assert "softer body bears" not in ends["end"][1]
    assert "for other loads, give its shear strength instead: " in ends["end"][1]
    given = warpwear.run(study)
    assert given.summary["cof_input"] is None
    assert given.summary["shear_strength_MPa"] == 3.83
    assert " at the end: area × shear strength of 3.83 MPa (assumed) / load" in str(given)
    assert "(given)" not in str(given)
    assert "calibrated" not in given.plot.cof().axes[0].get_title()


def test_the_gap_is_gone_and_the_roughness_is_not() -> None:
    """Where they touch the disc keeps K_s/(K_s + K_d) of its heights, and the ball has their imprint."""
    study = Study.load("v3-fine").replace({"grid.cell": "10 um", "output.snapshots": []})
    result, grid = warpwear.run(study), study.cells
    end, unworn = result.snapshot(-1), surface_in(study).heights(grid.x, grid.y)
    inside = end.pressure > 0.0
    x, y = (values[inside] for values in np.meshgrid(grid.x, grid.y, indexing="ij"))
    bowl = np.stack([np.ones_like(x), x, y, x**2 + y**2], axis=1)

    def rough(heights: Any) -> Any:
        return heights[inside] - bowl @ np.linalg.lstsq(bowl, heights[inside], rcond=None)[0]

    before, after, imprint = rough(unworn), rough(unworn - end.wear_disc), rough(end.wear_counter)
    kept = study.wear_coefficients[0] / sum(study.wear_coefficients)
    assert kept == pytest.approx(0.425, abs=5e-4)
    assert np.std(after) / np.std(before) == pytest.approx(kept, rel=0.01)
    assert np.std(imprint) / np.std(before) == pytest.approx(kept, rel=0.01)
    assert np.corrcoef(after, imprint)[0, 1] > 0.995
    assert np.std(rough(end.gap)) < 1e-9
    root = Path(__file__).parents[2]
    assert "Sq in the contact is 1.57 µm of 3.68 µm" in (root / "docs/theory/limits.md").read_text(
        encoding="utf-8"
    )
    for page in ("README.md", "docs/theory/limits.md", "bench/artifact.py", "bench/thesis/page.html"):
        text = (root / page).read_text(encoding="utf-8")
        assert not re.search(r"roughness is (worn (away|off)|gone)", text, re.IGNORECASE), page


def contacts_at(progress: console.Progress, clock: list[float], counts: list[int]) -> None:
    """Start a run of 100 steps, each a contact, whose time the clock tells."""
    progress.start(100, (lambda: counts[0], lambda: (100.0 - counts[0], 100.0 - counts[0])))


def test_a_run_of_a_moment_says_nothing_between(capsys: pytest.CaptureFixture[str]) -> None:
    """Lines come every tenth of the steps, but none within two seconds of another, and none at the end."""
    clock, row = [0.0], {"distance": 1.0, "area_contact": 0.1}
    for seconds, lines in ((0.2, 0), (5.0, 2), (100.0, 10)):
        counts = [0]
        progress = console.Progress("v3", now=lambda: clock[0])
        contacts_at(progress, clock, counts)
        for _ in range(100):
            clock[0] += seconds / 100.0
            counts[0] += 1
            progress.step(row)
        assert len(capsys.readouterr().err.splitlines()) == lines


def test_the_time_left_leaves_out_compiling_and_what_the_first_contact_sets_up(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """By a clock that is told: 50 s of compiling, 7 s for the first contact, 1 s for each of the others."""
    clock, counts, row = [0.0], [0], {"distance": 1.0, "area_contact": 0.1}
    progress = console.Progress("slow", now=lambda: clock[0])
    contacts_at(progress, clock, counts)
    progress.phase("steps")
    clock[0] += 7.0
    for number in range(1, 41):
        counts[0] = number
        if number == 5:
            progress.phase("compile")
            clock[0] += 50.0
            progress.phase("steps")
        clock[0] += number > 1
        progress.step(row)
        left = "" if number <= console.FIRST else f"about {lasting(100 - number)}"
        assert progress.time_left() == left
    told = capsys.readouterr().err.splitlines()
    assert not any("left" in line for line in told[:2])
    assert sum("left" in line for line in told) >= 2


def test_steps_that_come_together_tell_no_pace_before_the_last() -> None:
    """A block of 50 steps is told row by row when it was computed whole: its first row took no 50 s."""
    clock, counts, row = [0.0], [0], {"distance": 1.0, "area_contact": 0.1}
    progress = console.Progress("blocks", now=lambda: clock[0])
    contacts_at(progress, clock, counts)
    for _ in range(2):
        clock[0] += 50.0
        for number in range(50):
            counts[0] += 1
            progress.step(row, in_flight=49 - number)
            assert progress.time_left() == ""
        counts[0] -= 0
    counts[0] = 60
    assert progress.time_left() == "about 40 s"


@pytest.mark.parametrize(("most", "told"), [(360.0, "about 3 min"), (1800.0, "1.5 min to 30 min")])
def test_a_time_within_more_than_a_factor_of_two_is_a_range(most: float, told: str) -> None:
    """Jumps over cycles may grow or stay: what is about right is said alone, else both ends."""
    clock, counts = [0.0], [0]
    progress = console.Progress("jumps", now=lambda: clock[0])
    progress.start(2000, (lambda: counts[0], lambda: (90.0, most)))
    for _ in range(40):
        clock[0] += 1.0
        counts[0] += 1
        progress.step({"distance": 1.0, "area_contact": 0.1})
    assert progress.time_left() == told
