"""Rules that the sections of a study must keep together before anything is computed."""

import math
from collections.abc import Iterator

import numpy as np

from warpwear.grid import blocks_of_rows
from warpwear.laws.archard import BODIES, COEFFICIENTS, MOST_KNOTS, knots_of
from warpwear.laws.elastic import LEAST_TORSION
from warpwear.laws.friction import RUNNING_IN
from warpwear.laws.pieces import Pieces
from warpwear.study import rules_track
from warpwear.study.content import Content
from warpwear.study.keys import attribute_of, check_keys, refused
from warpwear.study.motion import refuse_parts
from warpwear.study.units import LineLoad

#: More steps than anybody waits for, or than a history holds.
MOST_STEPS = 1_000_000
#: Most cycles that one is expected to stand for where only the run shows how many.
MOST_JUMP = 1000
#: Cells across a piece that resolve it, and part of the domain that one may cover.
CELLS, LARGEST = 4.0, 0.25
#: Fewest cells across sliding of a domain that the contact does not go on beyond.
FEWEST_ACROSS = 4
#: By what a load may exceed what all cells carry, relatively: rounding does so.
ROUNDING = 1.0e-12


def check(study: Content) -> None:
    """Refuse a study that cannot be computed as it stands: raises ValueError with one sentence."""
    check_keys(study)
    if study.block is not None:  # each block was checked by itself
        _steps(study)
        return
    _junction_growth(study)
    _factors(study)
    if study.study.model == "two-scale":
        rules_track.check_patches(study)
    _line(study)
    _boundary(study)
    _shape(study)
    rules_track.check(study)
    _fretting(study)
    _pieces(study)
    _hardness(study)
    _over_pressure(study)
    rules_track.check_layers(study)
    _capacity(study)
    _tolerance(study)
    _stability(study)
    _steps(study)
    _fatigue(study)


def _fatigue(study: Content) -> None:
    """Refuse fatigue limits that no criterion is made for, and a length beyond the domain."""
    fatigue = study.fatigue
    if fatigue is None:
        return
    ratio = fatigue.torsion / fatigue.bending
    if not LEAST_TORSION <= ratio <= 1.0:
        raise refused("torsion", torsion=fatigue.torsion, ratio=ratio, least=LEAST_TORSION)
    side = min(study.grid.sides[: 1 if study.is_line else 2])
    if fatigue.length > side:
        raise refused("fatigue_length", length=1e3 * fatigue.length, side=1e3 * side)


def _fretting(study: Content) -> None:
    """Refuse forces that make the contact slip as a whole, and one mean contact on a rough disc."""
    sliding, limit = study.sliding, study.friction.coefficient * study.contact.load
    if study.fretting is None:
        return
    if sliding.force is not None and sliding.force >= limit:
        raise refused("force", force=sliding.force, limit=limit)
    if sliding.drives_bodies:
        return
    stroke, disc = sliding.stroke or 0.0, study.disc.synthetic
    if stroke > study.grid.cell:
        refuse_parts("sliding.stroke", stroke, study.grid.cell)
    if disc is None or disc.kind != "flat":
        raise refused("rough_fretting")


def _line(study: Content) -> None:
    """Refuse a load of a length, and few cells across, where there is no line contact."""
    grid = study.grid
    if study.is_line:
        return
    load = study.contact.load
    if isinstance(load, LineLoad):
        raise refused("load_of_a_length", per_length=load.per_length)
    if study.cells.ny < FEWEST_ACROSS:
        raise refused("few_across", study=study, cell=1e3 * grid.cell, fewest=FEWEST_ACROSS)


def _boundary(study: Content) -> None:
    """Refuse a half-space that repeats a counter-body, unless that goes on, and flow where none repeats."""
    form, elastic = study.counter.form, study.contact.law == "half-space"
    both_ways = study.repeats and not form.is_flat and all(form.rises)
    if both_ways or (elastic and study.boundary == "line" and form.rises[1]):
        raise refused("repeated_counter", study=study)
    if "flow" in study.output.joint and study.boundary != "periodic":
        raise refused("flow", study=study)
    if "flash" in study.output.joint and study.is_line:
        raise refused("flash")


