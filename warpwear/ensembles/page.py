"""What pages of several runs share: the answers of groups beside each other, and links to runs."""

import os
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

from warpwear.ensembles.ensemble import Ensemble, EnsembleRow, Group, M
from warpwear.history.end_values import ENDS, Value
from warpwear.history.quantities import Quantity
from warpwear.results import manifest
from warpwear.results.ensemble import band_name
from warpwear.results.report import shown

#: End values that answer what runs beside each other are asked.
ANSWERS = (
    *("patch_along", "patch_across", "area_contact", "pressure_mean"),
    *("volume_counter", "volume_disc", "cof", "shear_strength"),
)
#: Smaller numbers are shown as 0, and smaller relative differences as none: they are round-off.
ROUND_OFF, ALIKE = 1.0e-12, 5e-4


def known_answers(groups: Sequence[Group[EnsembleRow]]) -> list[Quantity]:
    """List the answers of which any group has a number."""
    return [ENDS[name] for name in ANSWERS if any(isinstance(g.mean(name), int | float) for g in groups)]


def titled(quantity: Quantity) -> str:
    """Name an end value with its unit at the head of a table."""
    return f"{quantity.label}, {quantity.unit}".removesuffix(", ")


def answers_of(ensemble: Ensemble[M], inputs: Collection[str] = ()) -> dict[str, Any]:
    """Return names and rows of the table of answers: value, scatter and difference to the first of each.

    inputs: names of groups of which the coefficient of friction at the end is an input.
    """
    groups = ensemble.all_groups
    rows: list[tuple[str, list[dict[str, Any]]]] = []
    if ensemble.has_bands:
        rows.append(("runs", [{"text": shown(group.count)} for group in groups]))
    for quantity in known_answers(groups):
        name, first, cells = quantity.name, None, []
        for group in groups:
            value, text = group.mean(name), with_scatter(group, quantity)
            notes = [than(value, first)]
            first = value if first is None else first
            if "±" in text:
                low, high = (quantity.factor * end for end in group.band(name)[1:])
                notes.append(f"{band_name(len(group.numbers(name)))}: {low:.4g} to {high:.4g}")
            is_input = name == "cof" and value is not None and group.name in inputs
            cells.append({"text": text, "notes": [*filter(None, notes)], "is_input": is_input})
        rows.append((titled(quantity), cells))
    names = [f"{g.name} (measured)" if g.kind == "experiment" else g.name for g in groups]
    return {"names": names, "rows": rows}


def with_scatter(group: Group[EnsembleRow], quantity: Quantity) -> str:
    """Write an end value for people with its standard deviation; round-off is 0, and no deviation."""
    value, deviation = group.mean(quantity.name), group.deviation(quantity.name)
    if not isinstance(value, float):
        return shown(value)
    text = "0" if abs(value) <= ROUND_OFF else shown(quantity.factor * value)
    if deviation is not None and deviation > 1e-9 * abs(value):
        return f"{text} ± {quantity.factor * deviation:.2g}"
    return text


def than(value: Value, first: Value) -> str:
    """Say how a value differs from the first."""
    if not isinstance(value, int | float) or not isinstance(first, int | float) or not first:
        return ""
    part = value / first - 1.0
    if abs(part) < ALIKE:
        return "the same"
    return f"{100.0 * part:+.3g} %".replace("-", "−") if abs(part) < 1.0 else f"× {value / first:.3g}"


def link_to(run: Path, folder: Path) -> str:
    """Link a run from a page in a folder: to its own page, where it has one, else to its folder."""
    page = run / manifest.PAGE
    # Not of pathlib, whose questions raise where they must not look.
    target = page if os.path.isfile(page) else run
    if not target.is_relative_to(folder):  # what is inside may be a link, which is followed by whoever reads
        target, folder = target.resolve(), folder.resolve()
    return quote(os.fsencode(os.path.relpath(target, folder)))  # also of names that no text can have
