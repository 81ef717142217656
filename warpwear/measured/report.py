"""A report is what a person holds of a file of measurements: its numbers, a text and a figure."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from warpwear.errors import OVERWRITE_IT, InputError, in_python
from warpwear.figures.describe import Figure
from warpwear.figures.paint import paint
from warpwear.figures.style import write_figure
from warpwear.results.frames import package
from warpwear.results.report import Row, record

#: Endings of files that a figure can be written to.
FORMATS = (".png", ".pdf", ".svg")


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Report:
    """A report has numbers, a text for people and a figure. `print` shows the text.

    text: as the command prints it. rows: of which the numbers are made. draw: declares the figure.
    """

    text: str = ""
    rows: Sequence[Row] = ()
    draw: Callable[[], Figure] | None = None

    def __repr__(self) -> str:
        return in_python(self.text)

    @cached_property
    def numbers(self) -> dict[str, Any]:
        """All numbers by name, with their units at the ends of the names, as the command prints by --json."""
        return record(self.rows)

    def to_dataframe(self) -> Any:
        """Return the numbers as a pandas.DataFrame of one row, to be put below those of other files.

        Raises InputError where pandas is not installed.
        """
        return package("pandas", "to_dataframe").json_normalize(self.numbers)

    def figure(self) -> Any:
        """Return the figure, one of matplotlib."""
        return paint(self._declared())

    def save_figure(self, path: str | Path, *, overwrite: bool = False) -> Path:
        """Write the figure to a file.

        Parameters
        ----------
        path
            Ends in .png, .pdf or .svg.
        overwrite
            Whether to replace a file that is there.

        Returns
        -------
        Path
            Of the figure.

        Raises
        ------
        InputError
            For another ending, a folder that does not exist, or a file that is there.
        """
        path = Path(path)
        check_figure(path, overwrite=overwrite)
        save(self._declared(), path)
        return path

    def _declared(self) -> Figure:
        if self.draw is None:
            raise InputError("this report has no figure")
        return self.draw()


def save(figure: Figure, path: Path) -> None:
    """Write a figure in the format that the path's ending names."""
    write_figure(paint(figure), path)


def check_figure(path: Path, *, overwrite: bool) -> None:
    """Raise InputError for a figure that cannot be written."""
    if path.suffix.lower() not in FORMATS:
        raise InputError(f"the figure is {path}: allowed endings are {', '.join(FORMATS)}")
    if not path.parent.is_dir():
        raise InputError(f"the figure is {path}: the folder {path.parent} does not exist")
    if path.exists() and not overwrite:
        raise InputError(f"{path} is there already: give another name, or {OVERWRITE_IT}")
