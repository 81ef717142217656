"""Values of a study that follow from others: constants of a material, the macro model's cell."""

from typing import Any

from warpwear.materials import material
from warpwear.quantities import text

CONSTANTS = ("young", "poisson", "hardness")
MACRO_CELL = "10 um"


def fill(sections: dict[str, Any]) -> tuple[dict[str, Any], set[str]]:
    """The sections with what follows from them, and the dotted names of what was filled in.

    What cannot be understood is left to the validation of the study.
    """
    filled = {name: dict(keys) if isinstance(keys, dict) else keys for name, keys in sections.items()}
    names: set[str] = set()
    for body in ("sphere", "disc"):
        keys = filled.get(body)
        if not isinstance(keys, dict) or not isinstance(keys.get("material"), str):
            continue
        try:
            known = material(keys["material"])
        except ValueError:
            continue
        values = {
            "young": text(known.young, "MPa"),
            "poisson": known.poisson,
            "hardness": text(known.hardness, "MPa"),
        }
        missing = {name: value for name, value in values.items() if keys.get(name) is None}
        keys.update(missing)
        names |= {f"{body}.{name}" for name in missing}
    about, grid = filled.get("study"), filled.get("grid")
    macro = isinstance(about, dict) and about.get("model") == "macro"
    if macro and isinstance(grid, dict) and grid.get("cell") is None:
        grid["cell"] = MACRO_CELL
        names.add("grid.cell")
    return filled, names
