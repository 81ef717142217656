"""The page of a comparison: what differs between the runs, their courses over each other, their answers."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from warpwear.comparison.courses import told_of
from warpwear.comparison.figures import figures_of
from warpwear.comparison.groups import differences, told
from warpwear.comparison.scar import record_of
from warpwear.comparison.table import TEXTS, Comparison
from warpwear.ensembles.datum import lines_of_data
from warpwear.ensembles.page import answers_of, link_to
from warpwear.figures.sections import under_headings
from warpwear.figures.wording import counted, few_of
from warpwear.page.html import page_of
from warpwear.page.limits import limits_of

#: Values of a key that are listed for a group.
LISTED = 4


def page(comparison: Comparison, pictures: Mapping[str, bytes], folder: Path) -> bytes:
    """Make the page. pictures: name of a figure -> PNG file; folder: where the page will lie, for links."""
    figures, runs, measured = figures_of(comparison), len(comparison.rows), len(comparison.experiments)
    elsewhere = {name for _, _, names, _ in TEXTS["sections"] for name in names}
    courses = [name for name in figures if name not in elsewhere]
    layout = [("Courses", "courses", courses, "Move over a chart to read its values."), *TEXTS["sections"]]
    groups = f" in {len(comparison.groups)} groups" * (len(comparison.groups) < runs)
    counts = [counted(runs, "run") + groups] * (runs > 0)
    counts += [counted(measured, "measured course")] * (measured > 0)
    inputs = {g.name for g in comparison.groups if any(r.study.friction.ends_as_given for r in g.rows)}
    limits = ((run, sentence) for run in comparison.rows for sentence in limits_of(run.study))
    content = {
        "name": "Comparison",
        "asked": f"{' and '.join(counts)}, laid over each other: what differs between them, and what does it "
        "change in scar, contact, wear and friction?",
        "differ": _differ(comparison),
        "answers": answers_of(comparison, inputs),
        "notes": comparison.notes,
        "told": [*told_of(comparison.data)],
        "each_datum": {name: lines_of_data(rows) for name, rows in comparison.data.items()},
        "scar": record_of(comparison.scar) if comparison.scar is not None else None,
        "readings": comparison.readings,
        "limits": [*told(limits, runs, of_all=False)],
        "runs": [(run.name, str(run.folder), link_to(run.folder, folder)) for run in comparison.rows],
        "sections": under_headings(figures, layout, one_legend=comparison.one_legend),
    }
    return page_of("compare.html", content, pictures)


def _differ(comparison: Comparison) -> dict[str, Any]:
    """Return the names of groups, and the keys in which they differ with the values of each."""
    rows = [
        (key, [{"text": few_of(values, LISTED)} for values in of_groups])
        for key, of_groups in differences(comparison.groups).items()
    ]
    return {"names": [group.name for group in comparison.groups], "rows": rows}
