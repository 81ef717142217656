"""Distances slid as people read them: in mm, m or km."""

#: Units of long distances [mm], of which at least ten are told in them.
METRES = {"m": 1e3, "km": 1e6}


def unit_of(distance: float) -> str:
    """Choose the unit that people read a distance slid [mm] in."""
    return next((unit for unit in ("km", "m") if distance >= 10.0 * METRES[unit]), "mm")


def with_unit(distance: float, digits: int = 6) -> str:
    """Write a distance slid [mm] with the unit that people read it in."""
    unit = unit_of(distance)
    return f"{distance / METRES.get(unit, 1.0):.{digits}g} {unit}"
