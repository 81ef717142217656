"""The verdict on a run tells in one line what to trust and how far, as far as the run itself knows it."""

import math
from collections.abc import Mapping

import numpy as np

from warpwear.grid import FloatArray
from warpwear.history.end_values import Summary, Verdict
from warpwear.study.study import Study

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
#: Errors below this are left out.
LEAST = 0.0005
UNKNOWN = "halve the cell and compare"


def rank_of(sentence: str, kind: str) -> int:
    """Rank what misleads: 0 takes all trust from a result, 1 is a warning, 2 a note, 3 one on no number."""
    if any(words in sentence for words in HEAVY):
        return 0
    return 1 if kind == "warning" else 3 if any(words in sentence for words in LIGHT) else 2


def errors_of_area(study: Study, s: Summary, history: Mapping[str, FloatArray]) -> dict[str, float | None]:
    """Map what makes an area uncertain to its part of the area; None where that is not known."""
    static, ways = history.get("area_static", np.zeros(0)), (s.area_of_directions or {"": 1.0}).values()
    solved = np.flatnonzero(np.isfinite(static))[-1:]
    yielding = np.abs(1.0 - static[solved] / history["area_contact"][solved]) if solved.size else np.zeros(1)
    flat = study.disc.synthetic is not None and study.disc.synthetic.kind == "flat"
    return {
        "cell": None if study.is_rough and not flat else _rim(study, s),
        "length of steps": s.step_error if "parts" in history else 0.0,
        "direction": (max(ways) - min(ways)) / sum(ways),
        "wear within a step": float(yielding[0]),
        "balance of the load": s.load_residual / s.load,
        "points filled in": 0.01 * (s.load_on_filled or 0.0),
    }


def _rim(study: Study, s: Summary) -> float:
    """Return what a cell at each rim of the scar is of its area; a line contact has no rim across."""
    sizes = (s.patch_along,) if study.is_line else (s.patch_along, s.patch_across)
    return sum(2e-3 * s.cell / size for size in sizes)


def verdict_of(study: Study, s: Summary, history: Mapping[str, FloatArray]) -> Verdict:
    """Judge a run by its summary without the verdict: an area's error is the root of its squared parts."""
    parts = errors_of_area(study, s, history)
    known = {what: part for what, part in parts.items() if part is not None and part >= LEAST}
    area = math.hypot(*known.values()) if known else None
    jumps = max((s.jump_errors or {"": 0.0}).values())
    depth = math.hypot(_rim(study, s), jumps) if s.volume_counter or s.volume_disc else None
    by = "a cell at its rim" + f", cycles jumped over {_percent(jumps)}" * (jumps >= LEAST)
    heavy = sum(rank_of(sentence, "note") == 0 for sentence in s.warnings)
    uncertainty = _area(area, known, mesh_is_known=parts["cell"] is not None)
    friction = _friction(study, s)
    sentences = [
        *([] if s.finished else ["interrupted: as far as it came"]),
        *([f"not to be trusted: {heavy} warning{'s' * (heavy > 1)}"] if heavy else []),
        f"area {uncertainty}",
        *([f"mean depth of the scar ± {_percent(depth)} ({by})"] if depth else []),
        f"friction {friction}",
    ]
    trusted = s.finished and not heavy
    return Verdict("; ".join(sentences), trusted, uncertainty, area, parts, depth, friction)


def _area(area: float | None, parts: Mapping[str, float], *, mesh_is_known: bool) -> str:
    """Say how far an area is known. parts: of its error."""
    if area is None:
        return f"± not known: {UNKNOWN}"
    by = ", ".join(what if len(parts) == 1 else f"{what} {_percent(part)}" for what, part in parts.items())
    return f"± {_percent(area)} ({by})" + ("" if mesh_is_known else f", the cell's part not known: {UNKNOWN}")


def _friction(study: Study, s: Summary) -> str:
    """Say whether friction is assumed, given or predicted."""
    fitted, assumed = study.friction.fitted, s.assumptions
    if s.cof is None:
        return "unknown before the end"
    if fitted is None:
        how = "assumed" if "friction.shear_strength" in assumed else "given"
        return f"predicted from the area, by a shear strength that is {how}"
    where = {"end": ", at the end", "initial": ", at the start", "coulomb": "", "states": ""}[fitted]
    return ("assumed" if "friction.coefficient" in assumed else "given") + where


def _percent(part: float) -> str:
    return f"{100.0 * part:.2g} %"
