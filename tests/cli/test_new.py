"""`warpwear new`: commented studies of rigs that load, fit a measured surface, and run."""

import shutil
from importlib import resources
from pathlib import Path
from typing import Any

import pytest
import tomlkit
from click.testing import CliRunner, Result

from warpwear.cli.main import commands
from warpwear.cli.new import KINDS
from warpwear.drafts.draft import COLUMN, RIGS
from warpwear.errors import InputError
from warpwear.study.study import Study

ROOT = Path(__file__).parent.parent.parent
GROUND = ROOT / "docs" / "files" / "ground-disc.x3p"
#: What makes a rig's run a matter of a second: coarse cells and a short way.
SHORT = {
    "reciprocating": {"grid.cell": "20 um", "sliding.cycles": 2},
    "rotating": {"grid.cell": "20 um", "sliding.revolutions": 2},
    "fretting": {"grid.cell": "10 um", "sliding.cycles": 20},
    "pin": {"grid.cell": "40 um", "sliding.revolutions": 1},
    "block-on-ring": {"sliding.distance": "1 m"},
}
#: The law of contact that layers need.
#: A ball in the place of the cylinder that frets.
BALL = {"counter.shape": "ball", "contact.load": "20 N"}


@pytest.fixture(autouse=True)
def _place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def invoke(*arguments: str, changes: dict[str, Any] | None = None) -> Result:
    settings = [word for key, value in (changes or {}).items() for word in ("--set", f"{key}={value}")]
    return CliRunner().invoke(commands, [*arguments, *settings])


def drafted(*arguments: str, changes: dict[str, Any] | None = None) -> Study:
    """The study in a file just written."""
    done = invoke("new", "a.toml", "--overwrite", *arguments, changes=changes)
    assert done.exit_code == 0, done.exception
    return Study.load("a.toml")


def test_every_draft_is_on_offer() -> None:
    drafts = {file.name[:-5] for file in resources.files("warpwear.drafts").iterdir() if ".toml" in file.name}
    assert set(KINDS) == set(RIGS) == drafts | {"reciprocating"}


def test_the_first_run_is_the_draft_of_a_ball_to_and_fro() -> None:
    drafted_study, first = drafted("--like", "reciprocating"), Study.load("first")
    same = {"study.name": "first", "study.description": first.study.description}
    assert drafted_study.replace(same).model_dump() == first.model_dump()


@pytest.mark.parametrize("kind", KINDS)
def test_a_draft_loads_and_says_what_its_keys_are(kind: str) -> None:
    study = drafted("--like", kind)
    assert study.study.name == "a"
    lines = Path("a.toml").read_text(encoding="utf-8").splitlines()
    values = [line.split(" # ") for line in lines if " # " in line and line[0] not in "#["]
    for value, *_ in values:  # the name, for one, is shorter than the one it replaced
        assert len(value) + 1 == max(COLUMN, len(value.rstrip()) + 2), value
    sides = dict(zip(study.grid.sides, study.counter.form.rises, strict=True))
    if kind == "pin":
        assert 2.0 * study.counter.form.reach < min(study.grid.sides) < 3.0 * study.counter.form.reach
    elif kind != "block-on-ring" and study.hertz is not None:
        assert all(side > 2.0 * max(study.hertz.semi_axes) for side, rises in sides.items() if rises)


@pytest.mark.parametrize("kind", KINDS)
def test_a_measured_surface_gives_path_cells_and_extend(kind: str, tmp_path: Path) -> None:
    shutil.copy(GROUND, tmp_path / "ground.x3p")
    study = drafted("--like", kind, "--surface", "ground.x3p")
    document = tomlkit.parse(Path("a.toml").read_text(encoding="utf-8")).unwrap()
    assert document["disc"]["surface"] == "ground.x3p"
    assert document["disc"]["extend"] == "mirror"
    assert "synthetic" not in document["disc"]
    cell = study.grid.cell
    assert all(side / cell == pytest.approx(round(side / cell), rel=1e-6) for side in study.grid.sides)


@pytest.mark.parametrize("like", ["reciprocating", "fretting"])
def test_a_track_and_a_stroke_hold_whole_steps_of_any_pixel(like: str, tmp_path: Path) -> None:
    grid = [(x, y) for y in range(40) for x in range(40)]
    points = [f"{1.3e-3 * x:.6f} {1.3e-3 * y:.6f} {1e-5 * (x * y % 3):.6f}" for x, y in grid]
    Path("small.xyz").write_text("\n".join(points), encoding="utf-8")
    options = {"disc.height_unit": "mm", "disc.pixel": "1.3 um"}
    study = drafted("--like", like, "--surface", "small.xyz", changes=options)
    assert study.grid.cell == pytest.approx(1.3e-3, rel=0.1)
    length = study.sliding.lap if study.sliding.track == "full" else float(study.sliding.track)
    assert length is not None
    assert length / study.grid.cell == pytest.approx(round(length / study.grid.cell), abs=1e-4)


def test_a_ball_frets_where_the_draft_has_a_cylinder() -> None:
    study = drafted("--like", "fretting", changes=BALL)
    assert study.contact.boundary != "line"
    assert study.grid.sides[0] == study.grid.sides[1]
    assert study.hertz is not None
    assert study.grid.sides[1] > 2.0 * study.hertz.semi_axes[1]