def _shape(study: Content) -> None:
    """Refuse a pin without a rim, or one that the domain does not hold."""
    counter, extent = study.counter, min(study.grid.sides)
    width = 2.0 * counter.form.reach
    if counter.shape == "pin" and not width <= extent - 2.0 * study.grid.cell:
        radius, edge = counter.nominal_radius, counter.edge_radius
        raise refused("pin", radius=radius, edge=edge, width=width, study=study)


def _factors(study: Content) -> None:
    """Refuse factors of the shear strength where caps or wear follow from one strength at all steps."""
    growth = study.friction.junction_growth
    beside = f"friction.junction_growth = {growth:g}" if growth else "wear.law = 'energy'"
    factors = study.friction.law_with().factors if growth or study.pair.wears_by_area else ()
    for key in (factor.keys[0] for factor in factors if growth or factor is not RUNNING_IN):
        raise refused("factor", key=key, beside=beside)


def _junction_growth(study: Content) -> None:
    """Refuse junctions that grow where the shear leaves a cell no pressure."""
    growth, hardness = study.friction.junction_growth, study.pair.indentation_hardness
    for key in ("friction.shear_strength", "friction.film.shear_strength"):
        strength = attribute_of(study, key) or 0.0
        if not study.friction.largest_coefficient and growth and strength * math.sqrt(growth) >= hardness:
            most = hardness / math.sqrt(growth)
            raise refused(
                "grown_shear", key=key, strength=strength, growth=growth, hardness=hardness, most=most
            )


def _pieces(study: Content) -> None:
    """Refuse pieces that cannot be computed as they are asked for: raises ValueError with one sentence."""
    pieces = study.pair.pieces
    if pieces is None:
        return
    named = f"wear.particle = {diameter(study, pieces)}"
    if not study.grid.cell <= pieces.diameter * (1.0 + 1.0e-9):
        enough = um(pieces.diameter / CELLS)
        raise refused("small_pieces", named=named, enough=enough)
    if pieces.diameter > LARGEST * min(study.grid.sides):
        raise refused("large_pieces", named=named, study=study)
    if pieces.thickness > pieces.diameter:
        raise refused("thick_pieces", thickness=um(pieces.thickness), named=named)


def diameter(study: Content, pieces: Pieces) -> str:
    """Return the diameter of the pieces, as it was asked for."""
    length = um(pieces.diameter)
    return f"'critical', {length}," if study.wear.particle == "critical" else length


def um(length: float) -> str:
    """Return a length [mm] in µm, as text."""
    return f"{1.0e3 * length:.3g} µm"


def _hardness(study: Content) -> None:
    if study.study.model != "macro" and study.contact.hardness is None and study.pair.softer_hardness is None:
        raise refused("no_hardness")
    hardness = study.pair.softer_hardness if study.contact.hardness is None else study.contact.hardness
    if hardness is None or not math.isfinite(hardness):
        for named in without_unit(study):
            raise refused("k_without_hardness", named=named)


def _over_pressure(study: Content) -> None:
    """Refuse a K over the pressure that programs do not follow."""
    counter, disc = study.wear_laws
    if study.study.model == "two-scale" and counter.over_pressure[0] and not counter.in_proportion_to(disc):
        raise refused("unlike_proportions", law=counter.name)
    for body, law in zip(BODIES, study.wear_laws, strict=True):
        pressures, values = law.over_pressure
        named = f"wear.{body} = {getattr(study.wear, body).value:g} with wear.law = '{law.name}'"
        if pressures and pressures[0] < 0.0:
            raise refused("early_change", named=named, pressure=pressures[0])
        if values and values[0] == 0.0 < law.fastest:
            raise refused("severe_alone", named=named)
        if law.rates().min() < 0.0:
            raise refused("falling_wear", named=named, pressure=pressures[0])
    if len(knots_of(study.wear_laws)) > MOST_KNOTS:
        raise refused("many_pressures", law=counter.name, most=MOST_KNOTS)


def without_unit(study: Content) -> Iterator[str]:
    """Yield key and value of each wear coefficient that has no unit and is not 0."""
    for name in sorted(COEFFICIENTS):
        coefficient = getattr(study.wear, name)
        if coefficient is not None and coefficient.dimensionless and coefficient.value > 0.0:
            yield f"wear.{name} = {coefficient.value:g}"


