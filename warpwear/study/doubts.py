"""Say what is doubtful of a study that can be computed."""

import math
from collections.abc import Iterator

from warpwear.errors import sentences
from warpwear.laws.archard import BODIES, CALLED
from warpwear.laws.fretting import HONEST_MEAN
from warpwear.laws.pieces import Pieces
from warpwear.laws.track import is_whole
from warpwear.study.bodies import Synthetic
from warpwear.study.content import Content
from warpwear.study.keys import attribute_of
from warpwear.study.motion import in_words
from warpwear.study.rules import CELLS, diameter, longest_step, um, unstable, without_unit
from warpwear.study.rules_track import enough, sides_of, summits, widths_with, worn_patch, worn_widths
from warpwear.study.units import LineLoad

say = sentences("doubts")
#: Extent over worn patch below which roughness may fill the domain.
CLOSE = 1.05
#: Half width of a scar over the radius up to which a parabola stands for a circle, to 1 %.
PARABOLIC = 0.2
#: Part of a stroke from which on the travel before slip is told.
STICKING = 0.05
#: Part of the thickness of a piece that a cell at the hardness may lose in a step.
OF_THICKNESS = 0.5
#: Layers over the half width of the contact up to which the bodies below them decide how it yields.
THIN = 0.05
#: A hardness is seldom known better than this, relatively.
SCATTER = 0.2


def doubts(study: Content) -> Iterator[str]:
    """Yield a sentence about each thing that is computed as asked for, but whose numbers mislead."""
    of_whole = (_of_mean, _of_track, _of_extent, _of_line_load, _of_seam, _of_hardness, _of_film)
    for doubt in (_of_unused_keys, *of_whole, _of_layers):
        yield from doubt(study)
    of_parts = (_of_parabola, _of_pieces, _of_steps, _of_part)
    yield from dict.fromkeys(
        text for _, part in study.telling_parts for doubt in of_parts for text in doubt(part)
    )


def _of_unused_keys(study: Content) -> Iterator[str]:
    """Yield a sentence about each reason why keys are given but not used."""
    reasons: dict[str, list[str]] = {}
    for name, why in study.unused_keys.items():
        if name in study.given_keys:
            reasons.setdefault(why, []).append(name)
    for why, names in reasons.items():
        yield f"{', '.join(names)} {why if len(names) == 1 else why.replace('does not', 'do not', 1)}."


def _of_part(study: Content) -> Iterator[str]:
    """Yield sentences about the pace, explicit steps, patches and the bearing curve of a block."""
    speed, pace = study.sliding.speed, study.sliding.pace
    if speed is not None and pace is not None and abs(speed - pace) > 0.01 * pace:
        yield say("pace", speed=60.0 * speed, pace=60.0 * pace)
    if (beyond := unstable(study)) is not None:
        yield say("unstable", beyond=beyond)
    if study.samples_area:
        yield say("patches", width=1e3 * study.patches.patch_width, macro_cell=1e3 * study.patches.macro_cell)
    if study.wear.law == "bearing-curve":
        yield say("bearing_curve")


def _of_parabola(study: Content) -> Iterator[str]:
    """Yield a sentence about a crowned body whose scar gets so wide that it is no parabola any more."""
    form, patch = study.counter.form, worn_patch(study)
    curvature = max(form.along, form.across)
    if study.counter.shape in ("crowned", "cylinder") and 0.5 * patch * curvature > PARABOLIC:
        yield say("parabola", study=study, patch=patch, percent=25.0 * (patch * curvature / 2.0) ** 2)


def _of_film(study: Content) -> Iterator[str]:
    """Yield a sentence about a film on a body that does not wear: no cell ever loses it."""
    film = study.friction.film
    for body, law in zip(BODIES, study.wear_laws, strict=True):
        if film is not None and film.bodies in ("both", body) and not law.wears:
            yield say("unworn_film", body=body, called=CALLED[body], film=film)


def _of_layers(study: Content) -> Iterator[str]:
    """Yield a sentence about layers so thick that the contact would feel their own elastic constants."""
    half = min(study.hertz.semi_axes) if study.hertz is not None else math.inf
    for body, profile in zip(BODIES, study.pair.profiles or (), strict=False):
        depth = profile.depths[-1]
        if not profile.graded and depth > THIN * half:
            yield say("thick_layers", body=body, depth=um(depth), part=depth / half, half_width=um(half))


def _of_hardness(study: Content) -> Iterator[str]:
    """Yield a sentence about each hardness that is given and plays no part, or one part for both bodies."""
    limit, explicit = study.contact.hardness, study.given_keys - study.assumed.keys()
    names = [name for name in ("counter.hardness", "disc.hardness") if name in explicit]
    if limit is not None and names:
        bodies = " and ".join(f"{name} = {attribute_of(study, name):g} MPa" for name in names)
        yield say("hardness_given", limit=limit, bodies=bodies, enter="enter" if len(names) > 1 else "enters")
    if bare := " and ".join(without_unit(study)):
        which = "the hardness of the softer body," if limit is None else "contact.hardness ="
        yield say("no_unit", bare=bare, which=which, study=study)


def _of_extent(study: Content) -> Iterator[str]:
    """Yield a sentence where a worn patch will all but fill the domain: roughness makes it wider."""
    if study.counter.form.is_flat or not study.is_rough:
        return
    made = study.disc.synthetic is not None
    rough = sides_of(study, widths_with(study, summits(study)))
    for (patch, extent, way), (wide, *_) in zip(sides_of(study, worn_widths(study)), rough, strict=True):
        if patch <= extent < max(CLOSE * patch, wide if patch else 0.0):
            end = f"up to {wide:.3g} mm; {enough(study)} would do" if made else "wider"
            yield say("extent", study=study, patch=patch, way=way, end=end)


