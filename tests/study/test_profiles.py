"""A study whose disc is a profile, or like one."""

from pathlib import Path

import numpy as np
import pytest
from cases_instruments import rough

import warpwear
from warpwear import Study
from warpwear.batches.plan import points_of
from warpwear.errors import InputError
from warpwear.study.surface import surface_in

STEP = 0.002


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with a profile."""
    heights = rough(np.random.default_rng(0), 1500, STEP, hurst=0.8, roll_off=0.1, rq=1e-3)
    table = np.column_stack([STEP * np.arange(1500), 1e3 * heights])
    np.savetxt(tmp_path / "p.csv", table, delimiter=",", header="x [mm],z [um]", comments="")
    return tmp_path


def study(folder: Path, disc: str) -> Study:
    text = Study.load("v3").to_toml()
    head, _, rest = text.partition("[disc.synthetic]")
    (folder / "study.toml").write_text(head + disc + rest[rest.index("\n[") :], encoding="utf-8")
    return Study.load(folder / "study.toml")


LIKE = '[disc.synthetic]\nlike = "p.csv"\nperiod = "1 mm"\ncut_off = "16 um"\n'


def test_like_stands_for_its_kind_and_is_read_from_beside_the_study(folder: Path) -> None:
    like = study(folder, LIKE)
    assert like.disc.synthetic is not None
    assert like.disc.synthetic.kind == "profile"
    record = surface_in(like).record()
    assert (record["kind"], record["like"]) == ("profile", "p.csv")
    assert record["sq_um"] == pytest.approx(1.0, rel=0.1)  # less waves over 1 mm
    (folder / "other.toml").write_text(like.to_toml(), encoding="utf-8")
    again = surface_in(Study.load(folder / "other.toml"))
    assert again == surface_in(like)


def test_a_profile_is_a_disc_alike_across(folder: Path) -> None:
    surface = surface_in(study(folder, 'surface = "p.csv"\n'))
    x, y = STEP * (np.arange(100) - 49.5), STEP * (np.arange(40) - 19.5)
    heights = surface.heights(x, y)
    np.testing.assert_allclose(heights, heights[:, :1] + np.zeros(40), atol=1e-15)
    given = np.loadtxt(folder / "p.csv", delimiter=",", skiprows=1)[:, 1]
    given = given - np.polyval(np.polyfit(np.arange(1500), given, 1), np.arange(1500))
    np.testing.assert_allclose(1e3 * heights[:, 0], given[700:800], atol=1e-9)
    notices = surface.notices(x, y)
    assert any("is a profile" in text for text in notices)
    assert not any("along y" in text for text in notices)
    assert surface.record()["file_grid"] == [1500]


@pytest.mark.parametrize(
    ("disc", "what"),
    [
        ('surface = "p.csv"\nsliding_axis = "y"\n', r"disc\.sliding_axis = 'y' is for a map"),
        (LIKE.replace("p.csv", "none.csv"), r"disc\.synthetic\.like .* does not exist"),
        (LIKE.replace("1 mm", "4 mm"), r"disc\.synthetic\.period is 4 mm: allowed is at most"),
        ('[disc.synthetic]\nkind = "profile"\n', r"disc\.synthetic\.like"),
        (LIKE.replace("p.csv", "bare.csv"), r"disc\.synthetic\.like .* does not say its units"),
    ],
)
def test_bad_discs(folder: Path, disc: str, what: str) -> None:
    np.savetxt(folder / "bare.csv", np.loadtxt(folder / "p.csv", delimiter=",", skiprows=1), delimiter=";")
    with pytest.raises(InputError, match=what):
        surface_in(study(folder, disc))


def test_a_changed_profile_is_another_run(folder: Path) -> None:
    before = study(folder, LIKE)
    assert before.files == {"disc.synthetic.like": str(folder / "p.csv")}
    names = []
    for end in ("", "3,0\n"):
        with (folder / "p.csv").open("a", encoding="utf-8") as file:
            file.write(end)
        names.append(points_of(before, [{}], device="cpu")[0].run)
    assert names[0] != names[1]


LINE = """
[counter]
shape = "cylinder"
radius = "3 mm"
material = "AISI 52100"
[disc]
material = "AISI 304"
surface = "p.csv"
[contact]
load = "20 N/mm"
law = "half-space"
boundary = "line"
hardness = "4 GPa"
[wear]
counter = "1e-5 mm^3/N/m"
disc = "1e-5 mm^3/N/m"
[grid]
cell = "2 um"
extent = ["0.8 mm", "2 um"]
[sliding]
distance = "1 mm"
[stepping]
scheme = "implicit"
first = "0.5 mm"
"""


def test_a_line_contact_of_one_row_of_cells(folder: Path, device: str) -> None:
    """It carries the load, on fewer cells than a smooth disc does."""
    (folder / "line.toml").write_text(LINE, encoding="utf-8")
    line = Study.load(folder / "line.toml")
    smooth = line.replace({"disc.surface": None, "disc.synthetic": {"kind": "flat"}})
    assert not any("seam" in notice for notice in line.notices())
    cells = []
    for one in (line, smooth):
        pressure = warpwear.run(one, device=device).snapshots[0].pressure
        assert pressure.shape == (400, 1)
        assert pressure.sum() * 0.002 == pytest.approx(20.0, rel=1e-3)
        cells.append(int((pressure > 0.0).sum()))
    assert 0 < cells[0] < 0.8 * cells[1]
