"""Compare runs and measurements, for Python and for `warpwear compare`."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Unpack

from warpwear.comparison.folder import write
from warpwear.comparison.gather import Comparison, check_number, gather
from warpwear.comparison.scar import ScarFiles
from warpwear.comparison.table import UNITS, to_text
from warpwear.comparison.table import columns as values_of
from warpwear.errors import in_python, named_in_python
from warpwear.measured.options import flag, refuse
from warpwear.measured.rows import Paths
from warpwear.measured.surface import HowToRead, Length, check_options
from warpwear.page.folder import WrittenAsFolder
from warpwear.result import Result
from warpwear.results.frames import package
from warpwear.study.units import several


@dataclass(frozen=True, eq=False, repr=False)
class ComparedRuns(Comparison, WrittenAsFolder):
    """Runs in groups, experiments and a measured scar are laid beside each other; `print` shows the table.

    Attributes
    ----------
    groups : tuple of Group
        Runs that are one line, with mean and band.
    experiments : tuple of Experiment
        Measured courses of friction.
    notes : tuple of str
        What is to be said about them.
    scar : ScarComparison or None
        A measured scar over the computed ones.
    """

    def __repr__(self) -> str:
        return in_python(to_text(self))

    def to_dataframe(self) -> Any:
        """Return the values as a table.

        Returns
        -------
        pandas.DataFrame
            A row a group of runs or an experiment, units in ``attrs``.

        Raises
        ------
        InputError
            Where pandas is not installed.
        """
        frame = package("pandas", "to_dataframe").DataFrame.from_dict(values_of(self), orient="index")
        frame.attrs["units"] = UNITS
        return frame

    def _write(self, folder: Path, *, file_format: str, overwrite: bool) -> list[Path]:
        return write(self, folder, file_format=file_format, overwrite=overwrite)


@named_in_python()
def compare(
    *folders: Result | str | Path,
    experiments: Paths = (),
    band_over: Sequence[str] = (),
    speed: Length | None = None,
    stroke: Length | None = None,
    columns: str | None = None,
    scar: str | Path | None = None,
    before: str | Path | None = None,
    **how: Unpack[HowToRead],
) -> ComparedRuns:
    """Lay runs, measured courses of friction and a measured wear scar over each other.

    Parameters
    ----------
    *folders
        Of runs, as paths or results, or of sweeps for all their runs; two or more, or one beside an
        experiment or a scar.
    experiments
        Tribometers' records of friction, or folders of their files.
    band_over
        Keys with dots: runs that differ in them alone are one group, with a mean and a band.
    speed, stroke
        Of experiments that give times [mm/s], or cycles or positions [mm], or text with a unit; by default
        those of the runs.
    columns
        Which columns of experiments to take, as for `read_record`.
    scar, before
        The worn disc, to lay over the computed scars, and the same place before it was worn.
    **how
        How these two are read, as for `read_surface`.

    Returns
    -------
    ComparedRuns
        A table of the ends, groups and courses, and `write` for figures and page.

    Raises
    ------
    InputError
        For fewer than two of them together, and for what is no run, record or scar.
    TypeError
        For an option that there is not.

    Examples
    --------
    >>> study = warpwear.Study.load("v3-fine").replace({"grid.cell": "20 um", "sliding.distance": "3 mm"})
    >>> for load in ("4 N", "8 N"):
    ...     result = warpwear.run(study.replace({"contact.load": load}), out=load, plots=False)
    >>> warpwear.compare("4 N", "8 N").to_dataframe()["area_contact"].round(3).to_list()
    [0.015, 0.026]
    """
    check_options(how)
    paths, records = [Path(folder) for folder in folders], several(experiments)
    check_choice(paths, records, scar, {"before": before, **how})
    files = None if scar is None else ScarFiles(Path(scar), None if before is None else Path(before), how)
    settings: Any = {"band_over": several(band_over), "speed": speed, "stroke": stroke, "columns": columns}
    return ComparedRuns(**vars(gather(paths, records, scar=files, **settings)))


def check_choice(
    folders: Sequence[str | Path], experiments: Sequence[str | Path], scar: object, of_scar: Mapping[str, Any]
) -> None:
    """Raise InputError for fewer than two, and for options of a scar where there is none."""
    if scar is None:
        refuse({flag(key): value for key, value in of_scar.items()}, "needs --scar")
    check_number(folders, experiments, scar)