def _of_line_load(study: Content) -> Iterator[str]:
    """Yield a sentence where the load of a line contact is one of the domain, a part of the line's length."""
    loads = [study.contact.load, *(part.load for part in study.block or ())]
    for load in (load for load in loads if study.is_line and load is not None):
        if not isinstance(load, LineLoad):
            yield say("line_load", study=study, load=load, per_length=load / study.grid.sides[1])


def _of_seam(study: Content) -> Iterator[str]:
    """Yield a sentence about a rough line contact whose disc does not repeat as its boundary does."""
    across = study.grid.sides[1]
    elastic = study.contact.law == "half-space" and study.boundary == "line" and study.cells.ny > 1
    if elastic and not _repeats(study.disc.synthetic, across, across=True):
        yield say("seam", across=across)


def _of_track(study: Content) -> Iterator[str]:
    """Yield a sentence about each thing of a track that misleads."""
    if not study.is_swept:
        return
    sliding = study.sliding
    step = study.shift * study.grid.cell
    first = 2.0 * math.sqrt(study.blocks[0].load / (math.pi * study.hardness))
    if step > first > 0.0:
        yield say("gaps", study=study, step=1e3 * step, first=1e3 * first)
    local = study.contact.law == "local" and not study.uses_bearing_area
    if local and math.isinf(study.pair.stiffness):
        finer = "sliding.shift" if study.shift > 1 else "grid.cell"
        yield say("step_yields", study=study, finer=finer)
    radius = sliding.track_radius
    if radius is not None and radius < 2.0 * study.grid.sides[1]:
        yield say("near_the_middle", radius=radius)
    made = study.disc.synthetic  # what a file holds tells `Measured.lap_seam`
    if sliding.track != "full" and made is not None and not _repeats(made, float(sliding.track)):
        yield say("lap_seam", length=float(sliding.track))
    yield from _of_sticking(study)


def _of_mean(study: Content) -> Iterator[str]:
    """Yield a sentence about a stroke too long for one pressure, or about bodies that yield unalike."""
    if study.fretting is None:
        return
    ratio, drives = study.stroke_ratio, study.sliding.drives_bodies
    if ratio > HONEST_MEAN and not drives:
        yield say("long_stroke", ratio=ratio, most=HONEST_MEAN)
    first, second = study.counter.elastic, study.disc.elastic
    if drives and first and second and first != second:
        yield say("unlike_bodies")


def _of_sticking(study: Content) -> Iterator[str]:
    """Yield a sentence about a stroke so short that what the bodies yield before they slip matters to it."""
    stroke, coefficient, hertz = study.sliding.stroke, study.friction.coefficient, study.hertz
    if stroke is None or hertz is None or hertz.is_line or study.friction.fitted in (None, "states"):
        return
    travel = 2.0 * study.pair.displacement()
    if travel > STICKING * stroke:
        yield say("slip_alone", stroke=in_words(stroke), travel=1e3 * travel, coefficient=coefficient)


def _repeats(disc: Synthetic | None, length: float, *, across: bool = False) -> bool:
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


def _of_pieces(study: Content) -> Iterator[str]:
    """Yield a sentence about each thing that is computed as asked for, but whose numbers mislead."""
    pieces = study.pair.pieces
    if pieces is None:
        return
    if study.wear.particle == "critical":
        yield _of_critical(study, pieces)
    if pieces.diameter < CELLS * study.grid.cell * (1.0 - 1.0e-9):
        cells = pieces.diameter / study.grid.cell
        yield say(
            "coarse_pieces", diameter=diameter(study, pieces), cells=cells, needed=um(pieces.diameter / CELLS)
        )


def _of_steps(study: Content) -> Iterator[str]:
    """Yield a sentence where a step takes more off a cell at the hardness than the pieces bear."""
    pieces = study.pair.pieces
    if pieces is None or not math.isfinite(study.hardness):
        return
    slid, fraction = longest_step(study)
    allowed = OF_THICKNESS * pieces.thickness
    for name, law, part in zip(BODIES, study.wear_laws, (1.0, fraction), strict=True):
        depth = law.fastest * study.hardness * part * slid
        if depth > allowed * (1.0 + 1.0e-9):
            cells = math.floor(study.shift * allowed / depth) if study.is_swept else 0
            shorter = f"sliding.shift = {cells}" if cells else "a smaller grid.cell"
            if not study.is_swept:
                shorter = f"increments of {slid * allowed / depth:.2g} mm or less (stepping)"
            yield say(
                "long_steps",
                called=CALLED[name],
                depth=um(depth),
                thickness=um(pieces.thickness),
                shorter=shorter,
            )


def _of_critical(study: Content, pieces: Pieces) -> str:
    """Return a sentence about the number that 'critical' comes to, and how little is known of it."""
    strength = study.pair.junction_strength or 0.0
    low, high = (pieces.diameter / (1.0 + sign * SCATTER) ** 2 for sign in (1.0, -1.0))
    if study.junctions.strength is None:
        by = f"by the softer body's hardness of {study.pair.softer_hardness:g} MPa, and goes with 1/H²: H"
    else:
        by = f"by junctions.strength = {strength:g} MPa, and goes with 1/σ_j²: one"
    return say(
        "critical", diameter=um(pieces.diameter), by=by, scatter=100.0 * SCATTER, low=um(low), high=um(high)
    )
