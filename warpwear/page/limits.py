"""What the model of a run cannot show: the sentences of docs/theory/limits.md that apply to it.

The sentences stand in templates/limits.toml; here are the conditions of these, and of those of effects.toml.
"""

import math
from collections.abc import Callable

from warpwear.errors import prose
from warpwear.study.study import Study

#: Names of conditions, with commas between them -> the sentences that apply where all hold.
LIMITS: dict[str, list[str]] = prose("limits")
CONDITIONS: dict[str, Callable[[Study], bool]] = {
    "static": lambda study: not study.sliding.total,
    "slides": lambda study: study.sliding.total > 0.0,
    "at rest": lambda study: not study.is_swept and study.fretting is None,
    "frets": lambda study: study.sliding.frets,
    "may stick": lambda study: study.sliding.drives_bodies,
    "over a track": lambda study: study.is_swept,
    "part of the stroke": lambda study: study.track.track_fraction < 1.0,
    "local law": lambda study: study.contact.law == "local",
    "half-space": lambda study: study.contact.law == "half-space",
    "smooth": lambda study: not study.is_rough,
    "rough": lambda study: study.is_rough,
    "measured": lambda study: study.disc.synthetic is None,
    "random": lambda study: study.disc.synthetic is not None and study.disc.synthetic.kind != "flat",
    "sampled by patches": lambda study: study.samples_area,
    "two scales": lambda study: study.study.model == "two-scale",
    "loads of a smooth contact": lambda study: study.patches.coupling == "load",
    "friction fitted": lambda study: study.friction.fitted in ("end", "initial"),
    "friction constant": lambda study: study.friction.fitted == "coulomb",
    "friction by states": lambda study: study.friction.fitted == "states",
    "friction not fitted": lambda study: study.friction.fitted is None,
    "empirical friction": lambda study: (
        study.friction.fitted != "states" and bool(study.friction.law_with().said)
    ),
    "layered": lambda study: study.pair.profiles is not None,
    "wear in pieces": lambda study: study.wear.sheds,
    "wear by pressure": lambda study: any(law.over_pressure[0] for law in study.wear_laws),
    "severe at the hardness": lambda study: (
        study.wear.law == "transition"
        and math.inf > study.hardness >= study.wear_laws[0].over_pressure[0][-1]
    ),
    # of what another value of an assumption would change alone
    "energy law": lambda study: study.wear.law == "energy",
    "junctions grow": lambda study: bool(study.friction.junction_growth),
    "pieces of critical size": lambda study: study.wear.particle == "critical",
    "elastic": lambda study: study.contact.law == "half-space" or study.pair.uses_bulk_stiffness,
    "softer body": lambda study: study.contact.hardness is None and math.isfinite(study.hardness),
}


def limits_of(study: Study) -> list[str]:
    """List the sentences that apply to the runs of a study."""
    return [
        sentence
        for names, sentences in LIMITS.items()
        if all(CONDITIONS[name](study) for name in names.split(", "))
        for sentence in sentences
    ]
