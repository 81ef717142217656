"""Files that hold several channels, blocks or columns: what was read is named, and what else is there."""

import struct
from pathlib import Path

import numpy as np
import pytest
from fuzzing import check_sentence

from warpwear.errors import InputError
from warpwear.measured.surface import read_profile, read_surface
from warpwear.surfaces.reading import HoldsAProfile, read

#: Heights along x and y [µm], without a symmetry that would hide a wrong axis.
HEIGHTS = np.round(np.random.default_rng(4).normal(size=(60, 70)), 2)


def part(name: str, kind: str, content: bytes) -> bytes:
    return name.encode() + b"\0" + kind.encode() + content


def thing(name: str, *parts: bytes) -> bytes:
    return name.encode() + b"\0" + struct.pack("<I", len(b"".join(parts))) + b"".join(parts)


def field(values: np.ndarray, unit: str | None) -> bytes:
    """A field of Gwyddion: values of shape (nx, ny), pixel 2 × 3 µm, in a unit, None for none of any kind."""
    nx, ny = values.shape
    units = [part(f"si_unit_{axes}", "o", thing("GwySIUnit", part("unitstr", "s", of.encode() + b"\0")))
             for axes, of in (("xy", "m"), ("z", unit)) if of is not None and unit is not None]  # fmt: skip
    array = struct.pack("<I", nx * ny) + values.T.astype("<f8").tobytes()
    sizes = [part(f"{axis}res", "i", struct.pack("<i", n)) for axis, n in zip("xy", (nx, ny), strict=True)]
    reals = [
        part(f"{axis}real", "d", struct.pack("<d", d)) for axis, d in (("x", nx * 2e-6), ("y", ny * 3e-6))
    ]
    return thing("GwyDataField", *sizes, *reals, *units, part("data", "D", array))


def gwy(path: Path, *channels: tuple[str, np.ndarray, str | None], mask: np.ndarray | None = None) -> None:
    parts = [part("/filename", "s", b"disc\0"), part("/0/show", "b", b"\1")]
    for number, (title, values, unit) in enumerate(channels):
        parts.append(part(f"/{number}/data", "o", field(values, unit)))
        parts.append(part(f"/{number}/data/title", "s", title.encode() + b"\0"))
    if mask is not None:
        parts.append(part("/0/mask", "o", field(mask.astype(float), "m")))
    path.write_bytes(b"GWYP" + thing("GwyContainer", *parts))


def refusal(path: Path, **options: object) -> str:
    with pytest.raises(InputError) as error:
        read(path, **options)
    check_sentence(error.value)
    return str(error.value)


def test_a_channel_of_gwyddion_is_named_and_chosen(tmp_path: Path) -> None:
    path = tmp_path / "disc.gwy"
    gwy(path, ("Amplitude", 2e-6 * HEIGHTS, "m"), ("Height", 1e-6 * HEIGHTS, "m"), ("Phase", HEIGHTS, "deg"))
    first = read(path)
    assert first.notes == ("channel 0 (Amplitude) of the file; others: 1 (Height), Phase in deg",)
    np.testing.assert_allclose(first.heights, 2e-3 * HEIGHTS)
    assert first.pixel == pytest.approx((2e-3, 3e-3))
    for chosen in ("1", "Height"):
        np.testing.assert_allclose(read(path, array=chosen).heights, 1e-3 * HEIGHTS)
    assert (
        "no channel 'nonsense': disc.array gives a number or a name of: 0 (Amplitude), 1 (Height)"
        in refusal(path, array="nonsense")
    )
    assert "channel 1 (Height) of the file" in read_surface(path, array="Height").text
    path.write_bytes(path.read_bytes()[:-400])
    assert "it is cut short" in refusal(path)


def test_a_mask_of_gwyddion_is_told(tmp_path: Path) -> None:
    mask = np.zeros(HEIGHTS.shape, dtype=bool)
    mask[3:5, 7] = True
    gwy(tmp_path / "disc.gwy", ("", 1e-6 * HEIGHTS, "m"), mask=mask)
    found = read(tmp_path / "disc.gwy")
    np.testing.assert_array_equal(np.isnan(found.heights), mask)
    assert "2 points under the file's mask taken as missing: it may mark grains as well" in found.notes


def test_gwyddion_without_units_needs_the_keys_that_decide(tmp_path: Path) -> None:
    path = tmp_path / "disc.gwy"
    gwy(path, ("Topography", HEIGHTS, None))
    assert "names no unit of its heights; its points are 2e-06 × 3e-06 apart, in a unit that it" in refusal(
        path
    )
    assert "its points are 2e-06 × 3e-06 apart" in refusal(path, height_unit="um")
    found = read(path, height_unit="um", pixel=(2e-3, 3e-3))
    np.testing.assert_allclose(found.heights, 1e-3 * HEIGHTS)
    assert (found.unit_given, found.pixel_given) == (True, True)


