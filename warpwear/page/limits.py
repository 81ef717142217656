"""What the model of a run cannot show: the sentences of docs/theory/limits.md that apply to it."""

from collections.abc import Callable

from warpwear.study.study import Study


def _slides(study: Study) -> bool:
    return study.sliding.total > 0.0


def _is_local(study: Study) -> bool:
    return study.contact.law == "local"


def _is_two_scale(study: Study) -> bool:
    return study.study.model == "two-scale"


#: When a sentence applies, and the sentence.
LIMITS: tuple[tuple[Callable[[Study], bool], str], ...] = (
    (lambda s: not _slides(s), "Nothing slides: this is the contact before the first wear."),
    (
        lambda s: _slides(s) and not s.is_swept,
        "The disc lies still: the same cells stay under the sphere for the whole distance. Once the bodies "
        "conform, "
        "area, pressure and friction are those of a smooth disc, and the disc gets far deeper than on a "
        "track.",
    ),
    (
        lambda s: _slides(s) and s.is_swept,
        "On a track the area rises with the distance. Nothing there is fitted, and none of it levels off.",
    ),
    (
        lambda s: s.is_swept and s.track.track_fraction < 1.0,
        "A lap of the track stands for a whole pass: the sphere meets a short piece of the disc again and "
        "again.",
    ),
    (
        lambda s: s.is_swept and _is_local(s),
        "Where the sphere slides, the local law yields by nothing but the wear of the step. Its area "
        "therefore falls "
        "with the length of the step (sliding.shift). The cure is contact.law = 'half-space'.",
    ),
    (lambda s: not s.is_rough, "The disc is smooth: nothing on this page comes from roughness."),
    (
        lambda s: s.is_rough and _is_local(s),
        "Asperities do not feel each other: the contact law is local. How much that matters depends on "
        "H/(E*·rms slope) of the disc. contact.law = 'half-space' couples them.",
    ),
    (
        lambda s: s.is_rough and s.disc.synthetic is None,
        "The result depends on the shortest wave of the surface, which the measurement's pixel or filter "
        "decides.",
    ),
    (
        lambda s: s.is_rough and s.disc.synthetic is not None and s.disc.synthetic.kind != "flat",
        "The disc is made by random numbers, not measured. The result depends on its shortest wave "
        "(disc.synthetic.cut_off).",
    ),
    (
        lambda s: s.samples_area,
        "Patches that stand for more than themselves are off by up to 40 % in the area on the way, although "
        "they end "
        "within 3 %.",
    ),
    (
        lambda s: _is_two_scale(s) and s.patches.coupling == "load",
        "Loads that a smooth contact prescribes lie at first to 60 % on the wrong patches.",
    ),
    (
        lambda s: _is_two_scale(s) and not _is_local(s),
        "Patches on the half-space do not lift their neighbours.",
    ),
    (
        lambda s: s.friction.fitted is not None,
        "The coefficient of friction is an input: the shear strength is fitted so that it is met. The run "
        "computes "
        "the shape of its course, not its height.",
    ),
    (
        lambda s: s.friction.fitted is None,
        "Friction is calibrated, not predicted: it follows the area by the shear strength that the study "
        "gives. Every "
        "kind of area asks for another strength; they differ by a factor of a hundred and more.",
    ),
    (
        lambda s: bool(s.friction.law.said),
        "A shear strength that runs in, and an offset for ploughing, are empirical fits.",
    ),
    (
        lambda s: s.wear.sheds,
        "Size, thickness and start of the pieces are choices, which move the distances at which they leave "
        "severalfold.",
    ),
    (
        _slides,
        "Wear debris, transfer, work hardening, heat and speed are not modelled. The speed only sets the "
        "time axis.",
    ),
    (
        _slides,
        "Volumes equal to K F L validate nothing: any pressure field gives them. Look at areas and "
        "pressures.",
    ),
)


def limits_of(study: Study) -> list[str]:
    """List the sentences that apply to the runs of a study."""
    return [sentence for applies, sentence in LIMITS if applies(study)]
