"""A run's folder as an RO-Crate, packed, and made again by someone who has nothing else."""

import json
import tomllib
import zipfile
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import tomli_w
from click.testing import CliRunner

import warpwear
from warpwear import InputError, Study
from warpwear.cli.main import commands
from warpwear.results.file import MAGIC
from warpwear.results.formats.bodies import worn_heights
from warpwear.results.formats.metadata import NAME
from warpwear.results.seal import seal

#: Pitch of the measured surface [mm].
PITCH = 0.01


def datasets(path: Path) -> dict[str, bytes]:
    """Bytes of every dataset of a result."""
    values: dict[str, bytes] = {}
    with h5py.File(path) as file:
        file.visititems(
            lambda name, item: (
                values.__setitem__(name, np.asarray(item).tobytes())
                if isinstance(item, h5py.Dataset)
                else None
            )
        )
    return values


def graph(text: str) -> dict[str, dict[str, Any]]:
    """Entities of the metadata by their names; every reference inside the crate leads to one."""
    content = json.loads(text)
    entities = {entity["@id"]: entity for entity in content["@graph"]}
    assert len(entities) == len(content["@graph"])
    for entity in entities.values():
        for value in entity.values():
            for one in value if isinstance(value, list) else [value]:
                if isinstance(one, dict) and not one["@id"].startswith("https:"):
                    assert one["@id"] in entities, one
    return entities


@pytest.fixture
def run(tmp_path: Path) -> Path:
    """A run on measured heights, in a folder of its own."""
    heights = np.random.default_rng(4).normal(0.0, 2e-4, (60, 60))
    x, y = np.meshgrid(PITCH * np.arange(60), PITCH * np.arange(60), indexing="ij")
    np.savetxt(tmp_path / "my disc.xyz", np.column_stack([x.ravel(), y.ravel(), heights.ravel()]))
    study = {
        "grid.cell": "20 um",
        "grid.extent": "0.4 mm",
        "sliding.distance": "3 mm",
        "counter.radius": "0.6 mm",
        "study.author": "A. Person",
        "study.publisher": "A Laboratory <https://example.org>",
        "study.license": "https://creativecommons.org/licenses/by/4.0/",
        "disc.synthetic": None,
        "disc.height_unit": "mm",
        "disc.pixel": f"{PITCH} mm",
        "disc.surface": str(tmp_path / "my disc.xyz"),
    }
    warpwear.run(Study.load("v3-fine").replace(study), out=tmp_path / "run", plots=False)
    return tmp_path / "run"


def test_a_run_folder_is_a_crate(run: Path) -> None:
    """What the metadata lists is there, with units, and what a crate must say stands in it."""
    entities = graph((run / NAME).read_text(encoding="utf-8"))
    root, about = entities["./"], entities[NAME]
    assert about["conformsTo"]["@id"] == "https://w3id.org/ro/crate/1.1"
    assert about["about"] == {"@id": "./"}
    assert all(root[key] for key in ("name", "description", "datePublished"))
    kinds = {"author": "Person", "publisher": "Organization", "license": "CreativeWork"}
    assert {key: entities[root[key]["@id"]]["@type"] for key in kinds} == kinds
    assert entities["#author"]["affiliation"] == {"@id": "#publisher"}
    assert entities["#publisher"]["name"] == "A Laboratory"
    assert entities["#publisher"]["url"] == "https://example.org"
    assert all((run / part["@id"]).is_file() for part in root["hasPart"])
    assert entities["#contact.load"]["unitText"] == "N"
    assert entities["#contact.load"]["propertyID"].endswith("#NormalLoadSetpoint")
    columns = (run / "history.csv").read_text(encoding="utf-8").splitlines()[0].split(",")
    measured = [entities[one["@id"]] for one in entities["history.csv"]["variableMeasured"]]
    assert [f"{one['name']} [{one['unitText']}]" for one in measured] == columns


def test_whoever_has_only_the_crate_makes_the_run_again(run: Path, tmp_path: Path) -> None:
    """Every dataset of the result is the same to the last bit; a record and a surface travel along."""
    record, track = tmp_path / "record.csv", tmp_path / "worn track.xyz"
    record.write_text("Distance [mm],COF\n0,0.2\n1,0.3\n", encoding="utf-8")
    track.write_bytes((tmp_path / "my disc.xyz").read_bytes()[::-1])
    options = ["export", str(run), "--crate", "--out", str(tmp_path / "sent")]
    options += ["--add", str(record), "--add", str(track)]
    answer = CliRunner().invoke(commands, options)
    assert answer.exit_code == 0, answer.output
    elsewhere = tmp_path / "elsewhere"
    with zipfile.ZipFile(tmp_path / "sent" / "crate.zip") as archive:
        archive.extractall(elsewhere)
    (tmp_path / "my disc.xyz").unlink()
    entities = graph((elsewhere / NAME).read_text(encoding="utf-8"))
    parts = {part["@id"] for part in entities["./"]["hasPart"]}
    assert {"inputs/my%20disc.xyz", "added/record.csv", "added/worn%20track.xyz"} <= parts
    for added in (record, track):
        assert (elsewhere / "added" / added.name).read_bytes() == added.read_bytes()
    assert str(tmp_path) not in (elsewhere / "study.toml").read_text(encoding="utf-8")
    warpwear.run(Study.load(elsewhere / "study.toml"), out=tmp_path / "again", plots=False)
    assert datasets(tmp_path / "again" / "result.h5") == datasets(run / "result.h5")


