"""Small tests of the laboratory that several test files infer from."""

import numpy as np

from warpwear import Study
from warpwear.inference.data import Data, MeasuredCourse
from warpwear.inference.infer import noise_for
from warpwear.inference.likelihood import Posterior
from warpwear.inference.model import Model
from warpwear.inference.runs import Runs
from warpwear.inference.unknowns import unknowns_of
from warpwear.sweeps.run_one import Row

#: Wear that the course of `worn_paraboloid` goes to, as a multiple of the study's.
BEYOND = 12.0


def smooth_study(**changes: str) -> Study:
    """The smooth ball at rest on coarse cells, with implicit steps: a run of it takes a moment."""
    return Study.load("v1").replace({"stepping.scheme": "implicit", "grid.cell": "20 um", **changes})


def worn_paraboloid(study: Study) -> Runs:
    """What a run of the smooth study comes to, in closed form: A = π a², a = (4 R (K_s + K_d) F L/π)^¼."""
    sphere, disc = (BEYOND * k for k in study.wear_coefficients)
    texts = {"wear.sphere": f"{1e3 * sphere!r} mm^3/N/m", "wear.disc": f"{1e3 * disc!r} mm^3/N/m"}
    wide = study.replace({"grid.extent": "4 mm", **texts})
    distance = np.geomspace(1e-3, study.sliding.total, 200)
    assert study.sphere.radius is not None
    a2 = np.sqrt(4.0 * study.sphere.radius * (sphere + disc) * study.contact.load * distance / np.pi)
    across = 2.0 * np.sqrt(a2)
    courses = {
        "distance": distance,
        "area_contact": np.pi * a2,
        "patch_along": across,
        "patch_across": across,
    }
    return Runs(wide, (), np.zeros((1, 0)), (Row("done", courses=courses),), True)


def posterior_of(
    study: Study, unknown: dict[str, str | None], data: Data, *, closed_form: bool = True
) -> Posterior:
    """The posterior of the smooth study in closed form, without a run."""
    unknowns = list(unknowns_of(study, unknown))
    model = Model(study, tuple(unknowns), worn_paraboloid(study), frozenset(data.kinds | {"diameter"}))
    return Posterior(model, tuple(noise_for(data, unknown)), data, closed_form=closed_form)


def course_like(study: Study, *, points: int = 40, name: str = "test") -> MeasuredCourse:
    """Places of a course over the whole test; its coefficients are to be drawn."""
    distance = np.linspace(study.sliding.total / points, study.sliding.total, points)
    return MeasuredCourse(name, distance, np.zeros(points))
