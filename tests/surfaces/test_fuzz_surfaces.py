"""Broken files of surfaces: refused in one sentence, or read as what they still say.

What a read may be wrong about depends on the format:

- .npz and .x3p carry checksums: a read must equal that of the intact file.
- A list of points says where each height belongs: another grid only where points are counted as missing.
- In a .npy, a matrix of text and the other instrument formats nothing tells a changed digit or bit of a
  height from a measured one, nor "um" that became "nm", nor, in text, rows that are gone whole. A read must
  be a height map of finite numbers on a possible pixel.
- A file cut short is refused; text, which declares no length, may also be read as the beginning of the intact
  file, and unless the cut is at the end of a line the reading says so.
"""

import gzip
import io
import json
import math
import random
import resource
import tempfile
import zipfile
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from cases_instruments import metropro, opd
from fuzzing import LARGE, check_sentence, in_a_child, mutated_bytes, mutated_file, numbers, watched
from scipy.io import savemat

from warpwear.cli.surface import describe
from warpwear.errors import InputError
from warpwear.results.formats.bodies import ExportedBody
from warpwear.results.formats.metrology import write_sdf, write_x3p
from warpwear.surfaces.measured import read_measured
from warpwear.surfaces.reading import Reading, read

REAL = Path(__file__).resolve().parents[3] / "shared" / "surfaces"
NX = 24  # points along x
NY = 18  # points along y
GIVEN: dict[str, Any] = {"pixel": 1e-3, "height_unit": "um"}
#: The head of Gwyddion's text of heights in m.
GWYDDION = "# Channel: Topography\n# Width: 1.8 mm\n# Height: 1.8 mm\n# Value units: µm\n".encode()
#: Whose content is covered by checksums.
SUMMED = (".npz", ".x3p")
#: Whose every value says where it belongs.
PLACED = ("points.xyz",)


def matrix(heights: np.ndarray, separator: str = " ", comma: bool = False) -> bytes:
    text = "\n".join(separator.join(f"{v:.4f}" for v in row) for row in heights.T) + "\n"
    return (text.replace(".", ",") if comma else text).encode()


def points(heights: np.ndarray) -> bytes:
    lines = [f"{i:d}.0 {j:d}.0 {v:.4f}" for (i, j), v in np.ndenumerate(heights)]
    return ("# x [um] y [um] z [um]\n" + "\n".join(lines) + "\n").encode()


def saved(save: Any) -> bytes:
    file = io.BytesIO()
    save(file)
    return file.getvalue()


def hdf5(heights: np.ndarray, file: Any) -> None:
    with h5py.File(file, "w") as content:
        content.create_dataset("heights", data=heights, compression="gzip", fletcher32=True)


def zipped(content: bytes) -> bytes:
    """A container of one measurement, as contact.engineering lists it."""
    entry = {"name": "mine", "size": [4e3, 3e3], "unit": "um", "datafile": {"original": "heights.npy"}}
    listed = {"surfaces": [{"name": "disc", "topographies": [entry]}]}
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("heights.npy", content)
        archive.writestr("index.json", json.dumps(listed))
    return file.getvalue()


def write_mat(path: Path, body: ExportedBody) -> None:
    with path.open("wb") as file:
        savemat(file, {"heights": 1e3 * body.heights})


def made_by(make: Callable[[Path], None]) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        make(Path(folder) / "x")
        return (Path(folder) / "x").read_bytes()


def made(nx: int, ny: int) -> dict[str, tuple[bytes, dict[str, Any]]]:
    """Name -> content, and what has to be given to read it."""
    heights = np.random.default_rng(5).normal(size=(nx, ny)).round(4)
    raster = (heights / 0.6).astype("<f4")
    return {
        "x.npy": (saved(lambda f: np.save(f, heights)), GIVEN),
        "x.npz": (saved(lambda f: np.savez_compressed(f, z=heights, other=np.zeros(3))), GIVEN),
        "blanks.txt": (matrix(heights), GIVEN),
        "semicolons.csv": (b"heights\n" + matrix(heights, ";", comma=True), GIVEN),
        "points.xyz": (points(heights), {}),
        "x.h5": (saved(partial(hdf5, heights)), GIVEN),
        "x.opd": (made_by(lambda path: opd(path, raster, wavelength=600.0, multiplier=None)), {}),
        "x.dat": (made_by(lambda path: metropro(path, 1e-6 * heights)), {}),
    }


