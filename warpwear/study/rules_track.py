"""Rules of a study whose counter-body slides over a track."""

import math
from collections.abc import Iterator

from warpwear.laws.fretting import HONEST_MEAN, displacement, softness_ratio
from warpwear.laws.track import WHOLE, is_whole
from warpwear.study.bodies import Synthetic
from warpwear.study.content import Content
from warpwear.surfaces.form import Form

#: Part of a stroke from which on the travel before slip is told.
STICKING = 0.05


def check(study: Content) -> None:
    """Refuse a track that cannot be computed as it is asked for: raises ValueError with one sentence."""
    sliding, cell, extent = study.sliding, study.grid.cell, study.grid.sides[0]
    lap = sliding.lap
    if lap is None:
        return
    named = f"sliding.stroke = {lap:g} mm"
    if sliding.track_radius is not None:
        named = f"sliding.track_radius = {sliding.track_radius:g} mm (a track of {lap:.4g} mm)"
    if not study.is_swept:
        if sliding.kinematics is None and study.fretting is None:
            raise ValueError(
                f"{named}: in the {study.study.model} model the disc lies still; allowed are study.model = "
                "'micro', in which the counter-body slides, and sliding.kinematics = 'stationary'"
            )
        return
    if sliding.track != "full":
        length = float(sliding.track)
        step = study.shift * cell
        steps = length / step
        if not is_whole(steps):
            least, most = math.ceil(extent / step * (1.0 - WHOLE)), math.floor(lap / step * (1.0 + WHOLE))
            # What a file has too little of, a longer track would lack as well.
            of_file = study.disc.synthetic is None and study.disc.extend == "refuse"
            near = min(max(math.floor(steps) if of_file else round(steps), least), most) * step
            allowed = f"the nearest allowed is {near:.9g} mm"
            raise ValueError(
                f"sliding.track = {length:g} mm is not a whole number of steps of sliding.shift = "
                f"{study.shift} cells, {1e3 * step:g} µm; "
                f"{allowed if least <= most else 'a smaller sliding.shift is needed'}"
            )
        if length > lap * (1.0 + WHOLE):
            raise ValueError(
                f"sliding.track = {length:g} mm is longer than {named}: allowed are shorter ones, or 'full'"
            )
    elif sliding.track_radius is None:
        refuse_parts("sliding.stroke", lap, cell)
    track = study.track
    if track.periodic and track.cells < track.window:
        whose = f"sliding.track = {sliding.track:g} mm" if sliding.track != "full" else named
        raise ValueError(
            f"{whose} is shorter than grid.extent = {study.grid.size}: the counter-body would lie on the "
            "same cells twice; allowed are a longer track and a smaller grid.extent"
        )
    if track.cells < study.shift:
        raise ValueError(
            f"sliding.shift = {study.shift} cells of {1e3 * cell:g} µm is longer than {named}; a smaller "
            "sliding.shift is needed"
        )


def refuse_parts(name: str, length: float, cell: float, *, cells: str = "") -> None:
    """Refuse a length [mm] that is no whole number of cells: raises ValueError. cells: size of these."""
    if not is_whole(length / cell):
        near = max(round(length / cell), 1) * cell
        raise ValueError(
            f"{name} = {_in_words(length)} is not a whole number of cells of {cells or _in_words(cell)}; the "
            f"nearest that is, is {_in_words(near)}"
        )


def _in_words(length: float) -> str:
    """Return a length [mm] in mm, or below 0.1 mm in µm."""
    return f"{length:.9g} mm" if length >= 0.1 else f"{1e3 * length:.6g} µm"


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
    counter, disc = (study.volume(law, total) for law in study.wear_laws)
    lap = study.sliding.lap
    at_rest = _held(form, form.worn(counter + disc, domain))
    if study.fretting is not None:
        return _of_fretting(study, at_rest)
    if not study.is_swept or lap is None:
        return at_rest
    of_groove = Form(across=form.across)
    groove = of_groove.worn(disc, (lap, domain[1]))[1] if total > lap and form.across else 0.0
    along, across = (
        min(max(moving, groove), still)
        for moving, still in zip(_held(form, form.worn(counter, domain)), at_rest, strict=True)
    )
    return along, across


def _of_fretting(study: Content, at_rest: tuple[float, float]) -> tuple[float, float]:
    """Return the widths of scars [mm] that a stroke makes longer; of what may stick, of the contact alone."""
    lap, hertz = study.sliding.lap or 0.0, study.hertz
    if not study.sliding.drives_bodies:
        return at_rest[0] + lap * (at_rest[0] > 0.0), at_rest[1]
    if hertz is None or study.slides_by > 0.0:
        return at_rest
    along, across = hertz.semi_axes
    return _held(study.counter.form, (2.0 * along, 2.0 * across))


def _held(form: Form, widths: tuple[float, float]) -> tuple[float, float]:
    """Return the widths [mm] that the domain must hold: those towards which a form rises."""
    along, across = (width if rises else 0.0 for width, rises in zip(widths, form.rises, strict=True))
    return along, across


