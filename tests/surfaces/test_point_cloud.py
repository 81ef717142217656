"""Lists of points and matrices in text: every way they are written, and what is refused."""

import numpy as np
import pytest

from warpwear.errors import InputError
from warpwear.surfaces.point_cloud import gridded, units_in
from warpwear.surfaces.reading import read
from warpwear.surfaces.text import read_table

NX = 9  # points along x
NY = 7  # points along y
PX = 0.4  # µm
PY = 0.25  # µm
RNG = np.random.default_rng(0)
Z = np.round(RNG.normal(size=(NX, NY)), 4)
X, Y = np.meshgrid(PX * np.arange(NX), PY * np.arange(NY), indexing="ij")
POINTS = np.column_stack([X.ravel(), Y.ravel(), Z.ravel()])
GIVEN = {"pixel": (0.004, 0.0025), "height_unit": "um"}


def written(points, *, separator="\t", comma=False, header="", end="\n"):
    lines = [separator.join(f"{v:.4f}" for v in point) for point in points]
    text = end.join(lines) + end
    return header + (text.replace(".", ",") if comma else text)


@pytest.fixture
def save(tmp_path):
    def write(text, name="disc.xyz", encoding="utf-8"):
        (tmp_path / name).write_bytes(text.encode(encoding))
        return tmp_path / name

    return write


@pytest.mark.parametrize(
    ("separator", "comma"),
    [
        *(("\t", False), (" ", False), ("   ", False), (";", False), (",", False), (", ", False)),
        *(("\t", True), (" ", True), (";", True), ("; ", True)),
    ],
)
@pytest.mark.parametrize("shuffled", [False, True])
def test_separators_and_decimal_signs(save, separator, comma, shuffled):
    points = RNG.permutation(POINTS) if shuffled else POINTS
    reading = read(save(written(points, separator=separator, comma=comma)), **GIVEN)
    np.testing.assert_allclose(reading.heights, 1e-3 * Z, rtol=0, atol=1e-15)
    assert reading.format == "xyz"


@pytest.mark.parametrize(
    "header",
    [
        "X [µm]\tY [µm]\tZ [nm]\n",
        "x(um);y(um);z(nm)\n",
        "# exported by an instrument\n# X / µm, Y / µm, Z / nm\n",
        "X\tY\tZ\nµm\tµm\tnm\n",
        "Some title\nxy units: um\nz-unit: nm\n\n",
        "X in µm  Y in µm  Z in nm\n63\n",
    ],
)
def test_units_of_the_header(save, header):
    if header.startswith("Some"):
        header = header.replace("xy units: um", "x-unit: um\ny-unit: um")
    reading = read(save(written(POINTS, header=header)))
    assert reading.pixel == pytest.approx((4e-4, 2.5e-4))
    np.testing.assert_allclose(reading.heights, 1e-6 * Z, rtol=0, atol=1e-18)
    assert not reading.pixel_given
    assert not reading.unit_given


def test_one_unit_for_all_and_contradictions():
    assert units_in(["Unit: mm"]) == ("mm", "mm")
    assert units_in(["# units = µm"]) == ("µm", "µm")
    assert units_in(["x [mm] y [um] z [um]"]) == (None, "µm")
    assert units_in(["z [um]", "z [nm]"])[1] is None
    assert units_in(["a measurement of 5 mm steel, max 3 m/s"]) == (None, None)
    assert units_in([]) == (None, None)


def test_units_are_not_guessed(save):
    path = save(written(POINTS))
    with pytest.raises(InputError, match=r"disc\.height_unit is not given"):
        read(path)
    with pytest.raises(InputError, match=r"disc\.pixel is not given.*in a unit that it does not"):
        read(path, height_unit="um")
    with pytest.raises(InputError, match=r"disc\.pixel is not given"):
        read(save(written(POINTS, header="x [mm] y [um] z [um]\n")))


