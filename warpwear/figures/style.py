"""The one style of figures on paper: fonts, scales of colours, numbers along axes, formats of files."""

from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axis import Axis
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import LogFormatter, MaxNLocator, ScalarFormatter

from warpwear.errors import InputError, escaped
from warpwear.figures import wording

#: Pale to dark, so that little pressure is still seen on white paper and grey keeps the order.
PRESSURES = LinearSegmentedColormap.from_list(
    "pressures", matplotlib.colormaps["viridis"](np.linspace(0.93, 0.0, 256))
)
COLOURS: dict[str, Any] = {
    "pressures": PRESSURES,
    "heights": matplotlib.colormaps["cividis"],
    "depths": matplotlib.colormaps["magma_r"],
    "signed": matplotlib.colormaps["RdBu_r"],
}

#: Formats of files, each with the metadata of them in which Matplotlib would write the date.
FORMATS: dict[str, dict[str, None]] = {"png": {}, "pdf": {"CreationDate": None}, "svg": {"Date": None}}

#: What Matplotlib is set to; its own form of such settings.
SHEET = Path(__file__).parents[1] / "templates" / "formats" / "paper.mplstyle"
STYLE = matplotlib.rc_params_from_file(SHEET, use_default_template=False)
#: Compression of PNG: more makes files a quarter smaller, and takes a third of a figure's time.
COMPRESSION = {"compress_level": 1}


def style() -> Any:
    """Open the context in which figures are made and written."""
    return matplotlib.rc_context(STYLE)


def check_format(file_format: str) -> None:
    """Raise InputError for a format of files that is not in FORMATS."""
    if file_format not in FORMATS:
        raise InputError(f"format = '{file_format}' is not known; allowed: {', '.join(FORMATS)}")


def write_figure(figure: Figure, path: Path) -> None:
    """Write a figure as its path ends, without a date: the same run gives the same file."""
    path.write_bytes(bytes_of(figure, path.suffix.removeprefix(".")))


def bytes_of(figure: Figure, file_format: str = "png", *, dpi: float | str = "figure") -> bytes:
    """Return the content of the file that holds a figure in one of `FORMATS`."""
    written = BytesIO()
    more: Any = {"pil_kwargs": COMPRESSION} if file_format == "png" else {}
    for text in figure.findobj(Text):  # names of files
        text.set_text(escaped(text.get_text()))
    with style():
        figure.savefig(written, format=file_format, dpi=dpi, metadata=FORMATS[file_format], **more)
    return written.getvalue()


def inner_ticks(ends: tuple[float, float], corner: float) -> list[float]:
    """Choose two to five ticks of an axis, none in its ends, a part `corner` of it each."""
    room = corner * (ends[1] - ends[0])
    low, high = ends[0] + room, ends[1] - room
    ticks = MaxNLocator(4, steps=[1, 2, 5, 10]).tick_values(low, high)
    return [float(tick) for tick in ticks if low < tick < high]


def plain_numbers(axis: Axis, *, decades: float = 0.5) -> None:
    """Write 0.1 or 10⁻⁵ instead of 1e-01 along a logarithmic axis, between decades where it spans few.

    decades: span of the axis up to which all ticks are labelled, see `minor_thresholds` of LogFormatter.
    """
    axis.set_major_formatter(PlainNumbers())
    axis.set_minor_formatter(PlainNumbers(minor_thresholds=(1.2, decades)))


class PlainNumbers(LogFormatter):
    """Writes 0.1 or 10⁻⁵ instead of 1e-01, at the ticks that a logarithmic axis labels.

    Without the setting of formulas, which takes as long as the rest of a small figure.
    """

    def __call__(self, x: float, pos: int | None = None) -> str:
        """Write the number at a tick."""
        return wording.short(x) if super().__call__(x, pos) else ""


class Thousands(ScalarFormatter):
    """Writes 20 000 instead of 20000 along a linear axis."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        """Write the number at a tick."""
        return wording.short(x) if wording.THOUSANDS <= abs(x) < 1e5 else super().__call__(x, pos)
