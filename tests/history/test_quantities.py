"""Quantities are declared once, and everything that is computed is declared."""

from collections.abc import Callable
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import warpwear
from warpwear import Study
from warpwear.history.end_values import ENDS, Summary
from warpwear.history.quantities import (
    AREAS,
    BY_NAME,
    FIELDS,
    LOOKS,
    ONLY,
    QUANTITIES,
    columns_of,
    per,
    printed,
)
from warpwear.history.rows import History, Rows
from warpwear.study.keys import declarations

SHORT: dict[str, tuple[str, dict[str, Any]]] = {
    "smooth": ("v1", {}),
    "bearing area": ("v3", {"grid.cell": "20 um"}),
    "rough": ("v3-fine", {"grid.cell": "20 um"}),
    "half-space": ("v3-fine", {"grid.cell": "20 um", "contact.law": "half-space"}),
    "patches": ("two-scale", {"grid.cell": "10 um"}),
    "patches of half-spaces": ("two-scale", {"grid.cell": "10 um", "contact.law": "half-space"}),
    "track": ("track", {"grid.cell": "20 um"}),
    "track that keeps its dents": ("track", {"grid.cell": "20 um", "sliding.plastic": "keep"}),
    "track of a half-space": ("track", {"grid.cell": "20 um", "contact.law": "half-space"}),
}


@pytest.mark.parametrize("case", SHORT)
def test_every_model_books_what_is_declared_of_it(case: str, watch: Callable[..., None]) -> None:
    preset, changes = SHORT[case]
    study = Study.load(preset).replace(changes | {"sliding.distance": "1 mm", "output.snapshots": []})
    seen: list[dict[str, float]] = []
    watch(Rows, "append", lambda _, row: seen.append(row))
    result = warpwear.run(study)
    booked = {column.name for column in columns_of(study)} - {"cof", "friction_energy"}
    assert seen
    declared = {quantity.name for quantity in per("step")}
    assert all(booked <= set(row) <= declared for row in seen)
    assert list(result.history) == [column.name for column in columns_of(study)]
    certified = {"violation", "energy_gap", "energy_gap_relative"} & booked  # now and then
    always = booked - certified - {"area_error"}  # that is measured on the way
    assert all(np.isfinite(result.history[name]).all() for name in always)
    assert all(np.isfinite(result.history[name][[0, -1]]).all() for name in certified)
    assert set(result.snapshot(-1).fields) == {n for n, field in FIELDS.items() if field.applies_to(study)}
    for quantity in per("patch"):
        assert hasattr(type(result), quantity.name)
        if quantity.applies_to(study):
            assert getattr(result, quantity.name).shape[0] == len(seen)
        else:
            with pytest.raises(warpwear.InputError, match="has no patches"):
                getattr(result, quantity.name)


def test_names_are_unique_and_units_the_same_under_one_name() -> None:
    for what in ("step", "patch", "cell", "snapshot"):
        names = [quantity.name for quantity in per(what)]  # type: ignore[arg-type]
        assert len(names) == len(set(names))
    units: dict[str, set[str]] = {}
    for quantity in QUANTITIES:
        units.setdefault(quantity.name, set()).add(quantity.units)
        assert quantity.meaning
        assert not quantity.meaning.endswith(".")
    assert all(len(of_one) == 1 for of_one in units.values())


def test_the_table_of_the_documentation() -> None:
    docs = Path(__file__).parents[2] / "docs"
    if not docs.is_dir():
        pytest.skip("no docs")
    spec = spec_from_file_location("make_quantities", docs / "make_quantities.py")
    assert spec is not None
    assert spec.loader is not None
    made = module_from_spec(spec)
    spec.loader.exec_module(made)
    table = made.markdown_table()
    assert len(table.splitlines()) == 2 + len(QUANTITIES)
    assert "| `cof` | 1 | step |  | coefficient of friction" in table
    assert {line.count("|") for line in table.splitlines()} == {6}
    assert table in (docs / "reference" / "results.md").read_text(encoding="utf-8"), (
        "run: python docs/make_quantities.py"
    )


def test_what_people_see_is_declared_of_quantities_that_there_are() -> None:
    assert {*LOOKS} <= {*BY_NAME}
    only = {quantity.only for quantity in QUANTITIES}
    assert only >= {None, *ONLY} - {"rest"}  # what all runs have
    assert only <= {None, *ONLY, *declarations(Study)}
    assert [BY_NAME[name].short for name in AREAS][:2] == ["in contact", "at hardness"]
    volume = BY_NAME["wear_volume_disc"]
    assert volume.axis == "worn volume of the disc, 10⁻³ mm³"
    assert volume.family_axis == "worn volume, 10⁻³ mm³"
    assert_array_equal(volume.scaled(np.array([0.002])), [2.0])
    assert BY_NAME["cof"].axis == "coefficient of friction, –"
    assert [printed(unit) for unit in ("1", "um", "mm^2", "mm^3/N/m")] == ["", "µm", "mm²", "mm³/(N·m)"]
    families: dict[str, set[tuple[str, float]]] = {}
    for quantity in QUANTITIES:
        families.setdefault(quantity.family, set()).add((quantity.unit, quantity.factor))
    del families[""]
    assert all(len(scales) == 1 for scales in families.values())  # they share an axis


def test_end_values_stand_in_the_summary() -> None:
    """Of a run of patches, which has all of them."""
    study = Study.load("two-scale").replace({"grid.cell": "10 um", "sliding.distance": "1 mm"})
    summary = warpwear.run(study.replace({"friction.calibrate": "end"})).summary
    ends = Summary.of(summary)
    assert not [name for name in ENDS if getattr(ends, name) is None]
    assert ends.volume_disc == summary["volume_mm3"]["disc"]
    assert Summary.of({}).volume_disc is None


def test_a_history_knows_the_units_of_its_layers() -> None:
    columns = columns_of(Study.load("coat"))
    shown = repr(History({column.name: np.zeros(2) for column in columns}))
    assert all(f"{column.name} [{column.units}]" in shown for column in columns)
    assert "wear_volume_disc_dlc [mm^3]" in shown
    assert repr(History({"of others": np.zeros(1)})).endswith("of others [?]>")
