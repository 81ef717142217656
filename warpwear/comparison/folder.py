"""A comparison as a folder: figures and tables, all of them or none."""

import shutil
import tempfile
from pathlib import Path

from warpwear.comparison.figures import FIGURES, drawn
from warpwear.comparison.gather import Comparison
from warpwear.comparison.table import write_csv, write_json
from warpwear.errors import InputError
from warpwear.figures import style as figure_style

#: Format -> what is said in a file beside the figure: no date, so that the same runs give the same file.
FORMATS: dict[str, dict[str, None]] = {"png": {}, "pdf": {"CreationDate": None}, "svg": {"Date": None}}
#: Every comparison has it, and no other folder.
MARK = "comparison.json"


def check_out(folder: Path, *, file_format: str = "png", overwrite: bool = False) -> None:
    """InputError for what `write` would refuse, before anything is read."""
    if file_format not in FORMATS:
        raise InputError(f"format = '{file_format}' is not known; allowed: {', '.join(FORMATS)}")
    for path in (folder, *folder.parents):
        if path.exists() and not path.is_dir():
            raise InputError(f"out = {folder}: {path} is a file; the name of a folder is expected")
    if folder.is_dir() and any(folder.iterdir()):
        if not (folder / MARK).is_file():
            raise InputError(f"out = {folder} holds other files; an empty or a new folder is expected")
        if not overwrite:
            raise InputError(
                f"out = {folder} already holds a comparison; give another --out, or --overwrite it"
            )


def write(
    comparison: Comparison, folder: Path, *, file_format: str = "png", overwrite: bool = False
) -> list[Path]:
    """Write figures, table.csv and comparison.json into a folder; returns their paths. Raises InputError.

    file_format: png, pdf or svg. overwrite: replace the comparison that the folder holds, leaving other files
    alone.
    """
    check_out(folder, file_format=file_format, overwrite=overwrite)
    inside = folder if folder.is_dir() else next(p for p in folder.absolute().parents if p.is_dir())
    work = None
    try:
        work = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=inside))
        work.chmod(0o755)
        with figure_style.style():
            for name, figure in drawn(comparison):
                figure.savefig(work / f"{name}.{file_format}", metadata=FORMATS[file_format])
        write_csv(comparison, work / "table.csv")
        write_json(comparison, work / MARK)
        names = sorted((path.name for path in work.iterdir()), key=lambda name: (name == MARK, name))
        if not folder.is_dir():
            folder.parent.mkdir(parents=True, exist_ok=True)
            work.rename(folder)
        else:
            for name in FIGURES:  # of the comparison that is replaced
                for kind in FORMATS:
                    (folder / f"{name}.{kind}").unlink(missing_ok=True)
            for name in names:  # its mark last
                (work / name).replace(folder / name)
    except OSError as error:
        raise InputError(f"out = {folder} could not be written: {error.strerror or error}") from error
    finally:
        if work is not None:
            shutil.rmtree(work, ignore_errors=True)
    return [folder / name for name in names]
