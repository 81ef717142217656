"""Everything that the page of a run shows, as plain content, and the file that it becomes.

Another process may make the page of its content: it needs neither the result nor the study.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from warpwear import lazy
from warpwear.errors import InputError, explained
from warpwear.figures.of_run.table import Plotter
from warpwear.history.end_values import Summary
from warpwear.page import words
from warpwear.page.limits import limits_of
from warpwear.page.sections import sections_of
from warpwear.results import manifest
from warpwear.results.file import ResultFile
from warpwear.results.summary import summarise, summary_text

#: What makes the page of its content and of pictures, see `warpwear.page.html`.
MAKER = "warpwear.page.html:run_page"
#: What every page of ours holds near its start.
MARK = b'<meta name="generator" content="warpwear'


def content_of(result: ResultFile, plot: Plotter) -> dict[str, Any]:
    """Collect what the page of a run shows. plot: of the same result, whose reduced data are used again."""
    with plot.data as data:
        return words_of(result) | {"sections": sections_of(plot, data)}


def top_of(result: ResultFile) -> dict[str, Any]:
    """Collect the texts of the page's top by name: the question, its answers, and why to trust them."""
    study, s = result.study, Summary.of(summarise(result))
    assumptions, checks = words.assumptions_of(study, s), words.checks_of(study, s)
    return {
        "name": study.study.name,
        "description": study.study.description,
        "asked": words.asked_of(study, s.distance),
        "s": s,
        "answers": words.answers_of(study, s),
        "trust": words.trust_of(study, s, assumptions, checks),
        "assumptions": assumptions,
        "checks": checks,
    }


def words_of(result: ResultFile) -> dict[str, Any]:
    """Collect all texts of the page by name."""
    study, top = result.study, top_of(result)
    methods, table = words.methods_of(study, top["s"]), words.table_of(study, top["s"], top["answers"])
    return top | {
        "limits": limits_of(study),
        "summary": summary_text(summarise(result)),
        "methods": methods,
        "table": table,
        "latex": words.latex_of(study, methods, table),
        "version": top["s"].version,
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