def test_a_crate_holds_what_the_run_was_made_on(run: Path, tmp_path: Path) -> None:
    surface = tmp_path / "my disc.xyz"
    with warpwear.Result.open(run) as result:
        with pytest.raises(InputError, match=r"add = .*gone.csv is no file"):
            result.export(tmp_path / "sent", formats=["crate"], add=[tmp_path / "gone.csv"])
        surface.write_text(surface.read_text(encoding="utf-8").replace("0.0", "0.1", 1), encoding="utf-8")
        with pytest.raises(InputError, match="is not what the run was made on"):
            result.export(tmp_path / "sent", formats=["crate"])
        surface.unlink()
        with pytest.raises(InputError, match="the file is gone"):
            result.export(tmp_path / "sent", formats=["crate"])
    assert not (tmp_path / "sent").exists()


def stranger(run: Path, *, surface: Path, files: dict[str, str] | None) -> Path:
    """Make a run folder whose result names a file of another, and says of it what it likes, or nothing."""
    with h5py.File(run / "result.h5", "r+") as file:
        study = tomllib.loads(file.attrs["study"])
        study["disc"]["surface"] = str(surface)
        file.attrs["study"] = tomli_w.dumps(study)
        record = json.loads(file.attrs["record"])
        record["surface"].pop("sha256", None)
        record["files"] = files or {}
        file.attrs["record"] = json.dumps(record)
    sealed(run)
    return run


def sealed(run: Path) -> None:
    with (run / "result.h5").open("r+b") as whole:
        seal(whole, MAGIC)


def packed(folder: Path) -> bytes:
    """All that stands in the crate in a folder; nothing without one."""
    if not (folder / "crate.zip").exists():
        return b""
    with zipfile.ZipFile(folder / "crate.zip") as archive:
        return b"".join(archive.read(name) for name in archive.namelist())


def crated(run: Path, out: Path, *more: str) -> str:
    """Pack a crate on the command line; returns why it was refused, or nothing."""
    answer = CliRunner().invoke(commands, ["export", str(run), "--crate", "--out", str(out), *more])
    assert isinstance(answer.exception, InputError | None), answer.exception
    return str(answer.exception or "")


@pytest.fixture
def secret(tmp_path: Path) -> Path:
    """A file of the user that nobody else may see."""
    (tmp_path / "keys").mkdir()
    path = tmp_path / "keys" / "id_rsa"
    path.write_bytes(b"the only key there is")
    return path


@pytest.mark.parametrize("way", ["as it is", "relative", "by a link", "beside the result"])
@pytest.mark.parametrize("digest", [None, "of another", 7])
def test_a_stranger_gets_no_file_that_his_result_names(
    way: str, digest: Any, run: Path, secret: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nor by a relative path, a link in his folder or a digest that he made up."""
    monkeypatch.chdir(run)
    named = {"as it is": secret, "relative": Path("../keys/id_rsa")}.get(way, run / "inputs" / "disc.npy")
    if way in ("by a link", "beside the result"):
        named = run / ("surface.npy" if way == "beside the result" else "disc.npy")
        named.symlink_to(secret)
    stranger(run, surface=named, files=None if digest is None else {"disc.surface": digest})
    if way == "beside the result":
        with h5py.File(run / "result.h5", "r+") as file:
            file.attrs["own_surface"] = True
        sealed(run)
    wrong = "is not what the run was made on" if digest == "of another" else "does not carry what was in that"
    assert wrong in crated(run, tmp_path / "sent")
    assert packed(tmp_path / "sent") == b""
    if digest is None:  # the user's own word
        assert not crated(run, tmp_path / "sent", "--add", str(named))
        assert secret.read_bytes() in packed(tmp_path / "sent")


@pytest.mark.parametrize("name", ["history.csv", "surface.csv", "summary.json", "result.h5"])
def test_a_link_in_a_run_folder_takes_nothing_along(
    name: str, run: Path, secret: Path, tmp_path: Path
) -> None:
    if name == "result.h5":
        secret.write_bytes((run / name).read_bytes())
    (run / name).unlink()
    (run / name).symlink_to(secret)
    assert f"{name} is a link, which may lead to any file of yours" in crated(run, tmp_path / "sent")
    assert packed(tmp_path / "sent") == b""


def test_heights_given_as_an_array_travel_by_their_digest(run: Path, tmp_path: Path) -> None:
    """The file that a run wrote itself is in the crate, wherever the folder was moved, unless it changed."""
    study = Study.load(run).replace({"grid.extent": "0.4 mm"})
    heights = np.random.default_rng(5).normal(0.0, 2e-4, (study.cells.nx, study.cells.ny))
    warpwear.run(study, surface=heights, out=tmp_path / "first", plots=False).close()
    (tmp_path / "first").rename(tmp_path / "moved")
    assert not crated(tmp_path / "moved", tmp_path / "sent")
    assert (tmp_path / "moved" / "surface.npy").read_bytes() in packed(tmp_path / "sent")
    np.save(tmp_path / "moved" / "surface.npy", 2.0 * heights)
    assert "is not what the run was made on" in crated(tmp_path / "moved", tmp_path / "again")


def test_a_worn_disc_goes_on_beyond_the_ball_as_the_run_had_it(run: Path, tmp_path: Path) -> None:
    """Of a file that was exchanged since nothing is taken."""
    study = Study.load(run).replace({"counter.radius": "0.18 mm", "sliding.distance": "0.1 mm"})
    with warpwear.run(study, out=tmp_path / "small", plots=False) as result:
        before = worn_heights(result, result.snapshot(-1), "disc")
        surface = tmp_path / "my disc.xyz"
        np.savetxt(surface, np.loadtxt(surface) * (1.0, 1.0, 2.0))
        after = worn_heights(result, result.snapshot(-1), "disc")
    assert np.isfinite(before).all()
    assert np.isnan(after[0, 0])
    np.testing.assert_array_equal(after[np.isfinite(after)], before[np.isfinite(after)])