def large(name: str) -> tuple[bytes, dict[str, Any]]:
    """A file of about `fuzzing.LARGE` bytes, also of formats that results are exported to and that pack."""
    about = GWYDDION if name == "x.asc" else b""
    of = {"x.asc": "blanks.txt", "x.txt.gz": "blanks.txt", "x.zip": "x.npy"}.get(name, name)
    size = LARGE * (2.7 if of != name and not about else 1.0)  # what text is packed to, about
    if of in MADE:
        content, options = MADE[of]
        nx, ny = NX, NY
        for _ in range(2):  # heads and sums take a part of a small file
            times = math.sqrt(size / len(content))
            nx, ny = round(times * nx), round(times * ny)
            content, options = made(nx, ny)[of]
    else:
        side = round(math.sqrt(size / {"x.sdf": 22.0, "x.x3p": 5.6, "x.mat": 8.0}[name]))
        heights = 1e-3 * np.random.default_rng(5).normal(size=(side, side)).round(4)
        body = ExportedBody("disc", "a disc", 2e-3 * np.arange(side), 2e-3 * np.arange(side), heights)
        write: Any = {"x.sdf": write_sdf, "x.x3p": write_x3p, "x.mat": write_mat}[name]
        content, options = made_by(lambda path: write(path, body)), GIVEN if name == "x.mat" else {}
    if name == "x.zip":
        return zipped(content), {}
    return gzip.compress(content) if name == "x.txt.gz" else about + content, {} if about else options


MADE = made(NX, NY)
#: What is only tried large.
MORE = ("x.asc", "x.txt.gz", "x.zip", "x.sdf", "x.x3p", "x.mat", "sur-2.sur")
#: What SurfaceTopography reads.
FOREIGN = ("x.h5", "x.opd", "x.dat")


def content_of(name: str) -> tuple[bytes, dict[str, Any]]:
    if name in FOREIGN:
        pytest.importorskip("SurfaceTopography")
    if name in MADE:
        return MADE[name]
    pytest.importorskip("SurfaceTopography")
    path = REAL / name
    if not path.is_file():
        pytest.skip("the measured files are not here")
    return path.read_bytes(), {}


def outcome(path: Path, content: bytes, options: dict[str, Any]) -> Reading | None:
    """What is read, the whole way to a prepared surface; None where it is refused in one sentence."""
    path.write_bytes(content)
    with watched():
        try:
            found = read(path, **options)
        except InputError as error:
            check_sentence(error)
            return None
        assert found.heights.ndim == 2
        assert np.isfinite(found.heights).any()
        assert not np.isinf(found.heights).any()
        assert all(1e-7 <= p <= 1.0 for p in found.pixel)
        try:
            surface = read_measured(path, **options)
            assert np.isfinite(surface.levelled).all()
            if surface.levelled.size < 10_000:
                given = {"pixel": "1 um", "height_unit": "um"} if options else {}
                assert describe(path, given, as_json=True).startswith("{")
        except InputError as error:
            check_sentence(error)
    return found


def same(one: Reading, other: Reading) -> bool:
    return one.pixel == other.pixel and np.array_equal(one.heights, other.heights, equal_nan=True)


def cut_short(name: str, found: Reading, intact: Reading, *, at_line_end: bool) -> str:
    """What a file cut short was read as: the beginning of the whole, without its last value's digits."""
    if same(found, intact):
        return "equal"
    assert name.endswith((".txt", ".csv", ".xyz")), f"a {name} cut short was read"
    assert at_line_end or any("cut" in note for note in found.notes), "nothing says that the file was cut"
    rows = np.s_[:, : found.heights.shape[1]] if name not in PLACED else np.s_[: found.heights.shape[0]]
    whole = intact.heights[rows]
    assert found.pixel == pytest.approx(intact.pixel)
    assert found.heights.shape == whole.shape
    there = np.isfinite(found.heights)
    assert np.count_nonzero(found.heights[there] != whole[there]) <= 1
    return "its beginning"


