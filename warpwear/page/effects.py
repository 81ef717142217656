"""What another value of each assumed key would change, as far as a run, a formula or docs/limits.md knows it.

Percentages of presets are those of docs/limits.md ("What an assumed value changes"), docs/running-in.md and
docs/two-scale.md; the rest is reckoned from the run's own summary.
"""

import math
from collections.abc import Callable
from enum import IntEnum
from typing import Any

from warpwear.results.report import shown
from warpwear.study.study import Study


class Weight(IntEnum):
    """How much hangs on an assumption."""

    DECIDES = 0  # a number at the top of the page is in proportion to it, or nearly
    CHANGES = 1
    LITTLE = 2


Effect = tuple[Weight, str]
#: Part of the area in contact at the hardness below which the hardness hardly matters.
FEW = 0.01
#: How sentences on the preset begin.
FINE = "In the preset v3-fine (local law, the disc lies still)"


def effect_of(key: str, study: Study, s: dict[str, Any]) -> Effect:
    """Say what another value of an assumed key would change. s: the run's summary."""
    found = EFFECTS.get(key)
    if found is None:
        return Weight.CHANGES, f"Not known. A sweep tells: warpwear sweep study.toml --vary {key}=VALUES"
    return found(study, s) if callable(found) else found


def _capped(s: dict[str, Any]) -> float:
    """Part of the area in contact that is at the hardness at the end."""
    area = s["area_mm2"]
    return float(area["plastic"] / area["contact"]) if area["contact"] else 0.0


def _strength(study: Study, s: dict[str, Any]) -> Effect:
    if study.friction.junction_growth:
        return (
            Weight.DECIDES,
            "Friction of bare metal is in proportion to it, and it widens sheared junctions.",
        )
    part = "the coefficient" if not study.friction.ploughing else "the coefficient less its ploughing part"
    return Weight.DECIDES, f"Half of it, half of {part}, at every distance. Nothing else depends on it."


def _hardness(study: Study, s: dict[str, Any]) -> Effect:
    part, slides = _capped(s), study.sliding.total > 0.0
    if part > 0.5:
        return Weight.DECIDES, (
            f"{100.0 * part:.3g} % of the contact bears it{' at the end' * slides}: 10 % more of it is "
            "nearly "
            "10 % less area and 10 % more pressure, and less friction."
        )
    first = f"{FINE} twice of it is 9 % less area after 3 mm, and nothing after 30 mm."
    if part > FEW:
        return Weight.CHANGES, f"{100.0 * part:.3g} % of the contact bears it at the end. {first}"
    return (
        Weight.LITTLE,
        f"Hardly any cell bears it at the end; the area at first is in proportion to 1/H. {first}",
    )


def _body_hardness(study: Study, s: dict[str, Any]) -> Effect:
    if study.contact.hardness is None and math.isfinite(study.hardness):
        weight, told = _hardness(study, s)
        return weight, f"The softer body's is the largest pressure of a cell. {told}"
    return Weight.LITTLE, (
        "The largest pressure of a cell is contact.hardness. The softer body's sets what shear it bears, "
        "and d*, the "
        "critical size of junctions."
    )


def _elastic(study: Study, s: dict[str, Any]) -> Effect:
    if study.contact.law == "half-space":
        return Weight.CHANGES, (
            "By E*: of rough bodies that yield elastically the area goes as 1/E*, of smooth ones as E* to "
            "the power "
            f"−2/3. {100.0 * _capped(s):.3g} % of the contact, at the hardness, does not feel it."
        )
    if study.uses_bulk_stiffness:
        return (
            Weight.CHANGES,
            "The bulk's stiffness is in proportion to E*, until wear outweighs what it yields.",
        )
    return (
        Weight.LITTLE,
        "Hertz's values and d* beside the results. Contact, wear and friction do not use it here.",
    )


def _material(study: Study, s: dict[str, Any]) -> Effect:
    weight, _ = _elastic(study, s)
    return weight, "Those of its constants that are listed here: Young's modulus, Poisson's ratio, hardness."


