"""Rules of a study whose bodies wear in pieces."""

import math
from collections.abc import Iterator

from warpwear.laws.archard import CALLED
from warpwear.laws.pieces import Pieces
from warpwear.study.content import Content

#: Cells across a piece that resolve it.
CELLS = 4.0
#: Part of the thickness of a piece that a cell at the hardness may lose in a step.
OF_THICKNESS = 0.5
#: Part of the domain that a piece may cover.
LARGEST = 0.25
#: A hardness is seldom known better than this, relatively.
SCATTER = 0.2


def check(study: Content) -> None:
    """Refuse pieces that cannot be computed as they are asked for: raises ValueError with one sentence."""
    pieces = study.pieces
    if pieces is None:
        return
    named = f"wear.particle = {_diameter(study, pieces)}"
    if not study.grid.cell <= pieces.diameter * (1.0 + 1.0e-9):
        enough = _um(pieces.diameter / CELLS)
        raise ValueError(f"{named} is smaller than a cell; a grid.cell of {enough} or less is needed")
    if pieces.diameter > LARGEST * min(study.grid.sides):
        raise ValueError(
            f"{named} must be at most a quarter of grid.extent = {study.grid.size}; allowed are "
            "smaller pieces, or a larger extent"
        )
    if pieces.thickness > pieces.diameter:
        raise ValueError(
            f"wear.particle_thickness = {_um(pieces.thickness)} must not exceed {named}: a piece is a flake"
        )


def doubts(study: Content) -> Iterator[str]:
    """Yield a sentence about each thing that is computed as asked for, but whose numbers mislead."""
    pieces = study.pieces
    if pieces is None:
        return
    if study.wear.particle == "critical":
        yield _of_critical(study, pieces)
    if pieces.diameter < CELLS * study.grid.cell * (1.0 - 1.0e-9):
        cells = pieces.diameter / study.grid.cell
        yield (
            f"wear.particle = {_diameter(study, pieces)} is {cells:.2g} cells wide, so that slopes and areas "
            f"depend on the cell: a grid.cell of {_um(pieces.diameter / CELLS)} or less is needed."
        )
    yield from _of_steps(study, pieces)


def _of_steps(study: Content, pieces: Pieces) -> Iterator[str]:
    """Yield a sentence where a step takes more off a cell at the hardness than the pieces bear."""
    if not math.isfinite(study.hardness):
        return
    total, largest = study.sliding.total, study.increments[2]
    fraction = 1.0
    if study.is_swept:
        track = study.track
        largest = track.shift * track.stroke / track.cells
        fraction = track.track_fraction
    slid = min(largest, total)
    allowed = OF_THICKNESS * pieces.thickness
    for name, law, part in zip(("counter", "disc"), study.wear_laws, (1.0, fraction), strict=True):
        depth = law.fastest * study.hardness * part * slid
        if depth <= allowed * (1.0 + 1.0e-9):
            continue
        longest = slid * allowed / depth
        change = f"increments of {longest:.2g} mm or less are needed (stepping)"
        if study.is_swept:
            cells = math.floor(study.shift * allowed / depth)
            changes = [f"sliding.shift = {cells}"] if cells else ["a smaller grid.cell"]
            if name == "counter" and fraction < 1.0 and study.sliding.track != "full":
                longer = float(study.sliding.track) * depth / allowed
                changes.append(f"a sliding.track of {longer:.2g} mm or more")
            change = f"{' or '.join(changes)} is needed"
        yield (
            f"A step wears a cell of the {CALLED[name]} at the hardness by K H ΔL = {_um(depth)}, more than "
            f"half of wear.particle_thickness = {_um(pieces.thickness)}, so areas depend on it: {change}."
        )


def _of_critical(study: Content, pieces: Pieces) -> str:
    """Return a sentence about the number that 'critical' comes to, and how little is known of it."""
    strength = study.junction_strength or 0.0
    low, high = (pieces.diameter / (1.0 + sign * SCATTER) ** 2 for sign in (1.0, -1.0))
    if study.junctions.strength is None:
        by = f"by the softer body's hardness of {study.softer_hardness:g} MPa, and goes with 1/H²: H"
    else:
        by = f"by junctions.strength = {strength:g} MPa, and goes with 1/σ_j²: one"
    return (
        f"wear.particle = 'critical' is d* = {_um(pieces.diameter)} (thesis eq 2.3) {by} "
        f"{100.0 * SCATTER:g} % higher or lower makes it {_um(low)} or {_um(high)}."
    )


def _diameter(study: Content, pieces: Pieces) -> str:
    """Return the diameter of the pieces, as it was asked for."""
    length = _um(pieces.diameter)
    return f"'critical', {length}," if study.wear.particle == "critical" else length


def _um(length: float) -> str:
    """Return a length [mm] in µm, as text."""
    return f"{1.0e3 * length:.3g} µm"
