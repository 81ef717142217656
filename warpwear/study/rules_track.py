"""Rules of a track, of patches and of layers, and how wide what is worn will be."""

import math
from collections.abc import Iterator
from statistics import NormalDist

from warpwear.laws.archard import BODIES
from warpwear.laws.form import Form
from warpwear.laws.track import WHOLE
from warpwear.study.content import Content
from warpwear.study.keys import refused
from warpwear.study.motion import refuse_parts
from warpwear.study.sections.layers import LayerSection

#: Extent over worn patch that a sentence recommends.
SPARE = 1.1
#: Height of the highest summit over Sq of a random surface: one of millions is higher.
MOST_SUMMIT = 5.0
#: Sq over Ra of a random surface.
OF_GAUSSIAN = math.sqrt(0.5 * math.pi)
#: Expected number of which there is none once in a hundred times.
NONE_SUCH = 4.6


def check(study: Content) -> None:
    """Refuse a track that cannot be computed as it is asked for: raises ValueError with one sentence."""
    sliding, cell = study.sliding, study.grid.cell
    lap = sliding.lap
    if lap is None:
        return
    named = f"sliding.stroke = {lap:g} mm"
    if sliding.track_radius is not None:
        named = f"sliding.track_radius = {sliding.track_radius:g} mm (a track of {lap:.4g} mm)"
    if not study.is_swept:
        if sliding.kinematics is None and study.fretting is None:
            raise refused("still_disc", named=named, study=study)
        return
    if sliding.track != "full":
        length = float(sliding.track)
        step = study.shift * cell
        steps = f"steps of sliding.shift = {study.shift} cells, {1e3 * step:g} µm"
        refuse_parts("sliding.track", length, step, of=steps)
        if length > lap * (1.0 + WHOLE):
            raise refused("long_track", length=length, named=named)
    elif sliding.track_radius is None:
        refuse_parts("sliding.stroke", lap, cell)
    track = study.track
    if track.periodic and track.cells < track.window:
        whose = f"sliding.track = {sliding.track:g} mm" if sliding.track != "full" else named
        raise refused("short_track", whose=whose, study=study)
    if track.cells < study.shift:
        raise refused("long_shift", study=study, cell=1e3 * cell, named=named)


def check_patches(study: Content) -> None:
    """Refuse patches that do not fit the domain, by InputError."""
    patches, cell = study.patches, study.grid.cell
    refuse_parts("patches.macro_cell", patches.macro_cell, cell)
    refuse_parts("patches.width", patches.patch_width, cell)
    named = f"patches.macro_cell = {1e3 * patches.macro_cell:g} µm"
    if patches.patch_width > patches.macro_cell * (1.0 + WHOLE):
        raise refused("wide_patch", width=1e3 * patches.patch_width, named=named)
    extent, across = study.grid.sides
    if extent != across:
        raise refused("oblong_patches", study=study)
    if patches.macro_cell > 0.5 * extent * (1.0 + WHOLE):
        raise refused("macro_cell", named=named, extent=extent)
    refuse_parts("grid.extent", extent, patches.macro_cell, of=f"cells of {named}")


#: How bodies move, or "patches", and the contact law, of studies whose steps follow materials by depth.
FOLLOWED: tuple[tuple[str, str], ...] = (
    *((how, law) for law in ("local", "half-space") for how in ("swept", "stationary", "patches")),
    ("fretting", "half-space"),
)


def check_layers(study: Content) -> None:
    """Refuse materials by depth that do not go with the rest: raises ValueError with one sentence."""
    for body, law, profile in zip(BODIES, study.wear_laws, study.pair.profiles or (None, None), strict=True):
        section = getattr(study, body)
        for number, layer in enumerate(section.layers or (), 1):
            _check_layer(study, f"{body}.layers.{number}", layer)
        if section.gradient is None or profile is None:
            continue
        graded = len(section.gradient[0]) > 2
        if graded:
            _check_hardness(study, f"{body}.gradient")
        own, last = (law.steady, section.hardness), profile.materials[-1]
        if not all(map(math.isclose, (last.wear, last.hardness), own) if graded else (last.wear == own[0],)):
            numbers = " and ".join(f"{number:g}" for number in section.gradient[-1][1:])
            raise refused("gradient_end", body=body, numbers=numbers)
    how = "patches" if study.study.model == "two-scale" else study.kinematics
    how += " by slips of each cell" * study.sliding.drives_bodies
    if study.pair.profiles is not None and (how, study.contact.law) not in FOLLOWED:
        raise refused(
            "unfollowed_layers", study=study, how=how, allowed=" or ".join(map(", ".join, FOLLOWED)) or "none"
        )


