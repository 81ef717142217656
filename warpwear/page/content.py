"""Everything that the page of a run shows, as plain content, and the file that it becomes.

Another process may make the page of its content: it needs neither the result nor the study.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from warpwear import lazy
from warpwear.errors import InputError, explained
from warpwear.figures.of_run.table import Plotter
from warpwear.page import paper, words
from warpwear.page.limits import limits_of
from warpwear.page.sections import sections_of
from warpwear.results import manifest
from warpwear.results.file import ResultFile
from warpwear.results.report import Row, record
from warpwear.results.summary import summary_text
from warpwear.study.study import Study

#: What makes the page of its content and of pictures, see `warpwear.page.html`.
MAKER = "warpwear.page.html:run_page"
#: What every page of ours holds near its start.
MARK = b'<meta name="generator" content="warpwear'


def content_of(result: ResultFile, rows: Sequence[Row], plot: Plotter) -> dict[str, Any]:
    """Collect what the page of a run shows.

    rows: as of `summarise`. plot: of the same result, whose reduced data are used again.
    """
    with plot.data as data:
        return words_of(result.study, rows) | {"sections": sections_of(plot, data)}


def top_of(study: Study, summary: dict[str, Any]) -> dict[str, Any]:
    """Collect the texts of the page's top by name: the question, its answers, and why to trust them."""
    assumptions, checks = words.assumptions_of(study, summary), words.checks_of(study, summary)
    return {
        "name": study.study.name,
        "description": study.study.description,
        "asked": words.asked_of(study, summary["distance_mm"]),
        "verdict": summary["verdict"]["text"],
        "finished": summary["finished"],
        "answers": [vars(answer) for answer in words.answers_of(study, summary)],
        "warnings": [text for text in summary["warnings"] if text not in summary["notes"]],
        "notes": [text for text in summary["warnings"] if text in summary["notes"]],
        "trust": words.trust_of(study, summary, assumptions, checks),
        "assumptions": assumptions,
        "checks": checks,
    }


def words_of(study: Study, rows: Sequence[Row]) -> dict[str, Any]:
    """Collect all texts of the page by name. rows: as of `summarise`."""
    summary = record(rows)
    top, methods = top_of(study, summary), paper.methods_of(study, summary)
    table = paper.table_of(study, summary, top["answers"])
    return top | {
        "limits": limits_of(study),
        "summary": summary_text(rows),
        "methods": methods,
        "table": table,
        "latex": paper.latex_of(study, methods, table),
        "version": summary["version"],
        "made_with": summary.get("made_with", {}),
    }


def made_here(content: dict[str, Any], pictures: Mapping[str, bytes]) -> bytes:
    """Make the page in this process. pictures: name of a figure -> content of its PNG file."""
    return lazy.resolve(MAKER)(content, pictures)


def statics(content: Mapping[str, Any]) -> list[str]:
    """Name the figures that stand for plots where no script draws."""
    return [*dict.fromkeys(name for section in content["sections"] for name in section.figures)]


def write_page(folder: Path, page: bytes) -> Path:
    """Write the page into a run folder, in place of an older one. Raises InputError for a file of others."""
    path = folder / manifest.PAGE
    with explained(f"{path} cannot be written"):
        if path.is_symlink() or (path.exists() and MARK not in path.read_bytes()[:20_000]):
            raise InputError(f"{path} is not a page of warpwear; move it away, the page needs its name.")
        with manifest.replacing(path) as new:
            new.write_bytes(page)
        manifest.add(folder, manifest.PAGE)
    return path