@pytest.mark.parametrize("line_end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
def test_line_ends_and_encodings(save, line_end, encoding):
    text = written(POINTS, header="title" + line_end, end=line_end)
    assert np.array_equal(read(save(text, encoding=encoding), **GIVEN).heights, 1e-3 * Z)


def test_holes_become_missing_points(save):
    kept = np.delete(POINTS, [8, 9, 30], axis=0)
    heights = read(save(written(kept)), **GIVEN).heights
    assert np.isnan(heights).sum() == 3
    assert np.isnan(heights.ravel()[[8, 9, 30]]).all()
    words = written(POINTS).splitlines()
    for line, word in ((3, "NaN"), (12, "***"), (20, "BAD")):
        words[line] = words[line].rsplit("\t", 1)[0] + "\t" + word
    missing = np.isnan(read(save("\n".join(words)), **GIVEN).heights).ravel()
    assert np.flatnonzero(missing).tolist() == [3, 12, 20]
    empty = [*words[:5], words[5].rsplit("\t", 1)[0] + "\t", *words[6:]]
    assert np.isnan(read(save("\n".join(empty)), **GIVEN).heights).sum() == 4


def test_a_map_with_a_third_missing(save):
    kept = POINTS[RNG.random(len(POINTS)) > 0.3]
    heights = read(save(written(RNG.permutation(kept))), **GIVEN).heights
    assert heights.shape == (NX, NY)
    assert np.isfinite(heights).sum() == len(kept)


def test_the_same_point_twice(save):
    reading = read(save(written(np.vstack([POINTS, POINTS[5:8]]))), **GIVEN)
    assert np.array_equal(reading.heights, 1e-3 * Z)
    assert reading.notes == ("3 repeated points dropped",)
    other = POINTS[5:6] + np.array([0.0, 0.0, 1.0])
    with pytest.raises(InputError, match=r"disc\.surface .*1 points that are given twice with different"):
        read(save(written(np.vstack([POINTS, other]))), **GIVEN)


def test_rounded_coordinates_are_a_grid_still(save):
    x, y = np.meshgrid(
        np.round(0.4383 * np.arange(60), 2), np.round(0.4383 * np.arange(50), 2), indexing="ij"
    )
    cloud = gridded(np.column_stack([x.ravel(), y.ravel(), np.arange(3000.0)]))
    assert cloud.heights.shape == (60, 50)
    assert cloud.pixel == pytest.approx((0.4383, 0.4383), rel=1e-3)


def test_more_columns_than_three(save):
    more = np.column_stack([POINTS, RNG.random((len(POINTS), 2))])
    reading = read(save(written(more)), **GIVEN)
    assert np.array_equal(reading.heights, 1e-3 * Z)
    assert "columns after the third ignored" in reading.notes[0]


def test_export_of_a_worn_body_reads_back(save):
    points = POINTS * [1e-3, 1e-3, 1e-3]
    reading = read(
        save("# x [mm]\ty [mm]\tz [mm]\n" + "\n".join("\t".join(f"{v:.9g}" for v in p) for p in points))
    )
    assert reading.pixel == pytest.approx((4e-4, 2.5e-4))
    np.testing.assert_allclose(reading.heights, 1e-3 * Z, atol=1e-12)


def turned(angle):
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    big = np.array([(0.3 * i, 0.3 * j, i * j) for i in range(40) for j in range(30)])
    return np.column_stack([c * big[:, 0] - s * big[:, 1], s * big[:, 0] + c * big[:, 1], big[:, 2]])


@pytest.mark.parametrize(
    ("text", "what"),
    [
        (written(turned(7.0)), "turned|not evenly spaced"),
        (written(RNG.random((400, 3))), "scattered|turned|not evenly spaced"),
        (written(POINTS[np.isin(POINTS[:, 1], [0.0])]), "line scan"),
        (written(POINTS * [1, 0, 1]), "line scan"),
        (written(np.column_stack([POINTS[:, 0] ** 2, POINTS[:, 1:]])), "not evenly spaced"),
        (written(POINTS[:20]) + written(POINTS[20:], separator=","), "mixed separators"),
        (written(POINTS).replace("\t", ",", 1), "mixed separators"),
        ("1.234,5;2.345,6;0,1\n" * 30, "mixed separators"),
        ("1.5 2,5 0.1\n" * 30, r"mixes decimal commas \(line 1\) and points \(line 1\)"),
        (written(POINTS[:20]) + written(POINTS[20:]).replace("\t", '\t"', 1), "line 21 holds"),
        (
            written(POINTS[:20]) + "1.0\t2.0\n" + written(POINTS[20:]),
            "line 21 has 2 .*line 1 has 3: ragged",
        ),
        (written(POINTS[:20]) + "1.0\ttwo\t3.0\n" + written(POINTS[20:]), "line 21 holds 'two'"),
        ("".join(f"{i},{j},{i * j},1\n" for i in range(9) for j in range(9)), "comma between all digits"),
        (written(POINTS[:, :2]), "no profile"),
        (written(POINTS[:3]), "fewer than four|line scan|not evenly"),
    ],
)
def test_what_is_no_map_is_refused_in_one_sentence(save, text, what):
    with pytest.raises(InputError, match=rf"disc\.surface .*disc\.xyz.*({what}).*allowed is") as caught:
        read(save(text), **GIVEN)
    assert "\n" not in str(caught.value)


def test_semicolons_on_some_lines_are_no_doubt(save):
    text = written(POINTS[:20]) + written(POINTS[20:], separator=";")
    assert np.array_equal(read(save(text), **GIVEN).heights, 1e-3 * Z)


def test_a_turned_grid_is_named():
    with pytest.raises(ValueError, match=r"turned"):
        gridded(turned(7.0))


def test_a_header_tells_commas_between_whole_numbers_apart(save):
    rows = "".join(f"{i},{j},{i * j},1\n" for i in range(9) for j in range(9))
    heights = read(save("x,y,z,valid\n" + rows), **GIVEN).heights
    assert np.array_equal(heights, 1e-3 * np.multiply.outer(np.arange(9.0), np.arange(9.0)))


def test_units_and_fields_as_other_programs_write_them(save):
    latin = read(save(written(POINTS, header="X [µm]\tY [µm]\tZ [nm]\n"), encoding="latin-1"))
    assert latin.pixel == pytest.approx((4e-4, 2.5e-4))
    quoted = "".join('"' + '","'.join(f"{v:.4f}" for v in point) + '"\n' for point in POINTS)
    assert np.array_equal(read(save(quoted), **GIVEN).heights, 1e-3 * Z)


@pytest.mark.parametrize("separator", ["\t", " ", ";", ","])
@pytest.mark.parametrize("comma", [False, True])
def test_matrices(save, separator, comma):
    if comma and separator == ",":
        pytest.skip("ambiguous, and refused")
    big = np.round(RNG.normal(size=(12, 11)), 3)
    reading = read(save(written(big, separator=separator, comma=comma), "disc.txt"), **GIVEN)
    np.testing.assert_allclose(reading.heights, 1e-3 * big.T, rtol=0, atol=1e-15)
    assert reading.format == "text"


def test_matrices_with_empty_fields_and_a_separator_at_each_end(save):
    text = "1;2;;4;5;6;7;8;\n;2;3;4;5;6;7;;\n1;2;3;4;5;6;7;8;\n"
    heights = read(save(text, "disc.csv"), **GIVEN).heights
    assert heights.shape == (8, 3)
    assert np.argwhere(np.isnan(heights)).tolist() == [[0, 1], [2, 0], [7, 1]]


def test_a_matrix_that_begins_with_missing_rows_keeps_them(save):
    text = "title\nNaN\tBAD\tNaN\tNaN\n***\tnan\tnull\tbad\n" + "1\t2\t3\t4\n" * 5
    heights = read(save(text, "disc.csv"), **GIVEN).heights
    assert heights.shape == (4, 7)
    assert np.isnan(heights[:, :2]).all()
    assert np.isfinite(heights[:, 2:]).all()


def test_sizes_in_the_header_of_a_matrix(save):
    pytest.importorskip("SurfaceTopography")
    big = np.round(RNG.normal(size=(10, 12)), 3)
    header = "# Channel: Height\n# Width: 24 µm\n# Height: 30 µm\n# Value units: nm\n"
    reading = read(save(written(big, header=header), "disc.txt"))
    assert reading.pixel == pytest.approx((0.002, 0.003))
    assert reading.heights.std() == pytest.approx(1e-6 * big.std(), rel=1e-3)


def test_npz(tmp_path):
    path = tmp_path / "disc.npz"
    np.savez(path, Z)
    assert np.array_equal(read(path, **GIVEN).heights, 1e-3 * Z)
    np.savez(path, heights=Z, mask=Z > 0)
    assert np.array_equal(read(path, **GIVEN).heights, 1e-3 * Z)
    np.savez(path, before=Z, after=2 * Z)
    assert np.array_equal(read(path, array="after", **GIVEN).heights, 2e-3 * Z)
    assert np.array_equal(read(path, array="1", **GIVEN).heights, 2e-3 * Z)
    for name in (None, "during"):
        with pytest.raises(InputError, match=r"a number or a name of: 0 \(before\), 1 \(after\)"):
            read(path, array=name, **GIVEN)
    np.savez(path, np.array([{"a": 1}], dtype=object))
    with pytest.raises(InputError, match=r"cannot be read as \.npz"):
        read(path, **GIVEN)
    path.write_bytes(b"PK and no more")
    with pytest.raises(InputError, match=r"cannot be read as \.npz"):
        read(path, **GIVEN)


def test_many_points_in_any_order_make_their_grid(tmp_path):
    path = tmp_path / "big.xyz"
    count = 300
    x, y = np.meshgrid(np.arange(count) * 0.438, np.arange(count) * 0.438, indexing="ij")
    z = RNG.normal(size=x.size)
    row = np.array([f"{a:.3f};{b:.3f};{c:.4f}" for a, b, c in zip(x.ravel(), y.ravel(), z, strict=True)])
    path.write_text("\n".join(RNG.permutation(row)).replace(".", ","))
    heights = gridded(read_table(path).numbers()).heights
    np.testing.assert_allclose(heights.ravel(), z, atol=6e-5)
