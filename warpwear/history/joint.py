"""What the contact of a snapshot conducts and how stiff it is: columns that output.joint asks for."""

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from warpwear.contact.array.contact import ArrayContact
from warpwear.contact.array.solve import solve_contact
from warpwear.grid import FloatArray
from warpwear.history.snapshot import Snapshot
from warpwear.study.study import Study

#: Column -> its value of a contact; the first word of its name is what output.joint asks for.
COLUMNS: Mapping[str, Callable[[ArrayContact], float]] = {
    "conductance_length": ArrayContact.conductance,
    "stiffness_loading": ArrayContact.stiffness,
    "stiffness_unloading": partial(ArrayContact.stiffness, unloading=True),
}


def contact_of(study: Study, snapshot: Snapshot, load: float) -> ArrayContact:
    """Solve the contact of the bodies of a snapshot anew, at a load [N]."""
    return solve_contact(
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
    contact = contact_of(study, snapshot, float(history["load"][at]))
    return {n: of(contact) for n, of in COLUMNS.items() if n.partition("_")[0] in study.output.joint}