def _shift(study: Study, s: dict[str, Any]) -> Effect:
    if study.contact.law == "half-space":
        parts = s.get("track", {}).get("parts", {})
        most = 100.0 * parts.get("estimated_error_at_most", 0.0)
        return Weight.LITTLE, (
            "Steps are divided where their length would change the area; by estimate it does by "
            f"{most:.2g} % at most."
        )
    return Weight.DECIDES, (
        "By the local law the area depends on it. In the preset track, at cells of 4 µm, half of 8 is 9 % "
        "less area in "
        "the last pass, single cells 20 % less; on a smooth disc the area is in proportion to it."
    )


def _plastic(study: Study, s: dict[str, Any]) -> Effect:
    return Weight.CHANGES, (
        "Dents that stay let the area rise within the first passes. In the preset running-in friction then "
        "rises "
        "later: 0.10 for 0.38 after 240 mm, 0.36 for 0.48 after 900 mm."
    )


def _track(study: Study, s: dict[str, Any]) -> Effect:
    if study.track.track_fraction == 1.0:
        return Weight.LITTLE, "It is the whole stroke."
    return Weight.CHANGES, (
        "The sphere meets the same piece of the disc again and again. In the preset running-in a track of "
        "the whole "
        "stroke, a surface of its own, has 1.5 % less friction after 90 mm."
    )


def _factor(study: Study, s: dict[str, Any]) -> Effect:
    reach = 0.5 * max(s["scar_mm"].values()) * study.sphere.curvature
    less = 100.0 * (1.0 - math.sqrt(max(0.0, 1.0 - reach**2)))
    return (
        Weight.LITTLE,
        f"Wear of the disc is less at the rim of this scar by {less:.2g} %, in its middle by nothing.",
    )


def _area(study: Study, s: dict[str, Any]) -> Effect:
    area, strength = s["area_mm2"], s["shear_strength_MPa"]
    if strength is None:
        return Weight.DECIDES, "The course of the coefficient is that of this area."
    cofs = {
        name: strength * area[name] / s["load_N"] for name in ("contact", "touched", "nominal", "cumulative")
    }
    return Weight.DECIDES, f"By the same shear strength the coefficient would end at: {shown(cofs, 3)}."


def _bulk(study: Study, s: dict[str, Any]) -> Effect:
    return Weight.CHANGES, (
        "Of unworn smooth bodies, against Hertz: matched by area, the peak pressure is 33 % high and the "
        "approach half; "
        "by peak pressure, the area is 33 % high; by approach, the area is double. Wear makes all of them "
        "alike."
    )


def _period(study: Study, s: dict[str, Any]) -> Effect:
    return (
        Weight.LITTLE,
        "Nothing as long as it is wider than the contact; another one is another surface, as a seed.",
    )


def _surface_energy(study: Study, s: dict[str, Any]) -> Effect:
    if study.wear.particle == "critical":
        return (
            Weight.DECIDES,
            "The pieces' diameter is in proportion to it: twice as wide, they leave far later.",
        )
    return (
        Weight.LITTLE,
        "d* is in proportion to it, the size beside which junctions are counted. Nothing else.",
    )


def _seed(study: Study, s: dict[str, Any]) -> Effect:
    if not study.sliding.total:
        return (
            Weight.CHANGES,
            "Another piece of the same surface. How much that is, a sweep over seeds tells.",
        )
    return Weight.CHANGES, (
        f"Another piece of the same surface. {FINE} five others change the area by −5 to +4 % after 3 mm, "
        "−10 to −1 % "
        "after 30 mm and less than 1 % after 2400 mm, where the scar is 0 to 2 % wider."
    )


_FINENESS: Effect = (Weight.LITTLE, f"{FINE} half or twice of it changes the area by 0.1 % at most.")
_PIECES: Effect = (
    Weight.CHANGES,
    "It moves the distance over which friction rises: with diameter, thickness, dust and start from less "
    "than 30 to "
    "more than 300 mm.",
)
_WEAR: Effect = (Weight.DECIDES, "Worn volume and depth are in proportion to it, whatever the contact.")