def _check_layer(study: Content, named: str, layer: LayerSection) -> None:
    friction = study.friction
    if layer.hardness is not None:
        _check_hardness(study, f"{named}.hardness")
    if layer.wear.per_energy != (study.wear.law == "energy"):
        raise refused("layer_wear", named=named, wear=layer.wear.write(), study=study)
    for key in (key for key in ("shear_strength", "coefficient") if getattr(layer, key) is not None):
        if friction.shear_strength is None:
            raise refused("layer_shear", named=named, key=key)
        if friction.initial_ratio is not None:
            raise refused("layer_running_in", named=named, key=key)


def _check_hardness(study: Content, named: str) -> None:
    if study.contact.hardness is not None or study.study.model == "macro":
        raise refused("layer_hardness", named=named)


def worn_patch(study: Content) -> float:
    """Return the wider of the `worn_widths` of the whole test [mm]."""
    return max(worn_widths(study))


def worn_widths(study: Content, distance: float | None = None) -> tuple[float, float]:
    """Return the widths of smooth bodies' worn patch along and across [mm]; roughness makes it wider.

    distance: by default the whole test [mm].

    On a disc that lies still both bodies lose the overlap of the counter-body with a plane, π a⁴/4R of a
    paraboloid, whatever the pressure. One that slides loses that overlap alone; or, where it hardly wears,
    its groove is a segment of its own circle, 2a³/3R in section. Of a stroke shorter than that the disc at
    rest tells more. They are what the domain must hold, 0 where the counter-body does not rise; the domain's
    own where it is as large.
    """
    form, domain = study.counter.form, study.grid.sides
    total = study.sliding.total if distance is None else distance
    if form.is_flat:
        return domain
    counter, disc = study.volumes(total)
    lap = study.sliding.lap
    at_rest = _held(form, form.worn(counter + disc, domain))
    if study.fretting is not None:
        return _of_fretting(study, at_rest)
    if not study.is_swept or lap is None:
        return at_rest
    of_groove, place = Form(across=form.across), (lap, domain[1])
    groove = 0.0
    if total > lap and form.across:
        groove = of_groove.worn(study.volumes(total, of_groove, place)[1], place)[1]
    along, across = (
        min(max(moving, groove), still)
        for moving, still in zip(_held(form, form.worn(counter, domain)), at_rest, strict=True)
    )
    return along, across


def _of_fretting(study: Content, at_rest: tuple[float, float]) -> tuple[float, float]:
    """Return the widths of scars [mm] that a stroke makes longer; of what may stick, of the contact alone."""
    sliding, hertz = study.sliding, study.hertz
    lap, limit = sliding.lap or 0.0, study.friction.coefficient * study.contact.load
    if not sliding.drives_bodies:
        return at_rest[0] + lap * (at_rest[0] > 0.0), at_rest[1]
    slips = 0.5 * lap - sliding.rig_compliance * limit  # by as much a drive moves the bodies
    if hertz is None or (sliding.force is None and slips - study.pair.displacement() > 0.0):
        return at_rest
    along, across = hertz.semi_axes
    return _held(study.counter.form, (2.0 * along, 2.0 * across))


def _held(form: Form, widths: tuple[float, float]) -> tuple[float, float]:
    """Return the widths [mm] that the domain must hold: those towards which a form rises."""
    along, across = (width if rises else 0.0 for width, rises in zip(widths, form.rises, strict=True))
    return along, across


def extent_for(study: Content, distance: float) -> tuple[float, float]:
    """Return the sides [mm] that a test needs whose contact fills its own after a distance [mm].

    What the contact is wider by than the worn patch of smooth bodies stays, as that grows; and what is
    foreseen of roughness is the least.
    """
    ends = zip(study.grid.sides, worn_widths(study), worn_widths(study, distance), strict=True)
    sides = (side + end - now for side, end, now in ends)
    along, across = map(max, sides, widths_with(study, summits(study)))
    return along, across


def summits(study: Content) -> float:
    """Return how far a made surface's summits rise over its mean plane at most [mm]; 0 of others."""
    made = study.disc.synthetic if study.is_rough else None
    if made is None:
        return 0.0
    rough = made.sq or OF_GAUSSIAN * (made.ra or 0.0)
    return MOST_SUMMIT * (rough if made.kind == "self-affine" else OF_GAUSSIAN * made.fine_ra + rough)


