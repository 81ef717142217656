"""Everything that the page of a run shows, as plain content: another process may make the page of it."""

from typing import Any

from warpwear.figures.table import Plotter
from warpwear.page.plots import sections_of
from warpwear.page.words import words_of
from warpwear.results.file import ResultFile
from warpwear.results.summary import summarise

#: The page's name in a run folder.
NAME = "report.html"
#: What makes the page of its content and of the figures' pictures, see `warpwear.page.html`.
MAKER = "warpwear.page.html:run_page"
#: Figures that stand in the page where no script draws.
STATIC = ("setup", "pressure_map", "contact_map", "areas", "cof", "profiles", "roughness", "groove", "load_share")


def content_of(result: ResultFile, plot: Plotter) -> dict[str, Any]:
    """Collect what the page of a run shows. plot: of the same result, whose reduced data are used again."""
    words = words_of(result.study, summarise(result))
    return words | {"sections": sections_of(plot)}
