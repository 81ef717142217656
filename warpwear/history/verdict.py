"""The verdict on a run tells in one line what to trust and how far, by what the run itself has looked at."""

import math
from collections.abc import Mapping

import numpy as np

from warpwear.grid import FloatArray
from warpwear.history.end_values import Summary, Verdict
from warpwear.laws.passes import within
from warpwear.study.study import Study
from warpwear.surfaces.base import BoolArray

#: Words of sentences about numbers that are not to be trusted at all.
HEAVY: tuple[str, ...] = (
    "mean nothing",
    "which no contact has",
    "is no finite number",
    "of Archard's law",
    "contact reached",
)
HEAVY += ("load_residual =", "rests on points")
#: Words of notes that change no number.
LIGHT = (" not apply ", "no step ends at")
#: Parts of an area below this are left out of sentences, and the most that an area is trusted with.
LEAST, TRUSTED = 0.0005, 0.1
#: What cells do to the area of a contact on the half-space whose pressure falls to zero as a root, over the
#: sides between cells in contact and others times the cell's area.
OF_PERIMETER = (math.pi - 1.0 + math.log(2.0)) / 24.0
#: Two standard deviations of a count of cells within outlines, over the root of their sides: where they lie
#: anyhow on the cells, and where they may lie in a regular way.
OF_LEVEL, OF_REGULAR = 0.57, 1.14
#: Halvings of the step that are told by what one changes. By the local law an area below the hardness goes
#: with a power of the step and has no limit: an eighth is told. One of first order has its limit at two.
HALVINGS = 3.0
#: Parts of an area's error as people read them, where their names do not say it.
CALLED_PARTS = {"step": "length of steps", "cells": "size of cells", "jumps": "cycles not computed"}
CALLED_PARTS["balance of the load"] = "load not balanced"


def rank_of(sentence: str, kind: str) -> int:
    """Rank what misleads: 0 takes all trust from a result, 1 is a warning, 2 a note, 3 one on no number."""
    if any(words in sentence for words in HEAVY):
        return 0
    return 1 if kind == "warning" else 3 if any(words in sentence for words in LIGHT) else 2


def errors_of_area(study: Study, s: Summary, history: Mapping[str, FloatArray]) -> dict[str, float | None]:
    """Map what makes an area uncertain to its part of the area; None where that was not looked at.

    The area is the corrected one where the step is known, see `corrected`.
    """
    static, parts = history.get("area_static", np.zeros(0)), {"cells": cells_of(study, s, history)}
    solved = np.flatnonzero(np.isfinite(static))[-1:]
    explicit = study.stepping.scheme == "explicit" and study.sliding.total > 0.0
    if study.is_swept or study.sliding.frets or explicit:
        parts["step"] = _step(study, s)
    if solved.size:
        parts["wear within a step"] = float(abs(1.0 - static[solved[0]] / history["area_contact"][solved[0]]))
    if s.jump_errors:
        parts["jumps"] = max(s.jump_errors.values())
    parts["balance of the load"] = s.load_residual / s.load
    if s.load_on_filled is not None:
        parts["points filled in"] = 0.01 * s.load_on_filled
    return dict(sorted(parts.items(), key=lambda part: math.inf if part[1] is None else -part[1]))


def _step(study: Study, s: Summary) -> float | None:
    """Return what the length of a step does to an area, as a part of it."""
    if study.contact.law == "half-space":
        return s.step_error or None  # of one cell it is not looked at
    return None if s.change_by_step is None else HALVINGS * abs(s.change_by_step)


def sides_of(touches: BoolArray) -> int:
    """Count the sides between cells in contact and others; beyond the domain a contact goes on."""
    return sum(int(np.count_nonzero(np.diff(touches, axis=axis))) for axis in (0, 1))


def _is_smooth(study: Study) -> bool:
    return not study.is_rough or (study.disc.synthetic is not None and study.disc.synthetic.kind == "flat")


def _perimeter(s: Summary, history: Mapping[str, FloatArray]) -> float | None:
    """Return what the perimeter adds to the area of the last contact, as a part of it."""
    if s.contact_sides is None:
        return None
    return OF_PERIMETER * s.contact_sides * (1e-3 * s.cell) ** 2 / float(history["area_contact"][-1])


