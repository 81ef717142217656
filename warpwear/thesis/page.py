"""A report as one self-contained HTML page: templates, embedded figures, a folder never half written."""

import base64
import shutil
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.figures import style as figure_style

jinja2 = lazy.module("jinja2")

#: Of embedded pictures: a page's width of 7 inches then has 1120 points.
DPI = 160


def render(template: str, filters: Mapping[str, Callable[..., Any]], **content: Any) -> str:
    """A page from `templates/`; whatever is put in is escaped. A name that is missing is an error."""
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
    """The figure for a page."""
    picture = BytesIO()
    with figure_style.style():
        figure.savefig(picture, format="png", dpi=DPI)
    source = "data:image/png;base64," + base64.b64encode(picture.getvalue()).decode("ascii")
    return Picture(source, round(100.0 * min(1.0, figure.get_figwidth() / figure_style.PAGE)))


def check_folder(folder: Path, names: tuple[str, ...], *, overwrite: bool) -> None:
    """InputError unless the files may be written there; nothing is left behind. names: of the files."""
    for path in (folder, *folder.parents):
        if path.exists() and not path.is_dir():
            raise InputError(f"out = {folder}: {path} is a file; the name of a folder is expected.")
    if folder.is_dir() and any(folder.iterdir()):
        if not all((folder / name).is_file() for name in names):
            raise InputError(f"out = {folder} holds other files; an empty or a new folder is expected.")
        if not overwrite:
            raise InputError(f"out = {folder} already holds a report; give another --out, or --overwrite it.")
    try:
        with tempfile.TemporaryFile(dir=_inside(folder)):
            pass
    except OSError as error:
        raise InputError(f"out = {folder} cannot be written: {error.strerror}.") from error


def write_folder(folder: Path, files: Mapping[str, str]) -> None:
    """Write texts by name, all or none, through a work folder inside or beside. InputError if it fails."""
    try:
        work = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=_inside(folder)))
        try:
            work.chmod(0o755)
            for name, text in files.items():
                (work / name).write_text(text, encoding="utf-8")
            if folder.is_dir():
                for name in files:
                    (work / name).replace(folder / name)
            else:
                folder.parent.mkdir(parents=True, exist_ok=True)
                work.rename(folder)
        finally:
            shutil.rmtree(work, ignore_errors=True)
    except OSError as error:
        why = error.strerror or str(error)
        raise InputError(f"out = {folder} could not be written and holds no new report: {why}.") from error


def _inside(folder: Path) -> Path:
    """The folder, or the nearest parent that exists."""
    folder = folder.absolute()
    return folder if folder.is_dir() else next(parent for parent in folder.parents if parent.is_dir())
