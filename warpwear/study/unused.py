"""Keys of a study that nothing uses under the choices made."""

from warpwear.study import rules_track as track_checks
from warpwear.study.bodies import Synthetic
from warpwear.study.content import Content
from warpwear.study.keys import given_keys
from warpwear.study.settings import Macro

#: Keys of [disc] that say how a measured file is read and prepared.
OF_FILES = (
    "extend",
    "pixel",
    "height_unit",
    "array",
    "height_sign",
    "crop",
    "sliding_axis",
    "outliers",
    "level",
    "s_filter",
    "l_filter",
)

#: Keys of [wear] -> the law that has them.
OF_WEAR_LAWS = {
    "decay": "exponential",
    "running_in": "running-in",
    "initial_sphere": "running-in",
    "initial_disc": "running-in",
}

#: Keys of [disc.synthetic] that each kind has no use for.
UNUSED_BY_KIND: dict[str, tuple[str, ...]] = {
    "flat": ("ra", "sq", "hurst", "roll_off", "cut_off", "seed", "period", "feed", "fine_ra", "lay"),
    "self-affine": ("feed", "fine_ra", "lay"),
    "milled": (),
}


def inapplicable(study: Content) -> dict[str, str]:
    """Keys that nothing uses under the choices made -> why, as the end of a sentence."""
    found: dict[str, str] = {}
    macro = study.study.model == "macro"
    synthetic = study.disc.synthetic
    if macro and study.wear.law != "bearing-curve":
        of_surface = [f"disc.{k}" for k in ("surface", *OF_FILES)]
        of_surface += [f"disc.synthetic.{k}" for k in Synthetic.model_fields]
        found |= dict.fromkeys(of_surface, "does not apply to the macro model, which has a smooth disc")
    elif synthetic is not None:
        why = f"does not apply to kind = '{synthetic.kind}'"
        found |= dict.fromkeys((f"disc.synthetic.{k}" for k in UNUSED_BY_KIND[synthetic.kind]), why)
        found |= dict.fromkeys((f"disc.{k}" for k in OF_FILES), "does not apply to a synthetic surface")
    if macro:
        found["contact.stiffness"] = "does not apply to the macro model: its K_N is contact.foundation"
    if study.study.model != "two-scale":
        of_patches = [f"macro.{k}" for k in Macro.model_fields]
        found |= dict.fromkeys(
            of_patches, f"does not apply to the {study.study.model} model: it has no patches"
        )
    else:
        if study.macro.patch_width == study.macro.cell:
            found["macro.placement"] = "does not apply: the patches tile the contact"
        if study.macro.patch_width == study.macro.cell or study.macro.placement == "centre":
            found["macro.seed"] = "does not apply: no patch is placed at random"
        if study.macro.coupling == "load":
            found["macro.bulk"] = "does not apply to macro.coupling = 'load', whose macro contact has K_N"
    if not study.uses_foundation:
        of_macro = ("contact.foundation", "contact.foundation_update")
        why = "the micro model" if study.study.model == "micro" else "macro.bulk = 'none'"
        found |= dict.fromkeys(of_macro, f"does not apply to {why}")
    if study.contact.law == "half-space":
        found["contact.stiffness"] = "does not apply to contact.law = 'half-space': E* of both bodies does"
    else:
        found["contact.boundary"] = "does not apply to contact.law = 'foundation'"
    for name, law in OF_WEAR_LAWS.items():
        if law != study.wear.law:
            found[f"wear.{name}"] = f"does not apply to wear.law = '{study.wear.law}'"
    if not study.uses_bearing_area:
        found["stepping.load_tolerance"] = "does not apply: with compliance the balance holds to 1e-12"
    found |= track_checks.inapplicable(study)
    if study.stepping.increment is not None and not study.is_swept:
        growing = ("stepping.first", "stepping.growth", "stepping.largest")
        found |= dict.fromkeys(growing, "does not apply to a fixed stepping.increment")
    if study.friction.shear_strength is not None:
        measured = ("friction.coefficient", "friction.calibrate")
        found |= dict.fromkeys(measured, "does not apply with a friction.shear_strength")
    return found


def told(study: Content) -> list[str]:
    """What is given but not used, each as a sentence."""
    given = given_keys(study)
    reasons: dict[str, list[str]] = {}
    for key, why in inapplicable(study).items():
        if key in given:
            reasons.setdefault(why, []).append(key)
    return [
        f"{', '.join(keys)} {why if len(keys) == 1 else why.replace('does not', 'do not', 1)}."
        for why, keys in reasons.items()
    ]