@pytest.mark.parametrize("name", ["disc.npy", "disc.txt", "disc.xyz"])
def test_a_choice_that_cannot_be_obeyed_is_refused(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    x, y = np.indices(HEIGHTS.shape)
    if name == "disc.npy":
        np.save(path, HEIGHTS)
    else:
        np.savetxt(
            path, HEIGHTS.T if name == "disc.txt" else np.stack([x.ravel(), y.ravel(), HEIGHTS.ravel()], 1)
        )
    given = {"pixel": 1e-3, "height_unit": "um"}
    assert read(path, **given).heights.shape == HEIGHTS.shape
    assert "disc.array = 'Height' chooses among several, and" in refusal(path, array="Height", **given)


def wyko(path: Path, *about: str, flag: int = 0, others: bool = False) -> None:
    nx, ny = HEIGHTS.shape
    lines = [f"Wyko ASCII Data File Format 0\t{flag}\t1", f"X Size\t{nx}", f"Y Size\t{ny}", *about]
    lines += ["Aspect\t7\t4\t1.5", "Pixel_size\t7\t4\t0.002", "RAW_DATA\t3\t1\t"]
    rows = ["\t".join(f"{v:.2f}" for v in row[::-1]) for row in HEIGHTS]
    rows[2] = rows[2].replace(f"{HEIGHTS[2, -1]:.2f}", "Bad", 1)
    lines += rows
    if others:
        lines += ["Intensity\t3\t1\t", *["\t".join(["7"] * 3)] * 4]
    path.write_text("\n".join(lines) + "\n")


@pytest.mark.parametrize(
    ("about", "factor"),
    [(("Mult\t7\t4\t2",), 0.5), (("Mult\t6\t2\t4",), 0.25), ((), 1.0)],
    ids=["two", "other type", "none"],
)
def test_heights_of_wyko_are_in_waves(tmp_path: Path, about: tuple[str, ...], factor: float) -> None:
    """As Gwyddion reads them: a line has one x, its last value the lowest y; Mult may be left out."""
    path = tmp_path / "disc.ASC"
    wyko(path, "Wavelength\t7\t4\t632.8", *about, others=True)
    found = read(path)
    expected = 632.8e-6 * factor * HEIGHTS
    expected[2, -1] = np.nan
    np.testing.assert_allclose(found.heights, expected)
    assert found.pixel == pytest.approx((2e-3, 3e-3))
    assert found.notes == ("block RAW_DATA of the file; others: Intensity",)
    wyko(path, flag=1)
    np.testing.assert_allclose(
        np.nanstd(read(path).heights), 1e-6 * np.nanstd(expected / (632.8e-6 * factor))
    )


def test_wyko_without_a_wavelength_says_no_unit(tmp_path: Path) -> None:
    wyko(tmp_path / "disc.ASC")
    assert "names no unit of its heights" in refusal(tmp_path / "disc.ASC")
    wyko(tmp_path / "disc.ASC", "Wavelength\t7\t4\t632.8")
    text = (tmp_path / "disc.ASC").read_text().splitlines()
    (tmp_path / "disc.ASC").write_text("\n".join(text[:-3]))
    assert "its block of heights is not one of 60 lines of 70 numbers" in refusal(tmp_path / "disc.ASC")


@pytest.mark.parametrize("place", ["", "Lateral [um]"])
def test_a_table_of_named_columns_is_profiles(tmp_path: Path, place: str) -> None:
    path = tmp_path / "stylus.txt"
    heights = np.round(np.random.default_rng(1).normal(size=(200, 3)), 3)
    rows = ["\t".join(map(str, (0.5 * (k + 1), *row))) for k, row in enumerate(heights)]
    path.write_text("\n".join(["Points\t200", f"{place}\tRaw\tRough [nm]\tWavi", "", *rows]) + "\n")
    assert "holds several named columns: disc.array gives a number or a name of: " in refusal(path)
    assert "1 (Raw), 2 (Rough [nm]), 3 (Wavi)" in refusal(path)
    how = {"array": "Rough [nm]"} | ({} if place else {"pixel": 1e-3})
    with pytest.raises(HoldsAProfile):
        read(path, **how)
    profile = read_profile(path, **how)
    np.testing.assert_allclose(profile.profile.heights, 1e-6 * heights[:, 1])
    assert profile.profile.spacing == pytest.approx(0.5e-3 if place else 1e-3)
    assert "column 2 (Rough [nm]) of the file" in profile.text
