"""Say what is doubtful of a study that can be computed."""

import math
from collections.abc import Iterator

from warpwear.laws.archard import BODIES, CALLED
from warpwear.laws.fretting import HONEST_MEAN, displacement, softness_ratio
from warpwear.laws.pieces import Pieces
from warpwear.laws.track import is_whole
from warpwear.study.bodies import Synthetic
from warpwear.study.content import Content
from warpwear.study.keys import attribute_of
from warpwear.study.motion import in_words
from warpwear.study.rules import CELLS, diameter, longest_step, um, unstable, without_unit
from warpwear.study.rules_track import enough, sides_of, summits, widths_with, worn_patch, worn_widths
from warpwear.study.units import LineLoad

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
        yield (
            f"sliding.speed = {60.0 * speed:.4g} mm/min makes the time axis, though sliding.frequency makes "
            f"a mean speed of {60.0 * pace:.4g} mm/min."
        )
    if (beyond := unstable(study)) is not None:
        yield (
            f"{beyond}: areas, pressures and friction scatter from step to step and mean nothing, though "
            "volumes and depths look right."
        )
    if study.samples_area:
        yield (
            f"patches.width = {1e3 * study.patches.patch_width:g} µm stands for patches.macro_cell = "
            f"{1e3 * study.patches.macro_cell:g} µm: length, width and nominal area of the scar are off by "
            "up to a macro cell on each side, and so is what follows from them."
        )
    if study.wear.law == "bearing-curve":
        yield (
            "wear.law = 'bearing-curve': the area in contact is the share of the cells that bears; "
            "pressures are means over whole cells, and no hardness caps those of the share."
        )


def _of_parabola(study: Content) -> Iterator[str]:
    """Yield a sentence about a crowned body whose scar gets so wide that it is no parabola any more."""
    form, patch = study.counter.form, worn_patch(study)
    curvature = max(form.along, form.across)
    if study.counter.shape in ("crowned", "cylinder") and 0.5 * patch * curvature > PARABOLIC:
        yield (
            f"counter.shape = '{study.counter.shape}' is a parabola, and the scar will be {patch:.3g} mm "
            f"wide: at its edge a circle rises {25.0 * (patch * curvature / 2.0) ** 2:.2g} % more."
        )


def _of_film(study: Content) -> Iterator[str]:
    """Yield a sentence about a film on a body that does not wear: no cell ever loses it."""
    film = study.friction.film
    for body, law in zip(BODIES, study.wear_laws, strict=True):
        if film is not None and film.bodies in ("both", body) and not law.wears:
            yield (
                f"wear.{body} = 0: the {CALLED[body]} keeps its film, so no cell becomes bare by "
                f"friction.film.bodies = '{film.bodies}'."
            )


def _of_layers(study: Content) -> Iterator[str]:
    """Yield a sentence about layers so thick that the contact would feel their own elastic constants."""
    half = min(study.hertz.semi_axes) if study.hertz is not None else math.inf
    for body, profile in zip(BODIES, study.pair.profiles or (), strict=False):
        if not profile.graded and profile.depths[-1] > THIN * half:
            yield (
                f"{body}.layers are {um(profile.depths[-1])} thick, {profile.depths[-1] / half:.2g} of the "
                f"contact's half width of {um(half)}: their own elastic constants, which would matter, are "
                "not modelled."
            )


def _of_hardness(study: Content) -> Iterator[str]:
    """Yield a sentence about each hardness that is given and plays no part, or one part for both bodies."""
    limit, explicit = study.contact.hardness, study.given_keys - study.assumed.keys()
    names = [name for name in ("counter.hardness", "disc.hardness") if name in explicit]
    if limit is not None and names:
        bodies = " and ".join(f"{name} = {attribute_of(study, name):g} MPa" for name in names)
        yield (
            f"contact.hardness = {limit:g} MPa is the largest pressure of a cell: {bodies} only "
            f"{'enter' if len(names) > 1 else 'enters'} the shear strength H/(3√3) of the softer body."
        )
    if bare := " and ".join(without_unit(study)):
        which = "the hardness of the softer body," if limit is None else "contact.hardness ="
        yield (
            f"{bare} without a unit: k of V = k F L / H, for both bodies with {which} "
            f"{study.pair.wear_hardness:g} MPa. A K has one, such as '1e-4 mm^3/N/m'."
        )


def _of_extent(study: Content) -> Iterator[str]:
    """Yield a sentence where a worn patch will all but fill the domain: roughness makes it wider."""
    if study.counter.form.is_flat or not study.is_rough:
        return
    made = study.disc.synthetic is not None
    rough = sides_of(study, widths_with(study, summits(study)))
    for (patch, extent, way), (wide, *_) in zip(sides_of(study, worn_widths(study)), rough, strict=True):
        if patch <= extent < max(CLOSE * patch, wide if patch else 0.0):
            end = f"up to {wide:.3g} mm; {enough(study)} would do" if made else "wider"
            yield (
                f"grid.extent = {study.grid.size} may be too small: without roughness the worn patch will be "
                f"{patch:.3g} mm wide{way} at the end, and with it {end}."
            )


def _of_line_load(study: Content) -> Iterator[str]:
    """Yield a sentence where the load of a line contact is one of the domain, a part of the line's length."""
    loads = [study.contact.load, *(part.load for part in study.block or ())]
    for load in (load for load in loads if study.is_line and load is not None):
        if not isinstance(load, LineLoad):
            yield (
                f"contact.load = {load:g} N is that of the domain, {study.grid.sides[1]:g} mm of the line: "
                f"{load / study.grid.sides[1]:.4g} N/mm. A load with the unit N/mm is one per length."
            )


