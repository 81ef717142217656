"""Run the command `warpwear record`, from its options to the text it prints and the folder it writes."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from warpwear.figures import style
from warpwear.figures.sections import under_headings
from warpwear.measured.friction.analysis import Analysis, analyse
from warpwear.measured.friction.figures import figures_of
from warpwear.measured.friction.report import HOW, rows_of, table_of
from warpwear.measured.motion import Motion
from warpwear.measured.options import Options, quantity
from warpwear.measured.rows import read_rows
from warpwear.page.folder import write_report
from warpwear.page.html import page_of
from warpwear.results.folder import check_folder
from warpwear.results.report import lines, record, to_json
from warpwear.version import __version__

#: What every folder of a record has, its page, and its table.
MARK, PAGE, TABLE = "record.json", "record.html", "record.csv"
#: Options that are one quantity -> their units.
UNITS = {"stroke": "mm", "speed": "mm/s", "load": "N"}
CAPTION = "Means, with the standard deviation of the points within; the part that the steady value is of."
SECTIONS = (("Course", "course", ("course",), CAPTION), ("Friction loops", "loops", ("loops",), ""))


def describe(
    files: Sequence[Path],
    *,
    as_json: bool = False,
    out: Path | None = None,
    file_format: str = "png",
    overwrite: bool = False,
    **options: Any,
) -> str:
    """Say what a record of friction holds, as text for people or as JSON, and write its folder.

    out: the folder, None for a name made from the file's, and with as_json for none. options: radius,
    lengths with a unit, one or one for each step, between commas; stroke, speed, load: texts with a unit;
    columns. Raises InputError.
    """
    o = Options(options)
    radii = o["--radius"] and [quantity("--radius", one.strip(), "mm") for one in o["--radius"].split(",")]
    lengths = {name: o.optional(f"--{name}", unit) for name, unit in UNITS.items()}
    motion = Motion(radius=radii, **lengths)
    folder = out if out is not None else None if as_json else Path(f"{_name(files)}-record")
    end = ""
    if folder is not None:
        style.check_format(file_format)
        if out is None and folder.exists() and not overwrite:  # the numbers are asked for all the same
            end = f"{folder} is there already and was not written again: --overwrite replaces it"
            folder = None
        else:
            check_folder(folder, [MARK], what="a record", overwrite=overwrite)
    analysis = analyse(read_rows(files if len(files) > 1 else files[0], o["--columns"]), motion)
    rows = rows_of(analysis)
    if folder is not None:
        _write(analysis, folder, file_format=file_format)
        end = f"written to {folder}/: {PAGE}, {TABLE}, {MARK}, figures"
    if as_json:
        return to_json(record(rows))
    return "\n".join([f"record {analysis.rows.path}", *lines(rows), *([end] if end else [])])


def _name(files: Sequence[Path]) -> str:
    first = files[0].resolve()
    return first.name if first.is_dir() else first.stem


def _write(analysis: Analysis, folder: Path, *, file_format: str) -> None:
    """Write page, table, JSON and figures, all of them or none. Raises InputError."""
    rows, figures = rows_of(analysis), figures_of(analysis)
    content = {
        "name": f"Record {analysis.rows.path.name}",
        "version": __version__,
        "lines": lines(rows),
        "how": HOW,
        "sections": under_headings(figures, SECTIONS),
    }
    write_report(
        folder,
        figures,
        pages={PAGE: partial(page_of, "record.html", content)},
        files={TABLE: table_of(analysis), MARK: to_json(record(rows)) + "\n"},
        marks=[MARK],
        file_format=file_format,
        older=["course", "loops"],
    )