def extent_for(study: Content, distance: float) -> tuple[float, float]:
    """Return the sides [mm] that a test needs whose contact fills its own after a distance [mm].

    What the contact is wider by than the worn patch of smooth bodies stays, as that grows.
    """
    widths = zip(study.grid.sides, worn_widths(study), worn_widths(study, distance), strict=True)
    along, across = (side + end - now for side, end, now in widths)
    return along, across


def unstable(study: Content) -> str | None:
    """Return the start of a sentence about a shift too large for explicit steps; None where it is not."""
    compliance = 1.0 / study.stiffness
    track = study.track
    counter, disc = (law.fastest for law in study.wear_laws)
    slid = min(track.shift * track.stroke / track.cells, study.sliding.total)
    removal = (counter + track.track_fraction * disc) * slid
    if compliance == 0.0 or removal < 2.0 * compliance:
        return None
    return (
        f"sliding.shift = {track.shift} cells, which removes {removal:.3g} mm³/N a step, is beyond the "
        f"explicit stability limit 2/k = {2.0 * compliance:.3g} mm³/N"
    )


def doubts(study: Content) -> Iterator[str]:
    """Yield a sentence about each thing that is computed as asked for, but whose numbers mislead."""
    if study.fretting is not None:
        yield from _of_mean(study)
    if not study.is_swept:
        return
    sliding = study.sliding
    step = study.shift * study.grid.cell
    first = 2.0 * math.sqrt(study.blocks[0].load / (math.pi * study.hardness))
    if step > first > 0.0:
        yield (
            f"sliding.shift = {study.shift} cells, {1e3 * step:g} µm, is longer than a contact at the "
            f"hardness, {1e3 * first:.3g} µm: at first the disc is worn in places only."
        )
    local = study.contact.law == "local" and not study.uses_bearing_area
    if local and math.isinf(study.stiffness):
        finer = "sliding.shift" if study.shift > 1 else "grid.cell"
        yield (
            f"sliding.shift = {study.shift} cells: by contact.law = 'local' with contact.stiffness = inf "
            "bodies yield by the wear of a step alone, so the area in contact depends on its length, up to "
            "in proportion to it on a smooth or run-in disc under a ball that hardly wears; the cure is "
            f"contact.law = 'half-space', else to halve {finer} until the area stays."
        )
    radius = sliding.track_radius
    if radius is not None and radius < 2.0 * study.grid.sides[1]:
        yield (
            f"sliding.track_radius = {radius:g} mm: the track is computed straight, though the contact is "
            "wide beside its radius."
        )
    if sliding.track != "full" and not repeats(study.disc.synthetic, float(sliding.track)):
        yield (
            f"The disc's surface does not repeat after sliding.track = {float(sliding.track):g} mm: it has a "
            "seam where the lap closes."
        )
    yield from _of_sticking(study)


def _of_mean(study: Content) -> Iterator[str]:
    """Yield a sentence about a stroke too long for one pressure, or about bodies that yield unalike."""
    ratio, drives = study.stroke_ratio, study.sliding.drives_bodies
    if ratio > HONEST_MEAN and not drives:
        yield (
            f"sliding.positions = 'mean': the stroke is {ratio:.2g} of the scar's width, and depths of the "
            f"bodies are off by some per cent beyond {HONEST_MEAN:g}; 'cells' solves each place."
        )
    first, second = study.counter.elastic, study.disc.elastic
    if drives and first and second and first != second:
        yield (
            "sliding.force or sliding.stroke_of = 'body': the bodies' elastic constants differ, and what "
            "that adds (friction changes the pressure) is left out."
        )


def _of_sticking(study: Content) -> Iterator[str]:
    """Yield a sentence about a stroke so short that what the bodies yield before they slip matters to it."""
    stroke, coefficient, hertz = study.sliding.stroke, study.friction.coefficient, study.hertz
    bodies = study.counter.elastic, study.disc.elastic
    if stroke is None or hertz is None or hertz.is_line or study.friction.fitted is None:
        return
    kappa = softness_ratio(*(body for body in bodies if body is not None))
    travel = 2.0 * displacement(hertz, kappa, coefficient)
    if travel > STICKING * stroke:
        yield (
            f"sliding.stroke = {_in_words(stroke)} is slip: smooth bodies like these at a coefficient of "
            f"{coefficient:g} yield by {1e3 * travel:.3g} µm before they slip (Mindlin), so the drive of "
            "such a test travels as much farther."
        )


def repeats(disc: Synthetic | None, length: float, *, across: bool = False) -> bool:
    """Tell whether the disc's surface closes on itself after a length [mm] along, or across, sliding."""
    if disc is None:  # a file: nothing says that it does
        return False
    if disc.kind == "flat":
        return True
    closes = is_whole(length / disc.period) or (disc.kind == "milled" and disc.fine_ra == 0.0)
    if disc.kind == "milled":
        turned = math.radians(disc.lay + 90.0 * across)
        way = abs(round(math.sin(turned), 12))
        closes = closes and (way == 0.0 or is_whole(length * way / disc.feed))
    return closes
