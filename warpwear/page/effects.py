"""What another value of each assumed key would change, as far as a run, a formula or docs/limits.md knows it.

The sentences stand in templates/effects.toml; here are the cases that a key has, and the run's own numbers.
"""

import math
from collections.abc import Callable
from enum import IntEnum
from typing import Any

from warpwear.laws.archard import BODIES
from warpwear.results.formats.forms import prose
from warpwear.results.report import shown
from warpwear.study.study import Study


class Weight(IntEnum):
    """Say how much hangs on an assumption."""

    DECIDES = 0  # a number at the top of the page is in proportion to it, or nearly
    CHANGES = 1
    LITTLE = 2


Effect = tuple[Weight, str]
#: Percentages of the area in contact at the hardness: above, it decides; below, it hardly matters.
MOST, FEW = 50.0, 1.0
#: How sentences on the preset begin.
FINE = "In the preset v3-fine (local law, the disc lies still)"
#: Key, or case of a key -> weight and sentence.
SENTENCES: dict[str, Effect] = {
    name: (Weight[weight.upper()], sentence)
    for weight, sentences in prose("effects").items()
    for names, sentence in sentences.items()
    for name in (names.split(", ") if "." in names else [names])
}


def effect_of(key: str, study: Study, numbers: dict[str, Any]) -> Effect:
    """Say what another value of an assumed key would change. numbers: of the run, as of `numbers_of`."""
    names = CASES[key](study, numbers) if key in CASES else [key if key in SENTENCES else "unknown"]
    chosen = [SENTENCES[name] for name in names]
    text = " ".join(sentence.format(key=key, fine=FINE, **numbers) for _, sentence in chosen)
    return min(weight for weight, _ in chosen), text


def numbers_of(study: Study, s: dict[str, Any]) -> dict[str, Any]:
    """Collect the numbers of a run that sentences and their cases go by. s: its summary."""
    area, strength = s["area_mm2"], s["shear_strength_MPa"]
    reach = 0.5 * max(s["scar_mm"].values()) * study.counter.form.curvature
    names = ("contact", "touched", "nominal", "cumulative") if strength is not None else ()
    steps = s.get("track", {}).get("parts", {}).get("estimated_error_at_most", 0.0)
    return {
        "capped": 100.0 * float(area["plastic"] / area["contact"]) if area["contact"] else 0.0,
        "at_the_end": " at the end" if study.sliding.total else "",
        "coefficient": "the coefficient" + " less its ploughing part" * bool(study.friction.ploughing),
        "coefficients": shown({name: strength * area[name] / s["load_N"] for name in names}, 3),
        "rim": 100.0 * (1.0 - math.sqrt(max(0.0, 1.0 - reach**2))),
        "steps": 100.0 * steps,
    }


def _hardness(study: Study, numbers: dict[str, Any]) -> list[str]:
    if numbers["capped"] > MOST:
        return ["hardness, most cells"]
    return [f"hardness, {'some' if numbers['capped'] > FEW else 'few'} cells", "hardness, at first"]


def _body_hardness(study: Study, numbers: dict[str, Any]) -> list[str]:
    if study.contact.hardness is None and math.isfinite(study.hardness):
        return ["softer body", *_hardness(study, numbers)]
    return ["softer body, unused"]


def _elastic(study: Study, numbers: dict[str, Any]) -> list[str]:
    if study.contact.law == "half-space":
        return ["elastic, half-space"]
    return ["elastic, springs" if study.uses_bulk_stiffness else "elastic, unused"]


def _material(study: Study, numbers: dict[str, Any]) -> list[str]:
    return ["material, unused" if _elastic(study, numbers) == ["elastic, unused"] else "material"]


#: Key -> the names of its sentences for a study and the numbers of a run.
CASES: dict[str, Callable[[Study, dict[str, Any]], list[str]]] = {
    "friction.shear_strength": lambda study, numbers: [
        "strength, junctions grow" if study.friction.junction_growth else "strength"
    ],
    "friction.coefficient": lambda study, numbers: (
        ["coefficient, constant", *["coefficient, energy"] * (study.wear.law == "energy")]
        if study.friction.fitted == "coulomb"
        else ["coefficient"]
    ),
    "friction.area": lambda study, numbers: ["area" if numbers["coefficients"] else "area, strength unknown"],
    "contact.hardness": _hardness,
    "counter.material": _material,
    "disc.material": _material,
    **{f"{body}.{key}": _elastic for body in BODIES for key in ("young", "poisson")},
    **{f"{body}.hardness": _body_hardness for body in BODIES},
    "disc.synthetic.seed": lambda study, numbers: ["seed" if study.sliding.total else "seed, static"],
    "sliding.shift": lambda study, numbers: [
        "shift, half-space" if study.contact.law == "half-space" else "shift, local"
    ],
    "sliding.track": lambda study, numbers: [
        "track, whole stroke" if study.track.track_fraction == 1.0 else "track, part of the stroke"
    ],
    "junctions.surface_energy": lambda study, numbers: [
        "surface energy, pieces" if study.wear.particle == "critical" else "surface energy"
    ],
}