def cells_of(study: Study, s: Summary, history: Mapping[str, FloatArray]) -> float | None:
    """Return what the cells do to an area, as a part of it: by the outlines of the last contact."""
    over = _perimeter(s, history)
    if over is None or s.contact_sides is None:
        return None
    at_rest, half_space = not study.is_swept, study.contact.law == "half-space"
    if half_space and not at_rest:
        # half of what is taken off; with what was not taken off where it was not
        return 0.5 * over / (1.0 - over) if _step(study, s) is not None else 1.5 * over
    # Of a smooth line all rows are alike.
    sides = s.contact_sides * (study.cells.ny if study.is_line and _is_smooth(study) else 1)
    level = (1e-3 * s.cell) ** 2 * math.sqrt(sides) / float(history["area_contact"][-1])
    level *= OF_REGULAR if at_rest or study.is_line or _is_smooth(study) else OF_LEVEL
    return max(level, over) if half_space else level


def corrected(study: Study, s: Summary, history: Mapping[str, FloatArray]) -> float | None:
    """Return the area [mm²] without what its perimeter adds; None where that is not to be taken off.

    Cells make it larger, and parts of a step smaller: with one of both alone it is further off than as
    counted.
    """
    over = _perimeter(s, history)
    if not study.is_swept or study.contact.law != "half-space" or over is None or _step(study, s) is None:
        return None
    return s.area_contact * (1.0 - over)


def _scar_error(study: Study, history: Mapping[str, FloatArray]) -> float | None:
    """Return the error of length and width of the scar [mm]; None of patches, and of dents that are kept.

    A cell at each end; and what a part of a step goes over, along which the counter-body's wear is a mean.
    """
    if study.study.model == "two-scale" or (study.is_swept and study.sliding.plastic == "keep"):
        return None
    part = math.ceil(study.shift / history["parts"].min()) if "parts" in history else 1
    return (1.0 + part) * study.grid.cell


def scatter(study: Study, s: Summary, history: Mapping[str, FloatArray]) -> float | None:
    """Return by what part the area differs on another piece of such a surface, by one standard deviation.

    It is that of the steps of the last cycle, the same place to and fro averaged, over the root of the
    contacts that lie side by side on the track. None at rest, on a smooth disc, and on a shorter track.
    """
    if not study.is_swept or _is_smooth(study):
        return None
    track = study.tracks[-1]
    contacts = track.cells * track.cell / s.patch_along
    areas = history["area_contact"][within(history, "end", study.laps)]
    if track.reverses and len(areas) == 2 * track.steps_of_pass:
        areas = 0.5 * (areas[: track.steps_of_pass] + areas[: track.steps_of_pass - 1 : -1])
    return (
        float(areas.std() / areas.mean()) / math.sqrt(contacts) if contacts > 1.0 and areas.size > 1 else None
    )


def verdict_of(study: Study, s: Summary, history: Mapping[str, FloatArray]) -> Verdict:
    """Judge a run by its summary without the verdict: an area's error is the root of its squared parts."""
    parts = errors_of_area(study, s, history)
    known = [part for part in parts.values() if part is not None]
    area = math.hypot(*known) if len(known) == len(parts) else None
    better, piece = corrected(study, s, history), scatter(study, s, history)
    heavy = sum(rank_of(sentence, "note") == 0 for sentence in s.warnings)
    by = ", ".join(
        f"{CALLED_PARTS.get(what, what)} {'not looked at' if part is None else f'{100.0 * part:.2g} %'}"
        for what, part in parts.items()
        if part is None or part >= LEAST
    )
    uncertainty = ("± not known" if area is None else f"± {100.0 * area:.2g} %") + f" ({by})" * bool(by)
    friction = _friction(study, s)
    sentences = [
        *([] if s.finished else ["interrupted: numbers of the distance slid so far"]),
        *([f"not to be trusted: {heavy} warning{'s' * (heavy > 1)}"] if heavy else []),
        f"area {better or s.area_contact:.3g} mm² {uncertainty}",
        *([] if piece is None else [f"another piece of such a surface ± {100.0 * piece:.2g} %"]),
        f"coefficient of friction {friction}",
    ]
    return Verdict(
        "; ".join(sentences),
        trusted=s.finished and not heavy and area is not None and area <= TRUSTED,
        area=uncertainty,
        area_corrected_mm2=better,
        area_relative=area,
        area_parts=parts,
        area_scatter=piece,
        scar_error_mm=_scar_error(study, history),
        friction=friction,
    )


def _friction(study: Study, s: Summary) -> str:
    """Say whether friction is assumed, given or predicted."""
    fitted, assumed = study.friction.fitted, s.assumptions
    if s.cof is None:
        return "unknown before the end"
    if fitted is None:
        how = "assumed" if "friction.shear_strength" in assumed else "given"
        return f"predicted from the area, by a shear strength that is {how}"
    where = {"end": " at the end", "initial": " at the start", "coulomb": "", "states": ""}[fitted]
    return ("assumed" if "friction.coefficient" in assumed else "given") + where
