"""Read a tribometer's record, say what is in it, and write it as a folder."""

import io
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from warpwear.errors import InputError, named_in_python
from warpwear.measured.friction.analysis import Analysis, analyse
from warpwear.measured.friction.figures import course_figure, figures_of
from warpwear.measured.friction.report import HOW, TEXTS, rows_of, table_of
from warpwear.measured.motion import Motion, Radius, motion_of
from warpwear.measured.report import FileReport, FolderReport, paged
from warpwear.measured.rows import Paths, read_rows, without_offset
from warpwear.results.frames import package
from warpwear.results.report import lines

#: Page and table of a record.
PAGE, TABLE = "record.html", "record.csv"


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class FrictionRecord(FileReport, FolderReport):
    """A record of friction has steps with courses and what happens in them; `print` shows its numbers.

    Attributes
    ----------
    analysis : Analysis
        Its steps (course, laps, events, energy), friction loops, and what was left out.
    motion : Motion
        What was given beside it: radius, stroke [mm], speed [mm/s] and load [N].
    """

    MARK = "record.json"
    WHAT = "a record"
    analysis: Analysis
    motion: Motion

    def to_dataframe(self) -> Any:
        """Return the course as a table.

        Returns
        -------
        pandas.DataFrame
            A row a lap, cycle or group of them, units in the names.

        Raises
        ------
        InputError
            Where pandas is not installed.
        """
        return package("pandas", "to_dataframe").read_csv(io.StringIO(table_of(self.analysis)))

    def __fspath__(self) -> str:
        """Say what to give where a file is expected. Raises InputError."""
        where = "compare takes it in experiments; elsewhere write it, and give its"
        raise InputError(f"a record that was read is no file: {where} {TABLE}")

    def _parts(self, folder: Path) -> dict[str, Any]:
        figures = figures_of(self.analysis)
        name, said = f"Record {self.analysis.rows.path.name}", {"lines": lines(self.rows), "how": HOW}
        return paged(self, figures, TEXTS["sections"], table_of(self.analysis), name=name, **said)


@named_in_python()
def read_record(
    paths: Paths,
    *,
    radius: Radius | None = None,
    stroke: float | str | None = None,
    speed: float | str | None = None,
    load: float | str | None = None,
    columns: str | None = None,
    zero: bool = False,
) -> FrictionRecord:
    """Read a tribometer's record of friction, as its machine wrote it, and find what happens in it.

    Parameters
    ----------
    paths
        A file, a folder of files, or files that follow each other: one record.
    radius
        Of the track [mm], or text with a unit; of several steps one for each, "6 mm, 9 mm".
    stroke
        Length of one pass [mm], or text with a unit, where there is no position.
    speed
        Sliding speed [mm/s], or text with a unit, where there is a time alone.
    load
        Normal load [N], or text with a unit, where it is not recorded.
    columns
        Which columns to take: "DISTANCE,COF", "TIME,FX,FZ" or "TIME,FX,FZ,POSITION".
    zero
        Whether to take off the friction force that is shown without load.

    Returns
    -------
    FrictionRecord
        Course, incubation, jump, steady value with its error, energy, loops, and a figure.

    Raises
    ------
    InputError
        For what is no record, or where it does not say how far it slid.

    References
    ----------
    Killick, Fearnhead and Eckley 2012 (changes of level, by the package ruptures).

    Examples
    --------
    >>> record = warpwear.read_record("ball-on-disc.csv", radius="6 mm")
    >>> round(record.numbers["steady_cof"], 2), round(record.numbers["steady_cof_error"], 3)
    (0.6, 0.007)
    >>> record.analysis.steps[0].events.jump
    Jump(start=1498..., end=1618..., low=0.17..., high=0.64...)
    """
    motion = motion_of(radius=radius, stroke=stroke, speed=speed, load=load)
    table = read_rows(paths, columns)
    analysis = analyse(without_offset(table) if zero else table, motion)
    rows = rows_of(analysis)
    text = "\n".join([f"record {analysis.rows.path}", *lines(rows)])
    draw = partial(course_figure, analysis)
    return FrictionRecord(text=text, rows=rows, draw=draw, analysis=analysis, motion=motion)