def _sure_rise(study: Content) -> float:
    """Return by how much summits along both edges of a groove surely rise over what is worn [mm].

    As many as a track has, of half the longest wave each; the disc's wear has worn some down to a level over
    its mean plane, which they do not rise over.
    """
    made, lap = study.disc.synthetic, study.sliding.lap
    if not study.is_swept or lap is None or made is None or made.kind != "self-affine":
        return 0.0
    along, across = worn_widths(study)
    count = 4.0 * min(study.track.cells * study.grid.cell, made.period) / made.roll_off
    if not (across and along) or count <= NONE_SUCH:
        return 0.0
    rough, gaussian = made.sq or OF_GAUSSIAN * (made.ra or 0.0), NormalDist()
    depth, level = study.volumes(study.sliding.total)[1] / (lap * across) / rough, -8.0
    for part in (2.0**-power for power in range(-3, 20)):  # the highest level down to which that was worn
        up = level + part
        level = up if gaussian.pdf(up) - up * gaussian.cdf(-up) > depth else level
    return rough * max(0.0, gaussian.inv_cdf(min(1.0 - NONE_SUCH / count, 1.0 - 1e-9)) - level - depth)


def widths_with(study: Content, summit: float) -> tuple[float, float]:
    """Return the widths [mm] along and across that the contact may come to over rough bodies.

    summit: height of the disc's roughness over its mean plane [mm]. Where the counter-body at its worn depth,
    or pressed on, would still touch it.
    """
    form, hertz, lap = study.counter.form, study.hertz, study.sliding.lap
    if study.counter.shape == "pin":
        return 2.0 * form.reach, 2.0 * form.reach
    widths = [*worn_widths(study)]
    for axis, curvature in enumerate((form.along, form.across)):
        if not form.rises[axis]:
            widths[axis] = 0.0
            continue
        if hertz is not None:
            widths[axis] = max(widths[axis], 2.0 * hertz.semi_axes[axis])
        if axis == 0 and study.is_swept and lap is not None and lap < widths[0]:
            widths[0] += lap  # a stroke that the contact does not leave widens it
        widths[axis] = math.hypot(widths[axis], math.sqrt(8.0 * summit / curvature) if curvature else 0.0)
    return widths[0], widths[1]


def too_small(study: Content) -> str | None:
    """Return a sentence, without its dot, about a domain that will not hold the worn patch; else None.

    Patches wider than the radius are left to the run.
    """
    if study.counter.form.is_flat:
        return None
    for patch, extent, way in sides_of(study, _worn_over(study, _sure_rise(study))):
        if extent < patch < study.counter.form.most_worn:
            return (
                f"grid.extent = {study.grid.size} is too small: the worn patch will be {patch:.3g} mm wide "
                f"or more{way}; a grid.extent of {enough(study)} would do"
            )
    return None


def _worn_over(study: Content, rise: float) -> tuple[float, float]:
    """Return `worn_widths` where summits rise by so much over what is worn [mm]."""
    form = study.counter.form
    along, across = (
        math.hypot(width, math.sqrt(8.0 * rise / curvature)) if width and curvature else width
        for width, curvature in zip(worn_widths(study), (form.along, form.across), strict=True)
    )
    return along, across


def sides_of(study: Content, widths: tuple[float, float]) -> Iterator[tuple[float, float, str]]:
    """Yield a width, the domain's side [mm] and its name; of a square the wider alone."""
    sides = study.grid.sides
    if sides[0] == sides[1]:
        yield max(widths), sides[0], ""
    else:
        yield from zip(widths, sides, (" along sliding", " across sliding"), strict=True)


def enough(study: Content) -> str:
    """Return, in words, the extent that holds the contact of the whole test, with some room beside it."""
    widths = widths_with(study, summits(study))
    if not isinstance(study.grid.extent, tuple):
        return f"{spared(max(widths)):g} mm"
    given = study.grid.sides
    sides = (spared(width) if width else side for width, side in zip(widths, given, strict=True))
    return f"{' × '.join(f'{side:g}' for side in sides)} mm"


def spared(patch: float) -> float:
    """Return an extent [mm] with some room beside a patch [mm]."""
    digit = 10.0 ** (math.floor(math.log10(patch)) - 1)
    return float(f"{math.ceil(SPARE * patch / digit) * digit:.3g}")
