"""Two-scale studies: what is kept of a run, and what is refused or told in one sentence."""

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from cases_two_scale import of_kind, quick
from numpy.testing import assert_allclose

import warpwear
from warpwear import InputError, Result, Study
from warpwear.runs.order import RunOrder


def test_the_hdf5_file_has_the_patches(tmp_path: Path) -> None:
    warpwear.run(
        of_kind("some of the area").replace({"sliding.distance": "3 mm"}), out=tmp_path / "run", plots=False
    ).close()
    with h5py.File(tmp_path / "run" / "result.h5") as file, Result.open(tmp_path / "run") as result:
        steps = file["history/distance"].size
        assert file["history/load_share"].shape == file["history/area_patch"].shape == (steps, 36)
        assert file["history/load_share"].attrs["units"] == "N"
        assert_allclose(file["macro/x"][()], np.linspace(-0.75, 0.75, 6))
        assert all(values.ndim == 1 for values in result.history.values())
        last = result.snapshot(-1)
        covered = np.isfinite(last.gap)
        assert covered.mean() == pytest.approx(1.0 / 9.0)
        assert not last.pressure[~covered].any()
        weighted = 9.0 * last.pressure.sum() * 1e-4
        assert weighted == pytest.approx(8.0, rel=1e-12)
    one_scale = quick(study__model="micro", sliding__distance="0.03 mm", output__snapshots=[])
    with warpwear.run(one_scale) as one, pytest.raises(InputError, match="has no patches"):
        _ = one.load_share


BAD = [
    (
        {"patches.macro_cell": "55 um"},
        r"patches\.macro_cell = 55 µm is not a whole number of cells of 10 µm.*60 µm",
    ),
    ({"patches.width": "33 um"}, r"patches\.width = 33 µm is not a whole number of cells"),
    (
        {"patches.width": "70 um"},
        r"patches\.width = 70 µm is larger than patches\.macro_cell = 50 µm: .*overlap",
    ),
    (
        {"patches.macro_cell": "1.5 mm", "patches.width": None},
        r"patches\.macro_cell = 1500 µm is larger than the contact",
    ),
    (
        {"patches.macro_cell": "70 um", "patches.width": None},
        r"grid\.extent = 1\.5 mm is not a whole number of cells of patches\.macro_cell = 70 µm; .* 1\.47 mm",
    ),
    ({"stepping.scheme": "explicit"}, r"'two-scale' needs patches that yield"),
    ({"sliding.distance": "0 mm"}, r"'two-scale' needs patches that yield"),
    ({"wear.distance_factor": "radial"}, r"wear\.distance_factor = 'radial'"),
    (
        {"wear.law": "running-in", "wear.running_in": "1 mm", "wear.initial_disc": "1 mm^3/N/m"},
        r"wear\.law = 'running-in'",
    ),
    (
        {"wear.law": "bearing-curve"},
        r"^wear\.law = 'bearing-curve' needs study\.model = 'macro', not 'two-scale': .* resolve",
    ),
    ({"contact.hardness": "inf MPa", "patches.coupling": "load"}, r"'load' needs a finite contact\.hardness"),
    (
        {"patches.coupling": "load", "stepping.scheme": "explicit", "contact.stiffness": "1e4 N/mm^3"},
        r"'load' needs stepping\.scheme = 'implicit'",
    ),
    ({"disc.material": None}, r"contact\.bulk_stiffness = 'area' needs Young's modulus"),
    ({"patches.bulk": "perhaps"}, r"patches\.bulk = 'perhaps'"),
    ({"patches.placement": "corner"}, r"patches\.placement = 'corner'"),
]


@pytest.mark.parametrize(("changes", "message"), BAD)
def test_bad_input_is_one_sentence(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        quick().replace(changes)
    assert "\n" not in str(caught.value)


def test_a_patch_narrower_than_the_roughness_cannot_stand_for_more() -> None:
    narrow = {"grid.extent": "1.8 mm", "patches.macro_cell": "150 um", "patches.width": "50 um"}
    with pytest.raises(
        InputError, match=r"patches\.width = 50 µm is narrower than the roll-off .*about 10\d\.\d"
    ):
        warpwear.run(quick().replace(narrow))


def test_loads_that_are_prescribed_need_macro_cells_wholly_under_the_counter() -> None:
    study = quick(patches__coupling="load", counter__radius="0.2 mm", contact__hardness="100 MPa")
    study = study.replace({"contact.load": "12 N"})  # all of the counter-body would carry 12.6 N
    with pytest.raises(InputError, match=r"contact\.load = 12 N is more than the \d+ macro cells that lie"):
        warpwear.run(study)


def test_patches_are_as_wide_as_the_macro_cell_that_is_set() -> None:
    """In the preset nobody says how wide: a refusal would blame patches.width, which was not set."""
    changed = Study.load("two-scale").replace({"patches.macro_cell": "30 um"})
    assert changed.patches.patch_width == changed.patches.macro_cell
    assert not changed.samples_area
    assert 'width = "30 um" ' in changed.to_toml(marked=True)
    assert "width" not in tomllib.loads(changed.to_toml())["patches"]


def test_a_macro_cell_wider_than_the_contact_shares_no_load() -> None:
    wide = {"patches.macro_cell": "0.75 mm", "patches.width": None, "sliding.distance": "0.3 mm"}
    with pytest.raises(
        InputError, match=r"patches\.macro_cell = 750 µm is larger than the contact, .* 6\d\d µm wide"
    ):
        warpwear.run(quick().replace(wide))


def test_a_contact_that_outgrows_the_macro_grid_stops_the_run() -> None:
    with pytest.raises(InputError, match=r"grid\.extent = 0\.5 mm is too small: the contact reached"):
        warpwear.run(quick(grid__extent="0.5 mm", sliding__distance="40 mm"))
    some = {"grid.extent": "0.9 mm", "patches.macro_cell": "300 um", "patches.width": "100 um"}
    with pytest.raises(InputError, match=r"the contact reached the domain's edge"):
        warpwear.run(quick(sliding__distance="100 mm").replace(some))


def test_a_history_of_patches_that_memory_does_not_hold(host_with: Callable[[float], None]) -> None:
    """Two tables of steps × patches, and both again for a checkpoint; beside six fields of their cells."""
    study = Study.load("two-scale").replace({"patches.macro_cell": "2 um"})
    cells = study.patch_layout.grid.cells
    tables, fields = 4 * 8 * 1099 * 750**2, 6 * 8 * cells
    refused = (
        r"patches\.macro_cell = 2 µm makes 562500 patches, .* 1099 steps, which need .* a larger "
        r"patches\.macro_cell"
    )
    host_with(tables + fields - 1)
    with pytest.raises(InputError, match=refused):
        warpwear.run(study)
    host_with(tables + fields)
    order = RunOrder(study)
    with order.arrangement.executor(study, device="cpu", threads=1) as executor:
        assert executor.grid.cells == cells


def test_keys_without_a_use_are_told() -> None:
    assert quick().notices() == []
    micro = quick(study__model="micro")
    assert any("patches.macro_cell" in notice and "no patches" in notice for notice in micro.notices())
    load = quick(patches__coupling="load", patches__bulk="none")
    assert any(notice.startswith("patches.bulk does not apply") for notice in load.notices())
    assert "patches" not in tomllib.loads(micro.to_toml())
