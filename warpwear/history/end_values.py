"""A run comes to these numbers, as quantities: tables of several runs and the tops of pages show them."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from warpwear.history.quantities import BY_NAME, Quantity
from warpwear.study.keys import value_of

Value = str | int | float | None


def _new(name: str, units: str, label: str, entry: str = "") -> Quantity:
    return Quantity(name, units, f"{label} of a run", label=label, entry=entry)


def _last(column: str, entry: str, **changes: Any) -> Quantity:
    """Declare the last value of a column of the history, of a swept run the mean of the last cycle."""
    return replace(BY_NAME[column], entry=entry, **changes)


#: End values in the order of tables.
END_VALUES = (
    _last("distance", "distance_mm"),
    _last("load", "load_N", label="load"),
    _new("cell", "um", "cell", "cell_um"),
    _new("macro_cell", "um", "patches.macro_cell", "patches.macro_cell_um"),
    _new("macro_patch", "um", "patches.width", "patches.width_um"),
    _new("steps", "1", "steps", "steps"),
    _last("patch_along", "scar_mm.along"),
    _last("patch_across", "scar_mm.across"),
    _last("wear_depth_counter", "depth_um.counter", name="depth_counter", units="um", factor=1.0),
    _last("wear_depth_disc", "depth_um.disc", name="depth_disc", units="um", factor=1.0),
    _last("wear_volume_counter", "volume_mm3.counter", name="volume_counter"),
    _last("wear_volume_disc", "volume_mm3.disc", name="volume_disc"),
    _last("area_contact", "area_mm2.contact"),
    _last("pressure_mean", "pressure_MPa.mean"),
    _last("cof", "cof.end", label="coefficient of friction at the end"),
    _new("cof_input", "1", "CoF that is an input", "cof_input"),
    _new("shear_strength", "MPa", "shear strength τ0", "shear_strength_MPa"),
    _new("exponent_m", "1", "m", "cof_shape.exponent_m"),
    _new("levelling_lambda", "1", "λ", "cof_shape.levelling_lambda"),
)
#: End values by name.
ENDS = {quantity.name: quantity for quantity in END_VALUES}


def value_in(summary: Mapping[str, Any], quantity: Quantity) -> Value:
    """Find the value of a quantity in a run's summary; None where it has none."""
    value = value_of(summary, quantity.entry)
    return value if isinstance(value, str | int | float) else None
