"""A distance factor at rest, and a second user of what cells have: both count, or one is refused."""

from typing import Any

import numpy as np
import pytest

from warpwear import InputError, Study, run

RADIAL = {"wear.distance_factor": "radial"}
LAYER = {"name": "coat", "thickness": "0.5 um", "wear": "1e-5 mm^3/N/m"}
ENERGY = {"counter": "0 mm^3/J", "disc": "1e-5 mm^3/J", "law": "energy"}
#: What else may want a K, a stiffness, a cap or a shear strength of each cell.
SECOND: dict[str, dict[str, Any]] = {
    "film": {"friction.film": {"shear_strength": "100 MPa", "thickness": "0.2 um"}},
    "growing junctions": {"friction.junction_growth": 9.0},
    "layers": {"disc.layers": [LAYER]},
    "gradient": {"disc.gradient": [[0.0, 1e-5], [1.0, 1e-4]]},
    "pressure": {
        "wear": {"counter": "0 mm^3/N/m", "disc": "1e-4 mm^3/N/m", "law": "transition"}
        | {"severe_counter": "0 mm^3/N/m", "severe_disc": "4e-4 mm^3/N/m"}
        | {"transition_pressure": "500 MPa", "transition_width": "200 MPa"}
    },
    "energy": {"wear": ENERGY, "friction": {"law": "coulomb", "coefficient": 0.4}},
    "running in": {"wear.law": "running-in", "wear.running_in": "5 mm", "wear.initial_disc": "1e-3 mm^3/N/m"},
    "pieces": {"wear.particle": "40 um", "wear.particle_thickness": "1 um"},
    "springs": {"contact.stiffness": "1e6 N/mm^3"},
    "half-space": {"contact.law": "half-space"},
}
#: Those of which both count.
BOTH = ("film", "growing junctions", "energy", "running in", "springs")


def study(changes: dict[str, Any]) -> Study:
    return Study(
        counter={"radius": "0.5 mm", "young": "210 GPa", "poisson": 0.3, "hardness": "2 GPa"},
        disc={
            **{"young": "210 GPa", "poisson": 0.3, "hardness": "2 GPa"},
            "synthetic": {"kind": "self-affine", "sq": "0.1 um", "cut_off": "40 um", "period": "0.8 mm"},
        },
        contact={"load": "2 N", "law": "local"},
        wear={"counter": "0 mm^3/N/m", "disc": "1e-4 mm^3/N/m"},
        friction={"law": "shear-strength", "shear_strength": "400 MPa"},
        grid={"cell": "10 um", "extent": "0.6 mm"},
        output={"snapshots": []},
        sliding={"distance": "20 mm", "kinematics": "stationary"},
    ).replace(changes)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("second", SECOND)
def test_no_user_of_a_field_is_dropped(second: str) -> None:
    try:
        both = study(SECOND[second] | RADIAL)
    except InputError as error:
        refusal = str(error)
        study(SECOND[second])  # which alone is allowed
    else:
        refusal = ""
    assert ("wear.distance_factor" in refusal) != (second in BOTH)
    if refusal:
        return
    assert "wear.distance_factor" not in both.unused_keys
    worn = [run(one).snapshot(-1).wear_disc for one in (both, study(SECOND[second]), study(RADIAL))]
    assert not np.array_equal(worn[0], worn[1])  # the factor counts
    friction = [run(one).history["cof"][-1] for one in (both, study(RADIAL))]
    assert not np.array_equal(worn[0], worn[2]) or friction[0] != friction[1]  # and so does the other
