"""Write a comparison as a folder: figures and tables, all of them or none."""

from functools import partial
from pathlib import Path

from warpwear.comparison.figures import FIGURES, figures_of
from warpwear.comparison.gather import Comparison
from warpwear.comparison.page import page
from warpwear.comparison.table import write_csv, write_json
from warpwear.figures import style as fs
from warpwear.page.folder import write_report
from warpwear.results.folder import check_folder

#: Every comparison has it, and no other folder.
MARK = "comparison.json"
PAGE = "compare.html"


def check_out(folder: Path, *, file_format: str = "png", overwrite: bool = False) -> None:
    """Raise InputError for what `write` would refuse, before anything is read."""
    fs.check_format(file_format)
    check_folder(folder, [MARK], what="a comparison", overwrite=overwrite)


def write(
    comparison: Comparison, folder: Path, *, file_format: str = "png", overwrite: bool = False
) -> list[Path]:
    """Write figures, page and both tables into a folder; return their paths. Raises InputError.

    file_format: png, pdf or svg. overwrite: replace the comparison that the folder holds, leaving other files
    alone.
    """
    check_out(folder, file_format=file_format, overwrite=overwrite)
    return write_report(
        folder,
        figures_of(comparison),
        pages={PAGE: partial(page, comparison, folder=folder)},
        files={"table.csv": partial(write_csv, comparison), MARK: partial(write_json, comparison)},
        marks=[MARK],
        file_format=file_format,
        older=list(FIGURES),
    )
