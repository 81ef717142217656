"""A run comes to these numbers, as quantities: tables of several runs and the tops of pages show them."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from warpwear.history.quantities import BY_NAME, ENDS_DECLARED, Quantity
from warpwear.study.keys import value_of

Value = str | int | float | None


#: End values in the order of tables: the last of a column of the history, of a swept run the mean of the last
#: cycle, or what a run comes to beside.
END_VALUES = tuple(
    replace(
        BY_NAME.get(own.pop("column", name)) or Quantity(name, "1", f"{own['label']} of a run"),
        name=name,
        **own,
    )
    for name, own in ENDS_DECLARED.items()
)
#: End values by name.
ENDS = {quantity.name: quantity for quantity in END_VALUES}


def value_in(summary: Mapping[str, Any], quantity: Quantity) -> Value:
    """Find the value of a quantity in a run's summary; None where it has none."""
    value = value_of(summary, quantity.entry)
    return value if isinstance(value, str | int | float) else None
