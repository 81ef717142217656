"""A report is what a person holds of measurements: its numbers, a text, a table and maybe a figure."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from html import escape
from pathlib import Path
from typing import Any, ClassVar

from warpwear import lazy
from warpwear.errors import OVERWRITE_IT, InputError, in_python, prose
from warpwear.figures.describe import Figure
from warpwear.figures.paint import paint
from warpwear.figures.sections import under_headings
from warpwear.figures.style import check_format, write_figure
from warpwear.page.folder import Content, write_report
from warpwear.results.folder import check_folder
from warpwear.results.frames import package
from warpwear.results.report import VALUES, Row, lines, record, to_json, without_nan
from warpwear.version import __version__

html = lazy.module("warpwear.page.html")

#: Endings of files that a figure can be written to.
FORMATS = (".png", ".pdf", ".svg")
#: Lines that a person reads at once, of which one says what was written; how labels begin of the others.
MOST_LINES = 9
SIDE_NUMBERS = tuple(prose("reports")["brief"]["side_numbers"])


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Report:
    """A report has numbers by name, a text for people, which `print` shows, and maybe a figure."""

    def _title(self) -> str:
        """Say in a line what was found."""
        raise NotImplementedError

    def _rows(self) -> Sequence[Row]:
        """Declare all numbers, as they are printed."""
        raise NotImplementedError

    def _table(self) -> Sequence[Sequence[Row]]:
        """Declare the rows of the table, by default one with all numbers."""
        return [self._rows()]

    def _declared(self) -> Figure:
        """Declare the figure. Raises InputError for a report without."""
        raise InputError("this report has no figure")

    def __repr__(self) -> str:
        return f"<{self._title()}>"

    def __str__(self) -> str:
        return "\n".join([self._title(), *lines(self._rows())])

    def _repr_html_(self) -> str:
        return f"<pre>{escape(str(self))}</pre>"

    @cached_property
    def numbers(self) -> dict[str, Any]:
        """All numbers by name, with their units at the ends of the names, as the command prints by --json."""
        return dict(without_nan(record(self._rows())))

    def to_dataframe(self) -> Any:
        """Return the numbers as a table.

        Returns
        -------
        pandas.DataFrame
            A row a test, an area or a speed; without such a single row, to be put below those of others.

        Raises
        ------
        InputError
            Where pandas is not installed.
        """
        return package("pandas", "to_dataframe").json_normalize([record(row) for row in self._table()])

    def figure(self) -> Any:
        """Draw the figure.

        Returns
        -------
        matplotlib.figure.Figure
            The figure.

        Raises
        ------
        InputError
            For a report without one.
        """
        return paint(self._declared())

    def save_figure(self, path: str | Path, *, overwrite: bool = False) -> Path:
        """Write the figure to a file.

        Parameters
        ----------
        path : path
            Ends in .png, .pdf or .svg.
        overwrite : bool
            Whether to replace a file that is there.

        Returns
        -------
        Path
            Of the figure.

        Raises
        ------
        InputError
            For another ending, a folder that does not exist, a file that is there, or a report without one.
        """
        path = Path(path)
        check_figure(path, overwrite=overwrite)
        save(self._declared(), path)
        return path


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class FileReport(Report):
    """A file of measurements has a report, whose main lines `print` shows.

    Attributes
    ----------
    text : str
        All lines, as the command prints them with --details.
    rows : sequence of Row
        Of which the numbers are made.
    draw : callable or None
        Declares the figure.
    """

    text: str = ""
    rows: Sequence[Row] = ()
    draw: Callable[[], Figure] | None = None

    def _title(self) -> str:
        return in_python(self.text.partition("\n")[0])

    def _rows(self) -> Sequence[Row]:
        return self.rows

    def _declared(self) -> Figure:
        return super()._declared() if self.draw is None else self.draw()

    def __str__(self) -> str:
        return in_python(brief(self.text))


class FolderReport:
    """A report is written as a folder of its own, which a file that only such ones have tells from others."""

    #: That file, and what such a folder is called in sentences.
    MARK: ClassVar[str]
    WHAT: ClassVar[str]

    @classmethod
    def check_out(cls, folder: Path, *, file_format: str = "png", overwrite: bool = False) -> None:
        """Raise InputError for what `write` would refuse, before anything is read."""
        check_format(file_format)
        check_folder(folder, [cls.MARK], what=cls.WHAT, overwrite=overwrite)

    def _parts(self, folder: Path) -> dict[str, Any]:
        """Give what `write_report` takes: figures, pages, files and older ones. folder: for links."""
        raise NotImplementedError

    def write(self, folder: str | Path, *, file_format: str = "png", overwrite: bool = False) -> list[Path]:
        """Write page, tables and figures into a folder, all of them or none.

        Parameters
        ----------
        folder : path
            A new or an empty one, or with overwrite that of one of its kind.
        file_format : {"png", "pdf", "svg"}
            Of the figures.
        overwrite : bool
            Whether to replace what was written of its kind into the folder.

        Returns
        -------
        list of Path
            Of all files.

        Raises
        ------
        InputError
            For a folder that holds other files, or another format.
        """
        folder = Path(folder)
        self.check_out(folder, file_format=file_format, overwrite=overwrite)
        return write_report(folder, **self._parts(folder), marks=[self.MARK], file_format=file_format)


def paged(
    report: Any, figures: Mapping[str, Figure], layout: Sequence[Any], table: Content, **said: Any
) -> dict[str, Any]:
    """Give the parts of a report with one page: figures, the page, its table and its numbers.

    layout: as of `under_headings`. said: `name` and `lines` of the report, and `how` it was found.
    """
    kind = report.MARK.removesuffix(".json")
    sections = under_headings(figures, layout)
    content = {"version": __version__, "files": kind, "sections": sections, **said}
    return {
        "figures": figures,
        "pages": {f"{kind}.html": partial(html.page_of, "record.html", content)},
        "files": {f"{kind}.csv": table, report.MARK: to_json(report.numbers) + "\n"},
        "older": [figure for _, _, names, _ in layout for figure in names],
    }


def brief(text: str) -> str:
    """Leave the lines of a report that say most: the first of each label, and all warnings before others."""
    head, *others = text.splitlines()
    kept = [line for line in others if line[:VALUES].strip() and not line[2:].startswith(SIDE_NUMBERS)]
    warnings = [line for line in kept if line.startswith("  warning")]
    kept = [line for line in kept if line not in warnings][: MOST_LINES - 1 - len(warnings)]
    return "\n".join([head, *kept, *warnings])


def closed(text: str, ending: str, *, details: bool) -> str:
    """Close a report with what was written, and without details say how many lines they are."""
    shown = text if details else brief(text)
    more = text.count("\n") - shown.count("\n")
    left_out = f"{more} more line{'s' * (more > 1)} with --details" if more else ""
    return "\n".join(filter(None, [shown, "; ".join(filter(None, [ending, left_out]))]))


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
