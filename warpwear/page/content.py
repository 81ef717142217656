"""Everything that the page of a run shows, as plain content, and the file that it becomes.

Another process may make the page of its content: it needs neither the result nor the study.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.figures.table import Plotter
from warpwear.page.plots import sections_of
from warpwear.page.words import words_of
from warpwear.results import manifest
from warpwear.results.file import ResultFile
from warpwear.results.summary import summarise

#: What makes the page of its content and of pictures, see `warpwear.page.html`.
MAKER = "warpwear.page.html:run_page"
#: What every page of ours holds near its start.
MARK = b'<meta name="generator" content="warpwear'


def content_of(result: ResultFile, plot: Plotter) -> dict[str, Any]:
    """Collect what the page of a run shows. plot: of the same result, whose reduced data are used again."""
    return words_of(result.study, summarise(result)) | {"sections": sections_of(plot)}


def made_here(content: dict[str, Any], pictures: Mapping[str, bytes]) -> bytes:
    """Make the page in this process. pictures: name of a figure -> content of its PNG file."""
    page: bytes = lazy.resolve(MAKER)(content, pictures)
    return page


def statics(content: Mapping[str, Any]) -> list[str]:
    """Names of the figures that stand for plots where no script draws."""
    return [*dict.fromkeys(p["static"] for s in content["sections"] for p in s["plots"] if p["static"])]


def write_page(folder: Path, page: bytes) -> Path:
    """Write the page into a run folder, in place of an older one. Raises InputError for a file of others."""
    path = folder / manifest.PAGE
    try:
        if path.is_symlink() or (path.exists() and MARK not in path.read_bytes()[:20_000]):
            raise InputError(f"{path} is not a page of warpwear; move it away, the page needs its name.")
        new = folder / f".{manifest.PAGE}.partial"
        new.write_bytes(page)
        new.replace(path)
        manifest.add(folder, manifest.PAGE)
    except OSError as error:
        raise InputError(f"{path} cannot be written: {error.strerror}.") from error
    return path
