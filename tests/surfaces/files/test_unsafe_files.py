"""Files that would read other files, or take for ever: refused, and soon."""

import os
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from fuzzing import check_sentence, watched

from warpwear.errors import InputError
from warpwear.measured.record import read_record
from warpwear.surfaces.reading import read

GIVEN = {"pixel": 1e-3, "height_unit": "um"}
HEIGHTS = np.random.default_rng(0).normal(size=(12, 8))


def virtual(file: h5py.File, other: Path) -> None:
    layout = h5py.VirtualLayout(shape=HEIGHTS.shape, dtype=float)
    layout[:] = h5py.VirtualSource(str(other), "heights", shape=HEIGHTS.shape)
    file.create_virtual_dataset("heights", layout)


def linked(file: h5py.File, other: Path) -> None:
    file["heights"] = h5py.ExternalLink(str(other), "/heights")


def linked_below(file: h5py.File, other: Path) -> None:
    file["heights"] = HEIGHTS
    file.create_group("a/b")["c"] = h5py.ExternalLink(str(other), "/heights")


def stored_elsewhere(file: h5py.File, other: Path) -> None:
    secret = other.with_name("secret")
    secret.write_bytes(b"root:x:0:0:" + bytes(8 * HEIGHTS.size))
    file.create_dataset(
        "heights", shape=HEIGHTS.shape, dtype=float, external=[(str(secret), 0, 8 * HEIGHTS.size)]
    )


@pytest.mark.parametrize("name", ["disc.h5", "disc.mat", "disc.nc", "disc.datx", "disc.sur", "disc.txt"])
@pytest.mark.parametrize("make", [virtual, linked, linked_below, stored_elsewhere])
def test_hdf5_reads_no_other_file(tmp_path: Path, make: Callable[[h5py.File, Path], None], name: str) -> None:
    pytest.importorskip("SurfaceTopography")
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["heights"] = HEIGHTS
    np.testing.assert_allclose(read(tmp_path / "other.h5", **GIVEN).heights, 1e-3 * HEIGHTS)
    with h5py.File(tmp_path / name, "w") as file:
        make(file, tmp_path / "other.h5")
    with pytest.raises(InputError, match=r"takes '.*' from another file, which is not followed") as error:
        read(tmp_path / name, **GIVEN)
    check_sentence(error.value)


@pytest.mark.parametrize("name", ["disc.txt", "disc.sur"])
@pytest.mark.parametrize(
    "content",
    [
        bytes(4_000_000),
        b"a" + bytes(4_000_000),
        bytes(4_000_000) + b"1 2\n",
        b"\xff\xfe" + 1_000_000 * b"\0\0\n\0",
        4_000_000 * b".",
    ],
    ids=["zeros", "a letter", "zeros and numbers", "zeros of two bytes", "points"],
)
def test_what_is_no_surface_is_refused_soon(tmp_path: Path, name: str, content: bytes) -> None:
    assert pytest.importorskip("SurfaceTopography").IO  # which takes seconds to import
    (tmp_path / name).write_bytes(content)
    with watched(1.0), pytest.raises(InputError) as error:
        read(tmp_path / name, **GIVEN)
    check_sentence(error.value)


def test_more_points_than_a_file_can_hold_are_not_made(tmp_path: Path) -> None:
    pytest.importorskip("SurfaceTopography")
    with h5py.File(tmp_path / "disc.h5", "w") as file:  # 3 GB of nothing, in 2 kB
        file.create_dataset("heights", shape=(20_000, 20_000), dtype=float, chunks=(100, 100))
    with watched(), pytest.raises(InputError, match=r"points in .* bytes, which is more than can be there"):
        read(tmp_path / "disc.h5", **GIVEN)


def test_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    for name in ("pipe.csv", "pipe.sur", "pipe"):
        os.mkfifo(tmp_path / name)
        with pytest.raises(InputError, match="is not a file"):
            read(tmp_path / name, **GIVEN)
        with pytest.raises(InputError, match="it is not a file"):
            read_record(tmp_path / name)
