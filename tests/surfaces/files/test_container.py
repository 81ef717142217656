"""Containers of contact.engineering: one measurement of several is chosen, and nothing else is trusted."""

import io
import json
import re
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from click.testing import CliRunner
from fuzzing import check_sentence, watched

from warpwear import InputError
from warpwear.cli.main import commands
from warpwear.study.bodies import Disc
from warpwear.study.surface import surface_of
from warpwear.surfaces.measured import Measured
from warpwear.surfaces.reading import read

topographies = pytest.importorskip("SurfaceTopography")
HEIGHTS = np.random.default_rng(0).normal(size=(20, 30))
Save = Callable[..., Path]


@pytest.fixture
def container(tmp_path: Path) -> Save:
    """Write a container as SurfaceTopography does. surfaces: for each the names of its measurements."""
    from SurfaceTopography.Container.IO import write_containers
    from SurfaceTopography.Container.SurfaceContainer import InMemorySurfaceContainer

    def save(*surfaces: list[str]) -> Path:
        numbered = iter(range(1, 100))
        held = [
            InMemorySurfaceContainer(
                [
                    topographies.Topography(
                        next(numbered) * HEIGHTS, (40.0, 90.0), unit="um", info={"name": name}
                    )
                    for name in names
                ]
            )
            for names in surfaces
        ]
        write_containers(held, str(tmp_path / "discs.zip"))
        return tmp_path / "discs.zip"

    return save


def listed(path: Path, files: dict[str, bytes], *, name: str = "index.json", **about: Any) -> Path:
    """A container made by hand, of one measurement; about: what its list says of it."""
    entry = {"name": "mine", "size": [40.0, 90.0], "unit": "um", "datafile": {"original": next(iter(files))}}
    content = {"surfaces": [{"name": "disc", "topographies": [entry | about]}]}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for member, data in files.items():
            archive.writestr(member, data)
        archive.writestr(name, json.dumps(content))  # which is YAML, too
    return path


def npy(array: Any) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, array)
    return buffer.getvalue()


def test_the_only_measurement_is_read(container: Save) -> None:
    reading = read(container(["a"]))
    np.testing.assert_allclose(reading.heights, 1e-3 * HEIGHTS, rtol=1e-12)
    assert reading.pixel == pytest.approx((2e-3, 3e-3))
    assert "measurement 'a' of the container" in reading.notes


@pytest.mark.parametrize(("asked", "factor"), [("b", 2.0), ("0", 1.0), ("1", 2.0)])
def test_one_of_several_is_chosen_by_name_or_number(container: Save, asked: str, factor: float) -> None:
    reading = read(container(["a", "b"]), array=asked)
    np.testing.assert_allclose(reading.heights, factor * 1e-3 * HEIGHTS, rtol=1e-12)


def test_those_of_several_surfaces_bear_their_names(container: Save) -> None:
    path = container(["a"], ["a"])
    np.testing.assert_allclose(read(path, array="surface1/a").heights, 2e-3 * HEIGHTS, rtol=1e-12)
    with pytest.raises(InputError, match=re.escape("0 (surface0/a), 1 (surface1/a)")):
        read(path)


@pytest.mark.parametrize(
    ("asked", "words"), [(None, "holds several measurements"), ("c", "holds no measurement 'c'")]
)
def test_what_is_there_is_told(container: Save, asked: str | None, words: str) -> None:
    with pytest.raises(InputError, match=words) as error:
        read(container(["a", "b"]), array=asked)
    assert "disc.array gives a number or a name of: 0 (a), 1 (b)." in str(error.value)
    check_sentence(error.value)


def test_equal_names_need_a_number(container: Save) -> None:
    path = container(["a", "a"])
    with pytest.raises(InputError, match="holds 2 measurements 'a'"):
        read(path, array="a")
    np.testing.assert_allclose(read(path, array="1").heights, 2e-3 * HEIGHTS, rtol=1e-12)


@pytest.mark.parametrize("name", ["index.json", "meta.yml"])
def test_the_list_says_what_the_file_does_not(tmp_path: Path, name: str) -> None:
    """An array has neither unit nor size; the factor of its heights is the list's."""
    path = listed(tmp_path / "x.zip", {"h.npy": npy(HEIGHTS)}, name=name, height_scale=3.0)
    reading = read(path)
    np.testing.assert_allclose(reading.heights, 3e-3 * HEIGHTS, rtol=1e-12)
    assert reading.pixel == pytest.approx((2e-3, 3e-3))


