"""What a study says against its file is told, never silent."""

from pathlib import Path

import numpy as np
import pytest

from warpwear.surfaces.measured import read_measured

X = np.linspace(-0.01, 0.01, 5)


def text_file(path: Path) -> Path:
    x, y = np.meshgrid(np.arange(40) * 1.0, np.arange(30) * 1.0, indexing="ij")
    z = 0.1 * np.sin(x / 5.0) + 0.05 * np.cos(y / 3.0)
    table = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    np.savetxt(path, table, header="x [um]\ty [um]\tz [um]", delimiter="\t")
    return path


def test_an_override_is_told_with_both_values(tmp_path: Path) -> None:
    path = text_file(tmp_path / "disc.xyz")
    told = read_measured(path, pixel=(2e-3, 2e-3), height_unit="nm").notices(X, X)
    assert any("disc.height_unit = nm overrides the unit that the file states, µm" in t for t in told)
    assert any("disc.pixel = 2 × 2 µm overrides the pixel that the file states, 1 × 1 µm" in t for t in told)


def test_the_same_value_is_no_override(tmp_path: Path) -> None:
    path = text_file(tmp_path / "disc.xyz")
    for surface in (read_measured(path), read_measured(path, pixel=(1e-3, 1e-3), height_unit="µm")):
        assert not [t for t in surface.notices(X, X) if "overrides" in t]


@pytest.mark.parametrize(("extend", "expected"), [("mirror", "mirrored: 2.5 × 3.3 copies"), ("refuse", None)])
def test_copies_are_counted(tmp_path: Path, extend: str, expected: str | None) -> None:
    surface = read_measured(text_file(tmp_path / "disc.xyz"), extend=extend)
    wide = np.linspace(-0.05, 0.05, 101)
    told = [t for t in surface.notices(wide, wide) if "copies" in t]
    assert told == [] if expected is None else expected in told[0]
