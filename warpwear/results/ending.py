"""A run ends on a terminal in ten lines at most, read once: what came out, and how far to trust it."""

from operator import itemgetter
from typing import Any

from warpwear.history.distances import with_unit
from warpwear.history.end_values import Summary
from warpwear.history.verdict import rank_of
from warpwear.laws.archard import BODIES
from warpwear.results.file import ResultFile
from warpwear.results.formats.forms import filled
from warpwear.results.report import Row, lines, shown
from warpwear.results.summary import summarise
from warpwear.results.summary_models import WARM
from warpwear.study.bodies import HEAT
from warpwear.study.study import Study

#: Rank of notes on no number, which are not counted.
LIGHTEST = 3
#: Lines at most, its head among them: one more is that of its page.
MOST_LINES = 9


def ending(result: ResultFile) -> str:
    """Say in nine lines at most what a run amounts to, and leave one for its page; `summary_text` has all."""
    study, content = result.study, summarise(result)
    s = Summary.of(content)
    kinds = [(rank_of(text, "note" if text in s.notes else "warning"), text) for text in s.warnings]
    ranked = sorted((pair for pair in kinds if pair[0] < LIGHTEST), key=itemgetter(0))
    formats = {"g": lambda value, digits: shown(value, digits), "far": with_unit}
    told: Any = {"study": study, "s": s, "content": content, "friction": friction_of(study, s)}
    told |= {"warnings": [text for _, text in ranked], "heavy": ranked and ranked[0][0] == 0}
    head, *others = filled("ending.txt", formats, escape=False, **told).splitlines()
    rows = [Row(label, "", text) for label, _, text in (line.partition(": ") for line in others) if text]
    if len(rows) >= MOST_LINES:  # the warning goes behind what is said of trust
        rows[-2:] = [Row(rows[-2].label, "", f"{rows[-2].value}; warning: {rows[-1].value}")]
    return "\n".join([head, *lines(rows)])


def friction_of(study: Study, s: Summary) -> str:
    """Say how friction goes, which end of it is an input, and what predicts it elsewhere."""
    given = {f"{body}.{name}" for body in BODIES for name in HEAT} <= study.given_keys
    return filled("friction.txt", escape=False, study=study, s=s, warm=WARM, tabled=not given).strip()
