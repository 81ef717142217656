"""Studies of a film that wear breaks, of every model; shared by tests."""

import math
from typing import Any

import numpy as np
import pytest
from cases_track import small

import warpwear
from warpwear import Study
from warpwear.grid import FloatArray

STRENGTHS = {"friction.shear_strength": "172 MPa", "friction.film.shear_strength": "40 MPa"}
GROWN = {"friction.junction_growth": 9.0, "contact.hardness": "590 MPa"}
FILM = STRENGTHS | GROWN | {"friction.film.thickness": "10 nm"}
HALF_SPACE = {"contact.law": "half-space"}
#: Caps under the film and without it [MPa].
FILMED, BARE = math.sqrt(590.0**2 - 9.0 * 40.0**2), math.sqrt(590.0**2 - 9.0 * 172.0**2)
REST = {"grid.cell": "20 um", "grid.extent": "0.6 mm", "sliding.distance": "3 mm", "counter.radius": "1 mm"}
REST |= {"stepping.first": "30 um", "output.snapshots": [], "output.precision": "double"}
TWO_SCALE = {"grid.cell": "20 um", "grid.extent": "0.6 mm", "patches.macro_cell": "100 um"}
TWO_SCALE |= {"sliding.distance": "3 mm", "stepping.first": "30 um", "output.snapshots": []}
PATCHED_HALF_SPACE = HALF_SPACE | {"patches.bulk": "none", "contact.boundary": "free"}
STUDIES: dict[str, Study] = {
    "track": small("representative"),
    "track, bearing area": small("full").replace({"stepping.scheme": "explicit", "stepping.force": True}),
    "track, dents": small("full", sliding__plastic="keep", contact__stiffness="2e5 N/mm^3"),
    "track, half-space": small("representative").replace(HALF_SPACE),
    "rest": Study.load("v3-fine").replace(REST),
    "rest, across": Study.load("v3-fine").replace(REST | {"wear.distance_factor": "across"}),
    "rest, half-space": Study.load("v3-fine").replace(REST | HALF_SPACE),
    "two scales": Study.load("two-scale").replace(TWO_SCALE),
    "two scales, half-space": Study.load("two-scale").replace(TWO_SCALE | PATCHED_HALF_SPACE),
}


def needs_transforms(study: Study, device: str) -> None:
    if device != "cpu" and study.contact.law == "half-space":
        pytest.importorskip("cupy")


def history_of(study: Study, **options: Any) -> dict[str, FloatArray]:
    with warpwear.run(study, **options) as result:
        return {name: np.array(values) for name, values in result.history.items()}
