"""Write a report as one self-contained HTML page: templates, figures, a folder never half written."""

import base64
import gzip
import hashlib
import json
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.colors import to_hex

from warpwear.figures import describe, style
from warpwear.figures.describe import Figure, Scene
from warpwear.figures.paint import paint
from warpwear.figures.sections import PageSection
from warpwear.page.plots import plots_of
from warpwear.results.formats.forms import filled
from warpwear.version import __version__

#: Dots per inch of embedded pictures: a page's width of 7 inches then has 1120.
DPI = 160
#: The plotting library: plotly.js 4.1.1 as PyPI's plotly 7.1.0 has it, by gzip -9 -n.
PLOTLY = "plotly.min.js.gz"
#: Scripts and styles beside this wing.
PAGES = Path(__file__).parents[1] / "templates" / "pages"
#: Colours of a scale that the page's script interpolates.
SHADES = 12


def render(template: str, filters: Mapping[str, Callable[..., Any]], **content: Any) -> str:
    """Fill a page of `templates/`, see `filled`, which may run no script unless `content` has a policy."""
    return filled(template, filters, **{"policy": policy(), **content})


def policy(*scripts: str) -> str:
    """Write what a browser may do with a page: run these scripts alone, and ask for nothing.

    Escaping keeps names from becoming scripts; this keeps what slipped through from running.
    """
    hashes = [f"'sha256-{_base64(hashlib.sha256(script.encode()).digest())}'" for script in scripts]
    return (
        "default-src 'none'; img-src data: blob:; style-src 'unsafe-inline'; font-src data:; "
        f"script-src {' '.join(hashes) or repr('none')}; base-uri 'none'; form-action 'none'"
    )


@dataclass(frozen=True)
class Picture:
    """A figure as the address of a picture that needs no request (PNG, base64), and how wide to show it."""

    source: str
    width: int  # [% of the text's], so that lettering is equally large in all


def embedded(figure: Any) -> Picture:
    """Make a picture of a figure that a page can hold."""
    drawn = paint(figure) if isinstance(figure, Figure) else figure
    source = f"data:image/png;base64,{_base64(style.bytes_of(drawn, dpi=DPI))}"
    return Picture(source, round(100.0 * min(1.0, drawn.get_figwidth() / describe.PAGE)))


def run_page(content: Mapping[str, Any], pictures: Mapping[str, bytes]) -> bytes:
    """Make the page of a run. content: of `warpwear.page.content`; pictures: as of `page_of`."""
    return page_of("run.html", content, pictures)


def page_of(template: str, content: Mapping[str, Any], pictures: Mapping[str, bytes]) -> bytes:
    """Make a page with plots, all that it needs in it.

    content: name in the template -> value, of which "sections" are those of `warpwear.figures.sections`.
    pictures: name of a figure -> PNG file, for a page without scripts. Data and plotting library lie
    compressed in the page, where no character of a name can end a script.
    """
    sections = [_section(section) for section in content["sections"]]
    figures = {name: figure for section in content["sections"] for name, figure in section.figures.items()}
    turned = [name for name, f in figures.items() if any(isinstance(panel, Scene) for panel in f.panels)]
    pictures = {**pictures, **{n: style.bytes_of(paint(figures[n]), dpi=DPI) for n in turned}}
    plots = [plot for section in sections for plot in section["plots"]]
    first = {plot["static"]: plot for plot in reversed(plots)}  # of a figure's plots, which has its picture
    for plot in plots:
        png = pictures.get(plot["static"]) if plot is first[plot["static"]] else None
        plot["picture"] = f"data:image/png;base64,{_base64(png)}" if png else ""
    drawn = [{k: v for k, v in plot.items() if k not in ("picture", "caption", "static")} for plot in plots]
    places = np.linspace(0.0, 1.0, SHADES)
    scales = {name: [to_hex(colours(p)) for p in places] for name, colours in style.COLOURS.items()}
    script, plotly = (PAGES / "plots.js").read_text(encoding="utf-8"), (PAGES / PLOTLY).read_bytes()
    data = json.dumps({"plots": drawn, "scales": scales}, default=_plain).encode()
    text = render(
        template,
        {"number": _number},
        **{"version": __version__, **content, "sections": sections},
        data=_base64(zlib.compress(data, 6)),  # deflate with zlib's header, which the script undoes
        plotly=_base64(plotly),
        script=script,
        policy=policy(script, gzip.decompress(plotly).decode()),
    )
    return text.encode("utf-8", "backslashreplace")


def _section(section: PageSection) -> dict[str, Any]:
    """Turn a section into what the templates fill in: its plots, its slider, its legend."""
    plots = [plot for name, figure in section.figures.items() for plot in plots_of(name, figure)]
    maps = [plot for plot in plots if plot["kind"] == "map"]
    legend: dict[str, tuple[str, str]] = {}
    for plot in plots if section.one_legend else ():
        plot["bare"] = True
        legend |= {line["name"]: (line["colour"], line["dash"]) for line in plot["lines"]}
    named, slider = [(name, *look) for name, look in legend.items()], maps[0]["labels"] if maps else []
    return {**vars(section), "plots": plots, "slider": slider, "legend": named}


def _number(value: Any) -> str:
    """Write what stands in a cell of a table: a number in four digits, "–" where there is none."""
    if isinstance(value, float):
        return f"{value:.4g}" if np.isfinite(value) else "–"
    return "–" if value is None else str(value)


def _base64(content: bytes) -> str:
    return base64.b64encode(content).decode("ascii")


def _plain(value: Any) -> Any:
    """Turn an array into what JSON has: its numbers of few bits, x running fastest, as text."""
    if not isinstance(value, np.ndarray):
        return value.item()  # a number of NumPy
    numbers = value if value.dtype.kind == "u" else value.astype(np.float32)
    kind = numbers.dtype.newbyteorder("<")
    return {"type": kind.str[1:], "shape": numbers.shape, "data": _base64(numbers.T.astype(kind).tobytes())}