@pytest.mark.parametrize(
    ("kind", "changes"),
    [
        ("reciprocating", {"contact.load": "500 N"}),
        ("rotating", {"wear.disc": "2e-4 mm^3/N/m"}),
        ("pin", {"counter.radius": "3 mm"}),
        ("fretting", {"contact.load": "500 N/mm"}),
        ("block-on-ring", {"contact.load": "100 N/mm"}),
    ],
)
def test_the_domain_grows_with_the_contact(kind: str, changes: dict[str, Any]) -> None:
    draft, larger = drafted("--like", kind), drafted("--like", kind, changes=changes)
    assert larger.grid.sides[0] > 1.2 * draft.grid.sides[0]
    assert larger.grid.cell == draft.grid.cell
    assert next(iter(changes.values())) in Path("a.toml").read_text(encoding="utf-8")


def test_a_track_is_no_longer_than_a_shorter_stroke() -> None:
    study = drafted("--like", "reciprocating", changes={"sliding.stroke": "0.5 mm"})
    assert (study.sliding.track, study.sliding.lap) == ("full", 0.5)
    assert drafted("--like", "pin", changes={"sliding.track_radius": "0.3 mm"}).sliding.track == "full"
    assert drafted("--like", "reciprocating").sliding.track != "full"


def test_a_file_that_is_there_is_kept() -> None:
    Path("a.toml").write_text("mine", encoding="utf-8")
    done = invoke("new", "a.toml")
    assert isinstance(done.exception, InputError)
    assert "--overwrite" in done.exception.sentence
    assert Path("a.toml").read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        (["a"], "named .toml"),
        (["no/a.toml"], "cannot be written"),
        (["a.toml", "--surface", "none.x3p"], "does not exist"),
        (["a.toml", "--like", "x"], "is not one of"),
        (["a.toml", "--set", "contact.load=5 N/mm"], "contact.load = 5 N/mm"),
        (["a.toml", "--set", "grid.extent=[1,2,3]"], "grid.extent"),
        (["a.toml", "--set", "counter=3"], "counter"),
        (["a.toml", "--set", "grid={extent='1 mm'}"], "grid.cell is missing"),
        (["a.toml", "--set", "sliding.strok=3"], "did you mean 'sliding.stroke'?"),
        (["a.toml", "--like", "pin", "--set", "grid.extent=1 mm"], "makes a pin"),
        (["a.toml", "--like", "fretting", "--set", "counter.shape=ball"], "allowed is a force"),
    ],
)
def test_what_is_no_study_is_refused_in_a_sentence(
    arguments: list[str], part: str, capsys: pytest.CaptureFixture[str]
) -> None:
    from warpwear.cli.main import main

    with pytest.raises(SystemExit) as end:
        main(["new", *arguments])
    assert end.value.code == 2
    (sentence,) = capsys.readouterr().err.splitlines()
    assert part in sentence
    assert not Path("a.toml").exists()


@pytest.mark.parametrize(("kind", "more"), [*((kind, {}) for kind in KINDS), ("fretting", BALL)])
def test_a_draft_runs(kind: str, more: dict[str, Any]) -> None:
    short = SHORT[kind] if not more else {"sliding.cycles": 2, "grid.cell": "10 um"}
    drafted("--like", kind, changes={**short, **more})
    done = invoke("run", "a.toml", "--no-plots")
    assert done.exit_code == 0, done.exception
    assert (Path("a") / "summary.json").is_file()


@pytest.mark.parametrize("kind", ["reciprocating", "rotating"])
def test_a_draft_runs_with_its_layers(kind: str) -> None:
    """Those that stand there as comments."""
    drafted("--like", kind, changes=SHORT[kind])
    text = Path("a.toml").read_text(encoding="utf-8")
    start = text.index("# [[disc.layers]]")
    end = text.index("\n\n", start)
    layer = "\n".join(line.removeprefix("# ") for line in text[start:end].splitlines())
    Path("a.toml").write_text(text[:start] + layer + text[end:], encoding="utf-8")
    assert [layer.name for layer in Study.load("a.toml").disc.layers or ()] == ["dlc"]
    done = invoke("run", "a.toml", "--no-plots")
    assert done.exit_code == 0, done.exception
    assert "layers_disc" in (Path("a") / "summary.json").read_text()


@pytest.mark.parametrize("kind", ["reciprocating", "rotating"])
def test_a_measured_disc_keeps_its_surface_when_a_layer_is_uncommented(kind: str) -> None:
    shutil.copy(GROUND, "disc.x3p")
    drafted("--like", kind, "--surface", "disc.x3p", changes={"disc.hardness": "3 GPa"})
    text = Path("a.toml").read_text("utf-8")
    start = text.index("# [[disc.layers]]")
    commented, end = text[start:].split("\n\n", 1)
    uncommented = "\n".join(line.removeprefix("# ") for line in commented.splitlines())
    disc = tomlkit.parse(f"{text[:start]}{uncommented}\n\n{end}").unwrap()["disc"]
    assert (disc["surface"], disc["extend"], disc["hardness"]) == ("disc.x3p", "mirror", "3 GPa")
    assert set(disc["layers"][0]) == {"name", "thickness", "wear", "hardness"}
