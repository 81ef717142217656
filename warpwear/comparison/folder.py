"""A comparison as a folder: figures and tables, all of them or none."""

from pathlib import Path

from warpwear.comparison.figures import FIGURES, drawn
from warpwear.comparison.gather import Comparison
from warpwear.comparison.page import page
from warpwear.comparison.table import write_csv, write_json
from warpwear.figures import style as fs
from warpwear.results.folder import check_folder, whole_folder

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
    older = [f"{name}.{kind}" for name in FIGURES for kind in fs.FORMATS]
    with whole_folder(folder, [MARK], stale=older) as work:
        pictures = {}
        for name, figure in drawn(comparison):
            pictures[name] = fs.bytes_of(figure)
            written = pictures[name] if file_format == "png" else fs.bytes_of(figure, file_format)
            (work / f"{name}.{file_format}").write_bytes(written)
        (work / PAGE).write_bytes(page(comparison, pictures, folder))
        write_csv(comparison, work / "table.csv")
        write_json(comparison, work / MARK)
        names = sorted((path.name for path in work.iterdir()), key=lambda name: (name == MARK, name))
    return [folder / name for name in names]
