"""What the sections of a study must agree on before anything is computed."""

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from warpwear.study import Study

#: More steps than anybody waits for, or than a history holds.
MOST_STEPS = 1_000_000


def check(study: "Study") -> None:
    """Raises ValueError, in one sentence, for a study that cannot be computed as it stands."""
    _hardness(study)
    _capacity(study)
    _tolerance(study)
    _stability(study)
    _steps(study)


def _hardness(study: "Study") -> None:
    if study.contact.hardness is None and not study.body_hardnesses:
        raise ValueError(
            "contact.hardness, sphere.hardness or disc.hardness must be given ('inf MPa' is none)"
        )
    if math.isfinite(study.hardness):
        return
    for body, coefficient in (("sphere", study.wear.sphere), ("disc", study.wear.disc)):
        if coefficient.dimensionless and coefficient.value > 0.0:
            raise ValueError(
                f"wear.{body} = {coefficient.value:g} is k of V = k F L / H and needs a finite "
                "contact.hardness; or give it with a unit, such as '9.4e-4 mm^3/N/m'"
            )
    if study.uses_bearing_area:
        raise ValueError(
            "contact.hardness = inf MPa needs a finite contact.stiffness, or wear with "
            "stepping.scheme = 'implicit'"
        )


def _capacity(study: "Study") -> None:
    curvature = study.sphere.curvature
    under_sphere = math.pi / curvature**2 if curvature else math.inf
    carried = study.hardness * min(study.cells.area, under_sphere)
    if carried < study.contact.load:
        raise ValueError(
            f"contact.load = {study.contact.load:g} N is more than the domain under the sphere carries at "
            f"this hardness ({carried:.4g} N); allowed are smaller loads, a larger grid.extent or "
            "contact.hardness"
        )


def _tolerance(study: "Study") -> None:
    if study.uses_bearing_area and study.load_tolerance >= study.contact.load:
        raise ValueError(
            f"stepping.load_tolerance = {study.load_tolerance:g} N (one cell carries "
            f"{study.hardness * study.cells.cell_area:g} N) must be smaller than contact.load = "
            f"{study.contact.load:g} N"
        )


def _stability(study: "Study") -> None:
    if study.stepping.scheme == "implicit" or study.stepping.force:
        return
    limit = study.law.stable_increment(sum(study.wear_coefficients))
    largest = min(study.stepping.plan[2], study.sliding.total)
    if largest >= limit:
        name = "largest" if study.stepping.increment is None else "increment"
        raise ValueError(
            f"stepping.{name} = {study.stepping.plan[2]:g} mm is beyond the explicit stability limit "
            f"2/(k K) = {limit:.3g} mm; allowed are smaller increments, scheme = 'implicit', or force = true"
        )


def _steps(study: "Study") -> None:
    first, growth, largest = study.stepping.plan
    final = first if growth == 1.0 else largest
    growing = math.log(largest / first) / math.log(growth) if growth > 1.0 else 0.0
    # Growing steps cover first growth^n/(growth − 1); at most all of the distance is left for the largest.
    covered = (largest - first) / (growth - 1.0) if growth > 1.0 else 0.0
    steps = growing + max(0.0, study.sliding.total - covered) / final
    if steps > MOST_STEPS:
        raise ValueError(
            f"sliding.distance = {study.sliding.total:g} mm takes {steps:.3g} steps by this [stepping]; "
            f"allowed are {MOST_STEPS:,}, so larger increments are needed"
        )