def _of_seam(study: Content) -> Iterator[str]:
    """Yield a sentence about a rough line contact whose disc does not repeat as its boundary does."""
    across = study.grid.sides[1]
    elastic = study.contact.law == "half-space" and study.boundary == "line" and study.cells.ny > 1
    if elastic and not _repeats(study.disc.synthetic, across, across=True):
        yield (
            f"The disc's surface does not repeat across sliding after {across:g} mm (grid.extent), as "
            "contact.boundary = 'line' does: it has a seam there, which a disc.synthetic.period of that "
            "length avoids."
        )


def _of_track(study: Content) -> Iterator[str]:
    """Yield a sentence about each thing of a track that misleads."""
    if not study.is_swept:
        return
    sliding = study.sliding
    step = study.shift * study.grid.cell
    first = 2.0 * math.sqrt(study.blocks[0].load / (math.pi * study.hardness))
    if step > first > 0.0:
        yield (
            f"sliding.shift = {study.shift} cells, {1e3 * step:g} µm, is longer than a contact at the "
            f"hardness, {1e3 * first:.3g} µm: the first passes leave gaps between the worn places."
        )
    local = study.contact.law == "local" and not study.uses_bearing_area
    if local and math.isinf(study.pair.stiffness):
        finer = "sliding.shift" if study.shift > 1 else "grid.cell"
        yield (
            "contact.law = 'local' with contact.stiffness = inf yields by the wear of a step alone: the area "
            f"in contact depends on its length, sliding.shift = {study.shift} cells. Take contact.law = "
            f"'half-space', or halve {finer} until the area stays."
        )
    radius = sliding.track_radius
    if radius is not None and radius < 2.0 * study.grid.sides[1]:
        yield (
            f"sliding.track_radius = {radius:g} mm: the track is computed straight, but the domain is more "
            "than half as wide as that radius."
        )
    made = study.disc.synthetic  # what a file holds tells `Measured.lap_seam`
    if sliding.track != "full" and made is not None and not _repeats(made, float(sliding.track)):
        yield (
            f"The disc's surface does not repeat after sliding.track = {float(sliding.track):g} mm: it has a "
            "seam where the lap closes."
        )
    yield from _of_sticking(study)


def _of_mean(study: Content) -> Iterator[str]:
    """Yield a sentence about a stroke too long for one pressure, or about bodies that yield unalike."""
    if study.fretting is None:
        return
    ratio, drives = study.stroke_ratio, study.sliding.drives_bodies
    if ratio > HONEST_MEAN and not drives:
        yield (
            f"sliding.positions = 'mean': the stroke is {ratio:.2g} of the scar's width, and depths of the "
            f"bodies are off by some per cent beyond {HONEST_MEAN:g}; 'cells' solves each place."
        )
    first, second = study.counter.elastic, study.disc.elastic
    if drives and first and second and first != second:
        yield (
            "The bodies' elastic constants differ, so that friction changes the pressure: sliding.force and "
            "sliding.stroke_of = 'body' leave that out."
        )


def _of_sticking(study: Content) -> Iterator[str]:
    """Yield a sentence about a stroke so short that what the bodies yield before they slip matters to it."""
    stroke, coefficient, hertz = study.sliding.stroke, study.friction.coefficient, study.hertz
    bodies = study.counter.elastic, study.disc.elastic
    if stroke is None or hertz is None or hertz.is_line or study.friction.fitted in (None, "states"):
        return
    kappa = softness_ratio(*(body for body in bodies if body is not None))
    travel = 2.0 * displacement(hertz, kappa, coefficient)
    if travel > STICKING * stroke:
        yield (
            f"sliding.stroke = {in_words(stroke)} is slip alone: the drive of such a test travels "
            f"{1e3 * travel:.3g} µm farther, by which smooth bodies yield before they slip (Mindlin, "
            f"coefficient {coefficient:g})."
        )


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
        yield (
            f"wear.particle = {diameter(study, pieces)} is {cells:.2g} cells wide, so that slopes and areas "
            f"depend on the cell: a grid.cell of {um(pieces.diameter / CELLS)} or less is needed."
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
            yield (
                f"A step wears a cell of the {CALLED[name]} at the hardness by K H ΔL = {um(depth)}, more "
                f"than half of wear.particle_thickness = {um(pieces.thickness)}, so areas depend on it: "
                f"{shorter} would do."
            )


def _of_critical(study: Content, pieces: Pieces) -> str:
    """Return a sentence about the number that 'critical' comes to, and how little is known of it."""
    strength = study.pair.junction_strength or 0.0
    low, high = (pieces.diameter / (1.0 + sign * SCATTER) ** 2 for sign in (1.0, -1.0))
    if study.junctions.strength is None:
        by = f"by the softer body's hardness of {study.pair.softer_hardness:g} MPa, and goes with 1/H²: H"
    else:
        by = f"by junctions.strength = {strength:g} MPa, and goes with 1/σ_j²: one"
    return (
        f"wear.particle = 'critical' is d* = {um(pieces.diameter)} (thesis eq 2.3) {by} "
        f"{100.0 * SCATTER:g} % higher or lower makes it {um(low)} or {um(high)}."
    )
