"""What another value of each assumed key would change, as far as a run, a formula or docs/limits.md knows it.

The sentences stand in templates/sentences/effects.toml; here are the run's own numbers, and what they decide.
"""

import math
from enum import IntEnum
from typing import Any, NamedTuple

from warpwear.errors import prose
from warpwear.history.end_values import Summary
from warpwear.laws.archard import BODIES
from warpwear.page.limits import applies
from warpwear.results.report import shown
from warpwear.study.study import Study


class Weight(IntEnum):
    """Say how much hangs on an assumption."""

    DECIDES = 0  # a number at the top of the page is in proportion to it, or nearly
    CHANGES = 1
    LITTLE = 2


class Effect(NamedTuple):
    """A sentence on what another value of some keys would change, where all conditions hold."""

    weight: Weight
    keys: list[str]
    conditions: list[str]
    sentence: str


EFFECTS = [
    Effect(Weight[weight.upper()], keys.split(", "), conditions.split(", ") if conditions else [], sentence)
    for weight, sentences in prose("effects").items()
    for name, sentence in sentences.items()
    for keys, _, conditions in [name.partition(" | ")]
]
#: How sentences on the preset begin; and one on a body's hardness, where the study gives none of the contact.
FINE = "In the preset v3-fine (local law, the disc lies still)"
SOFTER = "The softer body's is the largest pressure of a cell. "


def effect_of(key: str, study: Study, numbers: dict[str, Any]) -> tuple[Weight, str]:
    """Say what another value of an assumed key would change. numbers: of the run, as of `numbers_of`."""
    is_softer = key in {f"{body}.hardness" for body in BODIES} and applies("softer body", study)
    name = "contact.hardness" if is_softer else key
    known = [effect for effect in EFFECTS if name in effect.keys]
    known = known or [effect for effect in EFFECTS if "unknown" in effect.keys]
    chosen = [effect for effect in known if all(applies(c, study, **numbers) for c in effect.conditions)]
    text = " ".join(effect.sentence.format(key=key, fine=FINE, **numbers) for effect in chosen)
    return min(effect.weight for effect in chosen), SOFTER * is_softer + text


def numbers_of(study: Study, s: Summary) -> dict[str, Any]:
    """Collect the numbers of a run that sentences and their cases go by."""
    tau, reach = s.shear_strength, 0.5 * max(s.patch_along, s.patch_across) * study.counter.form.curvature
    names = ("contact", "touched", "nominal", "cumulative") if tau is not None else ()
    error = s.step_error
    steps = "that is not known" if error is None else f"it does by {100.0 * error:.2g} % at most"
    return {
        "capped": 100.0 * (s.area_plastic / s.area_contact) if s.area_contact else 0.0,
        "at_the_end": " at the end" if study.sliding.total else "",
        "coefficient": "the coefficient" + " less its ploughing part" * bool(study.friction.ploughing),
        "coefficients": shown({name: getattr(s, f"area_{name}") * tau / s.load for name in names}, 3),
        "rim": 100.0 * (1.0 - math.sqrt(max(0.0, 1.0 - reach**2))),
        "steps": steps,
    }