EFFECTS: dict[str, Effect | Callable[[Study, dict[str, Any]], Effect]] = {
    "friction.shear_strength": _strength,
    "friction.coefficient": (
        Weight.DECIDES,
        "The coefficient is this number where it is calibrated, and in proportion to it elsewhere.",
    ),
    "friction.area": _area,
    "friction.junction_growth": (
        Weight.DECIDES,
        "It lowers the pressure that a sheared cell bears. In the preset running-in friction after 480 mm "
        "is 0.46 with "
        "α = 9, and 0.24 without.",
    ),
    "friction.film.thickness": (
        Weight.CHANGES,
        "A thicker film wears through later: the distance over which friction rises is longer.",
    ),
    "friction.film.shear_strength": (
        Weight.DECIDES,
        "The coefficient at first, while all is filmed, is nearly in proportion to it.",
    ),
    "friction.film.bodies": (
        Weight.CHANGES,
        "A film on one body is gone sooner than two, and friction rises sooner.",
    ),
    "friction.film.regrowth": (
        Weight.CHANGES,
        "A film that forms anew holds friction down where cells rest long enough.",
    ),
    "wear.sphere": _WEAR,
    "wear.disc": _WEAR,
    "wear.distance_factor": _factor,
    "wear.particle": _PIECES,
    "wear.particle_thickness": _PIECES,
    "wear.pending_start": (
        Weight.CHANGES,
        "Pieces at every stage from the start: in the preset running-in friction after 90 mm is 0.24, not "
        "0.17.",
    ),
    "wear.dust_fraction": (
        Weight.CHANGES,
        "In the preset running-in 1 % of dust raises friction after 150 mm by a quarter, and 5 % ends its "
        "slow rise.",
    ),
    "contact.hardness": _hardness,
    "contact.stiffness": (
        Weight.CHANGES,
        f"Asperities that yield like springs have more area. {FINE} 10⁶ N/mm³ is 10 % more after 3 mm and "
        "1 % after "
        "30 mm; 10⁵ N/mm³ is 88 % and 8 %.",
    ),
    "contact.boundary": (
        Weight.CHANGES,
        "Beyond the domain there is nothing, or the domain again, which stiffens a contact that fills much "
        "of it.",
    ),
    "contact.bulk_stiffness": _bulk,
    "patches.bulk": (
        Weight.CHANGES,
        "Without the springs the bulk of both bodies does not yield; by the local law that is the micro "
        "model.",
    ),
    "patches.macro_cell": (
        Weight.LITTLE,
        "In patches that tile the contact, 50 to 150 µm wide, the area differs by less than 1 % at 590 MPa.",
    ),
    "sphere.material": _material,
    "disc.material": _material,
    "sphere.young": _elastic,
    "disc.young": _elastic,
    "sphere.poisson": _elastic,
    "disc.poisson": _elastic,
    "sphere.hardness": _body_hardness,
    "disc.hardness": _body_hardness,
    "disc.synthetic.kind": (
        Weight.CHANGES,
        "Everything that comes from roughness. How much, a measured disc tells (disc.surface).",
    ),
    "disc.synthetic.seed": _seed,
    "disc.synthetic.hurst": (
        Weight.LITTLE,
        f"{FINE} 0.6 or 1 in place of 0.8 changes the area by 1 % at most, from 3 mm on.",
    ),
    "disc.synthetic.roll_off": (
        Weight.CHANGES,
        f"{FINE} half or twice of it changes the area by about 3 %, from 3 mm on.",
    ),
    "disc.synthetic.cut_off": (
        Weight.CHANGES,
        "The shortest wave sets the slopes, and so the contact before wear on the half-space. "
        f"{FINE} twice of it changes the area by 1 % at most, from 3 mm on.",
    ),
    "disc.synthetic.period": _period,
    "grid.extent": (
        Weight.LITTLE,
        "Nothing as long as the contact keeps off its edge, which is checked. "
        f"{FINE} 2 mm in place of 1.5 mm changes the area by 1.3 % after 3 mm and by 0.2 % later.",
    ),
    "sliding.speed": (Weight.LITTLE, "The time axis, and nothing else."),
    "sliding.shift": _shift,
    "sliding.plastic": _plastic,
    "sliding.track": _track,
    "stepping.first": _FINENESS,
    "stepping.growth": _FINENESS,
    "stepping.largest": _FINENESS,
    "junctions.surface_energy": _surface_energy,
}
