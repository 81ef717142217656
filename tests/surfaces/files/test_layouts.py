"""Files whose layout is read here, and files that declare more than they hold."""

import gzip
import struct
from pathlib import Path

import numpy as np
import pytest
from fuzzing import check_sentence, little_memory, watched

from warpwear.errors import InputError
from warpwear.surfaces.files.layouts import check_wave
from warpwear.surfaces.reading import read

#: Heights along x and y [µm], without a symmetry that would hide a wrong axis.
HEIGHTS = np.round(np.random.default_rng(4).normal(size=(9, 7)), 2)
GIVEN = {"pixel": 1e-3, "height_unit": "um"}


def refusal(path: Path, **options: object) -> str:
    with pytest.raises(InputError) as error:
        read(path, **options)
    check_sentence(error.value)
    return str(error.value)


@pytest.mark.parametrize("word", [b"TrueMap", b"Truemap"])
@pytest.mark.parametrize("comment", [b"", b"Created by TrueMap v6\r\n", b"a longer comment of another one"])
def test_tmd(tmp_path: Path, word: bytes, comment: bytes) -> None:
    pytest.importorskip("SurfaceTopography")
    path = tmp_path / "disc.tmd"
    start = (b"Binary %b Data File v2.0\r\n" % word).ljust(32, b"\0") + comment + b"\0"
    sizes = struct.pack("<2I4f", 9, 7, 9 * 2e-3, 7 * 3e-3, 0.0, 0.0)
    path.write_bytes(start + sizes + (1e-3 * HEIGHTS).T.astype("<f4").tobytes())
    reading = read(path)
    np.testing.assert_allclose(reading.heights, 1e-3 * HEIGHTS, rtol=1e-6)
    assert reading.pixel == pytest.approx((2e-3, 3e-3))
    path.write_bytes(path.read_bytes()[:-4])
    assert "cannot be read as a surface (The file ended after" in refusal(path)


def test_nms(tmp_path: Path) -> None:
    """A file of NanoFocus is known by its ending alone: its layout fits others, too."""
    pytest.importorskip("SurfaceTopography")
    low, high = HEIGHTS.min(), HEIGHTS.max()
    header = bytearray(3468)
    struct.pack_into("<2d", header, 16, low, high)
    struct.pack_into("<2I2d", header, 1368, 9, 7, 2e-3, 3e-3)
    counts = np.rint((HEIGHTS - low) / (high - low) * (2**16 - 2)).T.astype("<u2")
    (tmp_path / "disc.nms").write_bytes(bytes(header) + counts.tobytes())
    reading = read(tmp_path / "disc.nms", height_unit="um")
    np.testing.assert_allclose(reading.heights, 1e-3 * HEIGHTS, atol=1e-7)
    assert reading.pixel == pytest.approx((2e-3, 3e-3))
    for other in (b"NMS2" + bytes(9999), np.random.default_rng(0).bytes(9999), b"<map>" * 999):
        (tmp_path / "other.nms").write_bytes(other)
        assert "no reader knows the format" in refusal(tmp_path / "other.nms", height_unit="um")


@pytest.mark.parametrize(
    ("words", "sign"),
    [
        (("Channel", "Width", "Height", "Value units"), "."),
        (("Kanal", "Breite", "Höhe", "Werteinheiten"), ","),
    ],
)
def test_text_of_gwyddion(tmp_path: Path, words: tuple[str, ...], sign: str) -> None:
    path = tmp_path / "disc.txt"
    values = ("Topography", "18.0 µm", "21.0 µm", "m")
    header = "".join(f"# {word}: {v.replace('.', sign)}\n" for word, v in zip(words, values, strict=True))
    rows = "\n".join("\t".join(f"{1e-6 * v:.6e}" for v in row) for row in HEIGHTS.T) + "\n"
    path.write_text(header + rows.replace(".", sign), encoding="utf-8")
    reading = read(path)
    np.testing.assert_allclose(reading.heights, 1e-3 * HEIGHTS, atol=1e-9)
    assert reading.pixel == pytest.approx((2e-3, 3e-3))
    assert not reading.unit_given


def test_packed_files(tmp_path: Path) -> None:
    path = tmp_path / "disc.txt.gz"
    plain = "\n".join(" ".join(f"{v:.2f}" for v in row) for row in HEIGHTS.T) + "\n"
    path.write_bytes(gzip.compress(plain.encode()))
    np.testing.assert_allclose(read(path, **GIVEN).heights, 1e-3 * HEIGHTS)
    path.write_bytes(gzip.compress(path.read_bytes()))
    assert "a packed file in a packed one" in refusal(path, **GIVEN)
    path.write_bytes(gzip.compress(bytes(10**8)))
    assert "of a .gz" in refusal(path, **GIVEN)
    path.write_bytes(gzip.compress(plain.encode())[:-9])
    assert "cannot be read as .gz" in refusal(path, **GIVEN)


def test_profiles_and_columns_are_named(tmp_path: Path) -> None:
    path = tmp_path / "profile.csv"
    rows = "\n".join(f"{0.5 * i},{h}" for i, h in enumerate(HEIGHTS.ravel()))
    path.write_text(f"Dektak\nScan Length,31.5\nLateral (µm),Raw (Å)\n{rows}\n")
    assert "holds a profile (line scan) of 63 points, and no map" in refusal(path, **GIVEN)
    path.write_text("\n".join(map(str, HEIGHTS.ravel())) + "\n")
    assert "holds a profile (line scan) of 63 points, and no map of heights" in refusal(path, **GIVEN)
    scans = "".join(f",Scan {k} (Å)" for k in range(7))
    rows = "\n".join(",".join(map(str, (0.5 * i, *line))) for i, line in enumerate(HEIGHTS))
    path.write_text(f"Dektak\nScan Type,Map\nLateral (µm){scans}\n{rows}\n")
    assert "several named columns: disc.array gives a number or a name of: 0 (Lat" in refusal(path, **GIVEN)


def test_small_files_do_not_fill_the_memory(tmp_path: Path) -> None:
    packed, wave = tmp_path / "disc.npz", tmp_path / "disc.ibw"
    np.savez_compressed(packed, heights=np.zeros((6000, 3000)))
    assert packed.stat().st_size < 300_000
    block = bytearray(64 + 320 + 4 * 4)
    struct.pack_into("<h", block, 0, 5)
    struct.pack_into("<4i", block, 64 + 68, 2, 2, 20_000_000, 0)
    wave.write_bytes(block)
    with little_memory(), watched():
        assert "bytes of heights.npy in" in refusal(packed, **GIVEN)
        with pytest.raises(ValueError, match=r"2 × 2 × 20000000 × 0 points in 400 bytes"):
            check_wave(wave)
