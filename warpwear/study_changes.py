"""Changes of a study's keys by their dotted names, on the nested mapping that a study is made from."""

from collections.abc import Mapping
from typing import Any

from warpwear.defaults import CONSTANTS
from warpwear.errors import InputError

#: Keys that say the same in different ways. Setting one with `replace` drops the others.
ALTERNATIVES: tuple[tuple[frozenset[str], ...], ...] = (
    (frozenset({"sphere.radius"}), frozenset({"sphere.diameter"})),
    (frozenset({"disc.surface"}), frozenset({"disc.synthetic"})),
    (frozenset({"disc.synthetic.ra"}), frozenset({"disc.synthetic.sq"})),
    (
        frozenset({"sliding.distance"}),
        frozenset({"sliding.passes"}),
        frozenset({"sliding.cycles"}),
        frozenset({"sliding.duration", "sliding.frequency"}),
        frozenset({"sliding.revolutions"}),
    ),
    (frozenset({"sliding.stroke"}), frozenset({"sliding.track_radius"})),
    (
        frozenset({"stepping.increment"}),
        frozenset({"stepping.first", "stepping.growth", "stepping.largest"}),
    ),
    (
        frozenset({"friction.shear_strength"}),
        frozenset({"friction.coefficient", "friction.calibrate"}),
    ),
)


def change(nested: dict[str, Any], flat: Mapping[str, Any]) -> None:
    """Set keys, {"grid.cell": "2 um"}, in place. What says the same in another way is dropped."""
    for name, value in flat.items():
        for other in _dropped_by(name) - set(flat):
            _remove(nested, other)
        _insert(nested, name, value)
        assumed = nested.get("assumed")
        if not isinstance(assumed, dict):
            continue
        replaced = {name} | _dropped_by(name)
        for key in [k for k in assumed if k in replaced or k.startswith(f"{name}.")]:
            del assumed[key]


def _dropped_by(name: str) -> set[str]:
    """Keys that a new value of this one makes void."""
    body, _, key = name.partition(".")
    if key == "material":  # another material has other constants
        return {f"{body}.{constant}" for constant in CONSTANTS}
    for group in ALTERNATIVES:
        for way in group:
            if any(name == k or name.startswith(k + ".") for k in way):
                return set().union(*group) - way
    return set()


def _insert(nested: dict[str, Any], name: str, value: Any) -> None:
    *parents, last = name.split(".")
    for depth, parent in enumerate(parents):
        nested = nested.setdefault(parent, {})
        if not isinstance(nested, dict):
            raise InputError(f"'{name}' is no key: {'.'.join(parents[: depth + 1])} has none below it.")
    nested[last] = value


def value_of(nested: Any, name: str) -> Any:
    """The value of a dotted key; None where there is none."""
    for part in name.split("."):
        nested = nested.get(part) if isinstance(nested, dict) else None
    return nested


def _remove(nested: dict[str, Any], name: str) -> None:
    *parents, last = name.split(".")
    for parent in parents:
        nested = nested.get(parent, {})
        if not isinstance(nested, dict):
            return
    nested.pop(last, None)