def _capacity(study: Content) -> None:
    load, cells, form = study.contact.load, study.cells, study.counter.form
    least = min(study.pair.cell_caps)  # all cells may become bare
    inside = max(min(form.reach, 0.5 * cells.cell * min(cells.shape)) - cells.cell, 0.0)
    if load <= least * math.pi * inside**2:  # of a circle that lies in cells with a body: they carry it
        return
    present = cells.cells
    if form.reach < 0.5 * cells.cell * math.hypot(*cells.shape):
        blocks = blocks_of_rows(cells.nx, values=cells.ny)
        present = sum(int(np.isfinite(form.heights(cells.x[at], cells.y)).sum()) for at in blocks)
    carried = least * present * cells.cell_area
    if carried * (1.0 + ROUNDING) < load:
        of_length = f" ({study.loads})" if study.is_line else ""
        raise refused("capacity", load=load, of_length=of_length, carried=carried, sheared=_of_sheared(study))


def _of_sheared(study: Content) -> str:
    """Say how much of the hardness the shear of growing junctions leaves, where they grow."""
    growth, least = study.friction.junction_growth, min(study.pair.caps)
    if growth == 0.0:
        return ""
    return f", as friction.junction_growth = {growth:g} leaves {least:.4g} MPa of it to sheared cells"


def _tolerance(study: Content) -> None:
    if study.uses_bearing_area and study.load_tolerance >= study.contact.load:
        raise refused("load_tolerance", study=study, one_cell=study.hardness * study.cells.cell_area)


def _stability(study: Content) -> None:
    beyond = unstable(study)
    if beyond is not None and not study.stepping.force:
        raise refused("unstable", beyond=beyond)


def longest_step(study: Content) -> tuple[float, float]:
    """Return what is slid in the longest step [mm], and the part of it that a cell of the disc slides."""
    slid, fraction = study.increments[2], 1.0
    if study.is_swept:
        track = study.track
        slid, fraction = track.shift * track.stroke / track.cells, track.track_fraction
    return min(slid, study.sliding.total), fraction


def unstable(study: Content) -> str | None:
    """Return the start of a sentence about explicit steps that are too large; None where they are not."""
    if study.stepping.scheme == "implicit":
        return None
    counter, disc = (float(law.rates(study.hardness).max()) for law in study.wear_laws)
    slid, fraction = longest_step(study)
    stiffness, wear = study.pair.stiffness, counter + fraction * disc
    if math.isinf(stiffness) or wear == 0.0:  # without a foundation only an accuracy of K H ΔL limits it
        return None
    limit = 2.0 / stiffness / wear
    if slid < limit:
        return None
    named = f"stepping.{_largest(study)} = {study.increments[2]:g} mm"
    if study.is_swept:
        named = f"sliding.shift = {study.shift} cells, {slid:.3g} mm of sliding,"
    return f"{named} is beyond the explicit stability limit 2/(k K) = {limit:.3g} mm"


def _steps(study: Content) -> None:
    total, (first, growth, largest) = study.sliding.total, study.increments
    if study.is_swept:
        steps = sum(t.steps(b.length) for t, b in zip(study.tracks, study.blocks, strict=True))
        if study.jumps:  # how far shows only in the run
            steps /= MOST_JUMP if study.stepping.jump == "auto" else study.stepping.jump
    elif growth > 1.0:
        # Growing steps cover first growth^n/(growth − 1); at most the whole distance is left for the largest.
        covered = (largest - first) / (growth - 1.0)
        steps = math.log(largest / first) / math.log(growth) + max(0.0, total - covered) / largest
    else:
        steps = total / first
    if steps > MOST_STEPS:
        larger = "sliding.shift or grid.cell" if study.is_swept else f"stepping.{_largest(study)}"
        raise refused("many_steps", total=total, steps=steps, most=MOST_STEPS, larger=larger)


def _largest(study: Content) -> str:
    """Name the key that says how large a step may be."""
    return "largest" if study.stepping.increment is None else "increment"