def test_line_scans_are_left_out(tmp_path: Path) -> None:
    path = listed(tmp_path / "x.zip", {"h.npy": npy(HEIGHTS)}, size=[40.0])
    with pytest.raises(InputError, match="holds no areal measurement"):
        read(path)


def test_a_study_and_the_command_read_it(container: Save, tmp_path: Path) -> None:
    path = container(["a", "b"])
    surface = surface_of(Disc(surface=str(path), array="b", level="none"))
    assert isinstance(surface, Measured)
    np.testing.assert_allclose(surface.levelled, 2e-3 * (HEIGHTS - HEIGHTS.mean()), atol=1e-15)
    done = CliRunner().invoke(commands, ["surface", str(path), "--array", "b", "--json"])
    assert done.exit_code == 0
    assert json.loads(done.output)["file_grid"] == [20, 30]
    with pytest.raises(InputError, match=re.escape("array gives a number or a name of: 0 (a), 1 (b)")):
        CliRunner().invoke(commands, ["surface", str(path), "--json"], catch_exceptions=False)


def away(tmp_path: Path) -> bytes:
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["heights"] = HEIGHTS
    with h5py.File(tmp_path / "linked.h5", "w") as file:
        file["heights"] = h5py.ExternalLink(str(tmp_path / "other.h5"), "/heights")
    return (tmp_path / "linked.h5").read_bytes()


def test_a_member_reads_no_other_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="from another file, which is not followed") as error:
        read(listed(tmp_path / "x.zip", {"h.h5": away(tmp_path)}))
    assert "x.zip: h.h5'" in str(error.value)


BOMB = "surfaces: &a [{name: x}]\n" + "a: {b: &b {c: 1}}\nd: {<<: [*b, *b]}\n"


@pytest.mark.parametrize(
    ("files", "about", "words"),
    [
        ({"h.npy": bytes(20_000_000)}, {}, "bytes in .* of a .zip"),
        ({"h.npy": npy(HEIGHTS)}, {"datafile": {"original": "../../etc/passwd"}}, "cannot be read"),
        ({"h.npy": npy(HEIGHTS)}, {"datafile": {}}, "Could not detect data file"),
        ({"h.npy": npy(HEIGHTS)}, {"size": [0.0, "x"]}, "cannot be read as a container"),
        ({"h.npy": npy(HEIGHTS)}, {"size": [40.0, 1e-300]}, "pixel"),
        ({"h.npy": b"<script>"}, {"name": "<script>\x1b[31m\n" + "x" * 300}, "cannot be read"),
        ({"h.zip": b""}, {}, "cannot be read"),
    ],
    ids=["zeros", "another file", "no file", "no sizes", "no size", "no heights", "an archive"],
)
def test_what_is_wrong_is_one_sentence(
    tmp_path: Path, files: dict[str, bytes], about: dict[str, Any], words: str
) -> None:
    path = listed(tmp_path / "x.zip", files, **about)
    with watched(20.0), pytest.raises(InputError, match=words) as error:
        read(path)
    check_sentence(error.value)
    assert str(error.value).isprintable()


def test_a_container_in_a_container_is_refused(tmp_path: Path) -> None:
    inner = listed(tmp_path / "inner.zip", {"h.npy": npy(HEIGHTS)}).read_bytes()
    with pytest.raises(InputError, match="a container in a container"):
        read(listed(tmp_path / "x.zip", {"h.zip": inner}))


@pytest.mark.parametrize(
    "content", [b"[", b"3", b"surfaces: 3", b"surfaces: [{}]", BOMB.encode(), b"[" * 9_999]
)
@pytest.mark.parametrize("name", ["index.json", "meta.yml"])
def test_a_wrong_list_is_one_sentence(tmp_path: Path, name: str, content: bytes) -> None:
    with zipfile.ZipFile(tmp_path / "x.zip", "w") as archive:
        archive.writestr(name, content)
    with watched(20.0), pytest.raises(InputError, match=r"container|list") as error:
        read(tmp_path / "x.zip")
    check_sentence(error.value)
