"""What output.joint asks for: what the contact of a snapshot conducts and lets through, how hot it gets."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.contact.array.found import Flash
from warpwear.errors import ConvergenceError
from warpwear.grid import FloatArray
from warpwear.history.snapshot import Snapshot
from warpwear.study.bodies import HEAT
from warpwear.study.study import Study

heating = lazy.module("warpwear.contact.joint.flash")
solving = lazy.module("warpwear.contact.array.solve")

#: Column -> its value of a contact; the first word of its name is what output.joint asks for.
COLUMNS: Mapping[str, Callable[[Any], float]] = {
    "conductance_length": lambda contact: contact.conductance(),
    "stiffness_loading": lambda contact: contact.stiffness(),
    "stiffness_unloading": lambda contact: contact.stiffness(unloading=True),
    "flow_along": lambda contact: contact.flow_factors().along,
    "flow_across": lambda contact: contact.flow_factors().across,
    "flow_shear": lambda contact: contact.flow_factors().shear,
}
#: Cells that a contact spans at most of which it is told how hot it gets: a few seconds, and 2 GB.
MOST_HEATED = 2**22


def contact_of(study: Study, snapshot: Snapshot, load: float) -> Any:
    """Solve the contact of the bodies of a snapshot anew, at a load [N]."""
    return solving.solve_contact(
        -np.where(np.isfinite(snapshot.gap), snapshot.gap, 2.0 * study.grid.sides[0]),
        cell=study.grid.cell,
        load=load,
        modulus=study.pair.effective_modulus,
        hardness=study.hardness if study.pair.caps_pressure else None,
        boundary=study.boundary,
    )


def columns_at(study: Study, snapshot: Snapshot, history: Mapping[str, FloatArray]) -> dict[str, float]:
    """Return the columns that a study asks for, of a snapshot of a run with a history."""
    at = min(int(np.searchsorted(history["distance"], snapshot.distance)), history["load"].size - 1)
    row, asked = dict[str, float](), study.output.joint
    if "flash" in asked:
        hot = flash_of(study, snapshot, cof=float(history["cof"][at]))
        largest, mean = (math.nan, math.nan) if isinstance(hot, str) else (hot.largest, hot.mean)
        row = {"flash_max": largest, "flash_mean": mean}
    if {*asked} - {"flash"}:
        contact = contact_of(study, snapshot, float(history["load"][at]))
        row |= {n: of(contact) for n, of in COLUMNS.items() if n.partition("_")[0] in asked}
    if "conductance" in asked:
        # As if both bodies were of the mean of their resistivities, of heat 1/conductivity; lengths are mm.
        heat, charge = _constants(study, ("conductivity", "resistivity"))
        for name, resists in {"conductance_heat": 1.0 / heat, "conductance_charge": charge}.items():
            row[name] = 2.0e-3 * row["conductance_length"] / float(np.sum(resists))
    return row


def _constants(study: Study, names: Sequence[str]) -> FloatArray:
    """Return constants of both bodies, shape (names, disc and counter-body), NaN where one is not known."""
    return np.array([[getattr(b, name) for b in (study.disc, study.counter)] for name in names], np.float64)


def flash_of(study: Study, snapshot: Snapshot | None, *, cof: float) -> Flash | str:
    """Return how much hotter than the bodies the contact of a snapshot is, or what is not known of it.

    The disc moves at its mean speed through a contact that stays on the counter-body; heat goes by pressure.
    """
    constants, bodies = _constants(study, HEAT), ("disc", study.counter.name)
    missing = [f"{HEAT[i]} of the {bodies[j]}" for i, j in np.argwhere(np.isnan(constants))]
    slid = 0.0 if snapshot is None else snapshot.distance * (1.0 - 1.0e-9)
    speed = next((block.speed for block in study.blocks if slid <= block.end), study.blocks[-1].speed)
    others = {"sliding speed": speed, "coefficient of friction": cof > 0.0}
    others["snapshot of all its cells"] = snapshot is not None and study.study.model != "two-scale"
    others["contact of limited extent"] = not study.is_line
    missing += [name for name, is_known in others.items() if not is_known]
    if missing or snapshot is None:
        return f"no {missing[0].replace('_', ' ')}"
    pressure, (conducts, heats, weighs) = snapshot.pressure, constants
    if math.prod(np.count_nonzero(pressure.any(axis=axis)) for axis in (0, 1)) > MOST_HEATED:
        return "too many cells"
    try:
        hot: Flash = heating.flash(
            pressure,
            speed,
            cell=study.grid.cell,
            conductivity=conducts,
            diffusivity=1.0e6 * conducts / (heats * weighs),  # [mm²/s]
            friction=cof,
        )
    except ConvergenceError as error:
        return str(error)
    return hot