def changed(name: str, found: Reading, intact: Reading) -> str:
    """What a file with changed bytes was read as."""
    if same(found, intact):
        return "equal"
    assert not name.endswith(SUMMED), f"a broken {name} was read as something else"
    if found.heights.shape != intact.heights.shape:
        if name in PLACED:
            assert np.isnan(found.heights).any(), "another grid, and no point of it is missing"
        return "another grid"
    return "other heights" if found.pixel == intact.pixel else "another pixel"


def try_broken(name: str, count: int, folder: Path, *, cuts: int = 100) -> Counter[str]:
    """Count how a file was read when cut in `cuts` places, and when broken otherwise `count` times."""
    content, options = content_of(name)
    path = folder / name
    intact = outcome(path, content, options)
    assert intact is not None
    found: Counter[str] = Counter()
    for part in range(cuts):
        short = content[: len(content) * part // cuts]
        read_as = outcome(path, short, options)
        if read_as is None:
            found["cut: refused"] += 1
        else:
            found["cut: " + cut_short(name, read_as, intact, at_line_end=short.endswith(b"\n"))] += 1
    for seed in numbers(count):
        broken = mutated_bytes(content, random.Random(seed))
        read_as = outcome(path, broken, options)
        found["refused" if read_as is None else changed(name, read_as, intact)] += 1
    return found


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", MADE)
@pytest.mark.parametrize(("count", "cuts"), [(30, 20), pytest.param(300, 100, marks=pytest.mark.slow)])
def test_broken_files(name: str, count: int, cuts: int, tmp_path: Path, record_property: Any) -> None:
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    found = try_broken(name, count, tmp_path, cuts=cuts)
    record_property("read as", dict(found))
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before  # KiB
    print(name, dict(found), f"{grown / 1024:.0f} MiB")
    assert grown < 2**20
    assert found["refused"] > 0
    assert found["cut: refused"] > 0


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", ["al3d-1.al3d", "sur-2.sur", "x3p-2.x3p"])
def test_broken_files_of_instruments(name: str, tmp_path: Path) -> None:
    found = try_broken(name, 100, tmp_path)
    print(name, dict(found))
    assert found["cut: refused"] > 0


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", [*MADE, *MORE])
def test_broken_files_of_five_megabytes(name: str, tmp_path: Path) -> None:
    """The command reads or refuses each in a sentence, within 10 s of the processor and 1 GiB."""
    content, options = content_of(name) if name.startswith("sur") else large(name)
    given = {"pixel": "1 um", "height_unit": "um"} if options else {}
    path = tmp_path / name
    ends = []
    for seed in [None, *numbers(12)]:
        path.write_bytes(content if seed is None else mutated_file(content, random.Random(seed)))
        ends.append(in_a_child(lambda: describe(path, given, as_json=True)))
    said, seconds, memory = zip(*ends, strict=True)
    assert said[0] == "", said[0]
    print(
        f"{name}: {len(content) / 1e6:.1f} MB, {sum(map(bool, said))} of {len(said) - 1} refused, at most "
        f"{max(seconds):.1f} s, {max(memory) / 2**20:.0f} MiB"
    )


class Harm:
    """What a pickle would execute."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __reduce__(self) -> tuple[Any, ...]:
        return Path.touch, (self.path,)


def test_nothing_in_a_file_is_executed_or_unpacked(tmp_path: Path) -> None:
    harm, inside = tmp_path / "harm", tmp_path / "inside"
    inside.mkdir()
    np.save(inside / "x.npy", np.array([[Harm(harm), 1.0], [2.0, 3.0]], dtype=object), allow_pickle=True)
    np.savez(inside / "x.npz", z=np.array([[Harm(harm), 1.0], [2.0, 3.0]], dtype=object))
    with zipfile.ZipFile(inside / "out.npz", "w") as archive:
        archive.writestr("../../harm.npy", saved(lambda f: np.save(f, np.ones((NX, NY)))))
    (inside / "code.txt").write_text(f"__import__('os').mkdir('{harm}') 1 2\n" * 5)
    for name in ("x.npy", "x.npz", "code.txt"):
        with pytest.raises(InputError) as error:
            read(inside / name, **GIVEN)
        check_sentence(error.value)
    assert read(inside / "out.npz", **GIVEN).heights.shape == (NX, NY)
    assert sorted(path.name for path in tmp_path.rglob("*")) == sorted(
        ["inside", "x.npy", "x.npz", "out.npz", "code.txt"]
    )
