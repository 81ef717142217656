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

import io
import random
import resource
import tempfile
import zipfile
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from cases_instruments import metropro, opd
from fuzzing import check_sentence, mutated_bytes, numbers, watched

from warpwear.errors import InputError
from warpwear.measured.surface_command import SurfaceOptions, describe
from warpwear.surfaces.measured import read_measured
from warpwear.surfaces.reading import Reading, read

REAL = Path(__file__).resolve().parents[3] / "shared" / "surfaces"
NX = 24  # points along x
NY = 18  # points along y
GIVEN: dict[str, Any] = {"pixel": 1e-3, "height_unit": "um"}
#: Whose content is covered by checksums.
SUMMED = (".npz", ".x3p")
#: Whose every value says where it belongs.
PLACED = ("points.xyz",)


def heights_of(seed: int = 5) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(NX, NY)).round(4)


def matrix(separator: str = " ", comma: bool = False) -> bytes:
    text = "\n".join(separator.join(f"{v:.4f}" for v in row) for row in heights_of().T) + "\n"
    return (text.replace(".", ",") if comma else text).encode()


def points() -> bytes:
    lines = [f"{i:d}.0 {j:d}.0 {v:.4f}" for (i, j), v in np.ndenumerate(heights_of())]
    return ("# x [um] y [um] z [um]\n" + "\n".join(lines) + "\n").encode()


def saved(save: Any) -> bytes:
    file = io.BytesIO()
    save(file)
    return file.getvalue()


def hdf5(file: Any) -> None:
    with h5py.File(file, "w") as content:
        content.create_dataset("heights", data=heights_of(), compression="gzip", fletcher32=True)


def opd_of(path: Path) -> None:
    opd(path, (heights_of() / 0.6).astype("<f4"), wavelength=600.0, multiplier=None)


def made_by(make: Callable[[Path], None]) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        make(Path(folder) / "x")
        return (Path(folder) / "x").read_bytes()


#: Name -> content, and what has to be given to read it.
MADE: dict[str, tuple[bytes, dict[str, Any]]] = {
    "x.npy": (saved(lambda f: np.save(f, heights_of())), GIVEN),
    "x.npz": (saved(lambda f: np.savez_compressed(f, z=heights_of(), other=np.zeros(3))), GIVEN),
    "blanks.txt": (matrix(), GIVEN),
    "semicolons.csv": (b"heights\n" + matrix(";", comma=True), GIVEN),
    "points.xyz": (points(), {}),
    "x.h5": (saved(hdf5), GIVEN),
    "x.opd": (made_by(opd_of), {}),
    "x.dat": (made_by(lambda path: metropro(path, 1e-6 * heights_of())), {}),
}
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
                assert describe(path, SurfaceOptions(as_json=True, preparation=given)).startswith("{")
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
        archive.writestr("../../harm.npy", saved(lambda f: np.save(f, heights_of())))
    (inside / "code.txt").write_text(f"__import__('os').mkdir('{harm}') 1 2\n" * 5)
    for name in ("x.npy", "x.npz", "code.txt"):
        with pytest.raises(InputError) as error:
            read(inside / name, **GIVEN)
        check_sentence(error.value)
    assert read(inside / "out.npz", **GIVEN).heights.shape == (NX, NY)
    assert sorted(path.name for path in tmp_path.rglob("*")) == sorted(
        ["inside", "x.npy", "x.npz", "out.npz", "code.txt"]
    )
