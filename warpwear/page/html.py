"""A report as one self-contained HTML page: templates, embedded figures, a folder never half written."""

import base64
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from warpwear import lazy
from warpwear.figures import style as fs
from warpwear.results.folder import whole_folder

jinja2 = lazy.module("jinja2")

#: Dots per inch of embedded pictures: a page's width of 7 inches then has 1120.
DPI = 160


def render(template: str, filters: Mapping[str, Callable[..., Any]], **content: Any) -> str:
    """Fill a page of `templates/`; what is put in is escaped. A name that is missing is an error.

    filters: name in the template -> function. content: name in the template -> value.
    """
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("warpwear", "templates"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(filters)
    return environment.get_template(template).render(**content)


@dataclass(frozen=True)
class Picture:
    """A figure as the address of a picture that needs no request (PNG, base64), and how wide to show it."""

    source: str
    width: int  # [% of the text's], so that lettering is equally large in all


def embedded(figure: Figure) -> Picture:
    """Make a picture of a figure that a page can hold."""
    picture = BytesIO()
    with fs.style():
        figure.savefig(picture, format="png", dpi=DPI)
    source = "data:image/png;base64," + base64.b64encode(picture.getvalue()).decode("ascii")
    return Picture(source, round(100.0 * min(1.0, figure.get_figwidth() / fs.PAGE)))


def write_report(folder: Path, files: Mapping[str, str]) -> None:
    """Write the texts of a report by name, all or none. Raises InputError."""
    with whole_folder(folder, list(files)) as work:
        for name, text in files.items():
            (work / name).write_text(text, encoding="utf-8")
