"""What is said and drawn of repeated tests: the sentence for a paper, a table, and all courses."""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from warpwear.calibration.scatter import CONDITIONS, HELD, ScatterModel
from warpwear.ensembles.ensemble import EnsembleRow, Group
from warpwear.errors import prose
from warpwear.figures import describe
from warpwear.figures.describe import Axis, Chart, Figure, Line, Look
from warpwear.results.ensemble import in_legend
from warpwear.results.report import aligned, scientific, shown

#: Places at which the next test's course is computed, at most.
PLACES = 120
#: What is said of them: their page, and what their numbers are called.
TEXTS = prose("reports")["repeats"]


def _for_people(told: Mapping[str, Any]) -> tuple[float, str]:
    """Return the unit that people read, lengths in m, and its factor."""
    return (1e-3, "m") if told["unit"] == "mm" else (1.0, told["unit"])


def with_s(told: Mapping[str, Any]) -> str:
    """Write mean ± s, digits after that, with the unit."""
    factor, unit = _for_people(told)
    mean, s = factor * told["mean"], told["s"] and factor * told["s"]
    if unit.startswith("mm³/"):
        return f"{scientific(mean, s, digits=3)} {unit}"
    decimals = max(0, 1 - math.floor(math.log10(s))) if s else None
    text = shown(mean, 3) if decimals is None else f"{mean:.{decimals}f} ± {s:.{decimals}f}"
    return f"{text} {unit}".rstrip()


def sentence(tests: Sequence[Any], told: Mapping[str, Mapping[str, Any]]) -> str:
    """Write what a paper says of the tests."""
    parts, count = [], 0
    for name, row in told.items():
        some = f" (n = {row['n']})" * (row["n"] != count)
        kind, under, load = name.partition(" at ")
        if symbol := TEXTS["numbers"][kind].get("symbol"):
            parts.append(f"{symbol} {with_s(row)}{under}{load}{some}")
        elif name == "incubation":
            having = [test for test in tests if name in test.values]
            laps = [test.laps for test in having if test.laps]
            in_laps = len(laps) == len(having)
            ends = laps if in_laps else [1e-3 * test.values[name].value for test in having]
            span = " to ".join(dict.fromkeys(f"{end:.3g}" for end in (min(ends), max(ends))))
            parts.append(f"transition after {span} {'laps' if in_laps else 'm'}{some}")
        else:
            continue
        count = row["n"]
    at: Mapping[str, float] = next((row["at"] for row in told.values() if row["at"]), {})
    where = " and ".join(
        f"{name.replace('_', ' ')} {value:.3g} {CONDITIONS[name]}" for name, value in at.items()
    )
    return "; ".join(parts) + f"; at {where}, by the trend" * bool(where)


def text_of(
    tests: Sequence[Any],
    told: Mapping[str, Mapping[str, Any]],
    differences: Mapping[str, tuple[float, float]],
) -> Iterator[str]:
    """Write what the terminal shows: the sentence, and a line a number."""
    yield f"  {sentence(tests, told)}"
    cells = [
        ["", "mean ± s", "n", "scatter (5 to 95 %)", f"next test, {100 * HELD:g} %", "left out", "needed"]
    ]
    cells[0] += ["than the other"] * bool(differences)
    for name, row in told.items():
        (factor, unit), scatter = _for_people(row), row["scatter"]
        spread = f"{scatter['median']:.2g} ({scatter['low']:.2g} to {scatter['high']:.2g})"
        ends = [factor * row[end] for end in ("next_low", "next_high")]
        small = unit.startswith("mm³/")
        span = " to ".join(scientific(end, digits=3) if small else f"{end:.3g}" for end in ends)
        counts = [f"{row['left_out_within']} of {row['left_out']}"]
        counts.append(f"{row['tests_needed']} (to {row['tests_needed_at_most']})")
        cells.append([name.replace("_", " "), with_s(row), str(row["n"]), spread, span, *counts])
        if differences:
            gap = differences.get(name)
            cells[-1].append(f"{factor * gap[0]:+.2g} ± {factor * gap[1]:.2g}" if gap else "–")
    yield from (f"  {line}" for line in aligned(cells))


def figure_of(tests: Sequence[Any]) -> Figure:
    """Draw all courses, their mean with s, and the band of the next test."""
    known = [test for test in tests if test.course is not None]
    rows = tuple(EnsembleRow(test.name, {}, {"cof": test.course}) for test in known)
    looks = itertools.cycle(Look(colour, width=0.7) for colour in describe.GROUPS)
    lines = [
        Line(t.course[0], t.course[1], in_legend(t.name), look) for t, look in zip(known, looks, strict=False)
    ]
    course = Group("tests", rows).courses("cof")
    values = np.full((1, 0), np.nan) if course is None else np.where(course[1] > 0.0, course[1], np.nan)
    several = np.flatnonzero(np.isfinite(values).sum(axis=0) > 1)
    if course is not None and several.size:
        some = several[np.unique(np.linspace(0, several.size - 1, PLACES).astype(int))]
        values = values[:, some]
        ends = np.empty((2, some.size))
        for k, column in enumerate(values.T):
            y = np.log(column[np.isfinite(column)])
            ends[:, k] = np.exp(ScatterModel(y, 0.0 * y, np.ones((y.size, 1))).interval(np.ones(1), 0.0))
        places, mean = course[0][some], np.nanmean(values, axis=0)
        s = np.nanstd(values, axis=0, ddof=1)
        mean_look, next_look = Look(describe.NEUTRAL, width=2.0), Look(describe.NEUTRAL, "dash", 1.0)
        lines += [
            Line(places, ends[0], f"next test, {100 * HELD:g} %", next_look),
            Line(places, ends[1], "", next_look),
            Line(places, mean, "mean ± s", mean_look, mean - s, mean + s),
        ]
    x_axis = Axis("distance slid, m", low=0.0)
    chart = Chart("Coefficient of friction", x_axis, Axis("coefficient of friction, –", low=0.0), lines)
    return Figure([chart], 1, legend=3, width=describe.PAGE, height=3.2)
