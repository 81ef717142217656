"""Compare runs and measurements, for Python and for `warpwear compare`."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Unpack

from warpwear.comparison.courses import rms_of_constant
from warpwear.comparison.figures import FIGURES, figures_of
from warpwear.comparison.groups import RunData, folders_of, grouped, is_sweep, read_run, unlike
from warpwear.comparison.notes import notes_of, other_motion
from warpwear.comparison.page import page
from warpwear.comparison.scar import compare_scar
from warpwear.comparison.table import UNITS, Comparison, to_text, values_of, write_json, write_table
from warpwear.ensembles.ensemble import rms_difference
from warpwear.errors import InputError, in_python, named_in_python
from warpwear.measured.course import experiment_of
from warpwear.measured.experiment import Experiment
from warpwear.measured.friction.record import FrictionRecord
from warpwear.measured.motion import Radius, motion_of, motion_of_runs
from warpwear.measured.options import flag, refuse
from warpwear.measured.report import FolderReport
from warpwear.measured.rows import read_rows
from warpwear.measured.surface import HowToRead, Length, check_options
from warpwear.result import Result
from warpwear.results.frames import package
from warpwear.study.units import several


@dataclass(frozen=True, eq=False, repr=False)
class ComparedRuns(Comparison, FolderReport):
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

    MARK = "comparison.json"
    WHAT = "a comparison"

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

    def _parts(self, folder: Path) -> dict[str, Any]:
        return {
            "figures": figures_of(self),
            "pages": {"compare.html": partial(page, self, folder=folder)},
            "files": {"table.csv": partial(write_table, self), self.MARK: partial(write_json, self)},
            "older": list(FIGURES),
        }


@named_in_python()
def compare(
    *folders: Result | str | Path,
    experiments: FrictionRecord | str | Path | Sequence[FrictionRecord | str | Path] = (),
    band_over: Sequence[str] = (),
    speed: Length | None = None,
    stroke: Length | None = None,
    radius: Radius | None = None,
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
        Tribometers' records of friction, as `read_record` returns them, files, or folders of a record's.
    band_over
        Keys with dots: runs that differ in them alone are one group, with a mean and a band.
    speed, stroke, radius
        Of experiments: speed [mm/s], for records with times; stroke [mm], for records with cycles or
        positions; radius of the track [mm], for records with turns. Or text with a unit; by default those of
        records that were read, else of the runs.
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
        For an unknown option.

    Examples
    --------
    >>> study = warpwear.Study.load("v3-fine").replace({"grid.cell": "20 um", "sliding.distance": "3 mm"})
    >>> for load in ("4 N", "8 N"):
    ...     result = warpwear.run(study.replace({"contact.load": load}), out=load, plots=False)
    >>> warpwear.compare("4 N", "8 N").to_dataframe()["area_contact"].round(3).to_list()
    [0.015, 0.026]
    """
    check_options(how)
    paths, given = [Path(folder) for folder in folders], several(experiments)
    records = [one.analysis.rows.path if isinstance(one, FrictionRecord) else Path(one) for one in given]
    check_choice(paths, records, scar, {"before": before, **how})
    run_folders, left_out = folders_of(paths)
    check_choice(run_folders, records, scar, {})
    for path, count in Counter(path.resolve() for path in (*run_folders, *records)).items():
        if count > 1:
            raise InputError(f"{path} is given {count} times; each run and experiment is expected once")
    groups = grouped([read_run(folder) for folder in run_folders], several(band_over))
    runs = [run for group in groups for run in group.rows]
    of_runs = motion_of_runs(*(run.study for run in runs))
    asked = motion_of(speed=speed, stroke=stroke, radius=radius)
    own = [asked.over(one.motion) if isinstance(one, FrictionRecord) else asked for one in given]
    rows = [e.analysis.rows if isinstance(e, FrictionRecord) else read_rows(e, columns) for e in given]
    courses = [experiment_of(r, m.over(of_runs)) for r, m in zip(rows, own, strict=True)]
    measured = _named(courses, records, [group.name for group in groups])
    groups = [replace(g, rows=tuple(_beside(run, measured) for run in g.rows)) for g in groups]
    earlier = None if before is None else Path(before)
    scars = None if scar is None else compare_scar(Path(scar), earlier, how, runs)
    other = dict.fromkeys(text for motion in own for text in other_motion(motion, of_runs))
    return ComparedRuns(tuple(groups), measured, (*left_out, *other, *notes_of(groups, measured)), scars)


def check_choice(
    folders: Sequence[Path], experiments: Sequence[Path], scar: object, of_scar: Mapping[str, Any]
) -> None:
    """Raise InputError for less than two together, and for options of a scar where there is none.

    A sweep stands for several runs.
    """
    if scar is None:
        refuse({flag(key): value for key, value in of_scar.items()}, "needs --scar")
    elif not folders:
        raise InputError("--scar needs the folder of a run to compare with")
    if len(folders) + sum(map(is_sweep, folders)) + len(experiments) + (scar is not None) < 2:
        first = str([*folders, *experiments, "nothing"][0])
        raise InputError(
            f"compare needs two runs or more, or a run and an --experiment or a --scar; given: {first}"
        )


def _named(courses: list[Experiment], paths: list[Path], taken: Sequence[str]) -> tuple[Experiment, ...]:
    """Name measured courses of friction by their files, unlike the names that groups have taken."""
    stems = Counter(path.stem for path in paths)
    names = [path.name if stems[path.stem] > 1 else path.stem for path in paths]
    labels = unlike(names, taken, suffix=" (experiment)")
    return tuple(replace(course, name=name) for name, course in zip(labels, courses, strict=True))


def _beside(run: RunData, experiments: Iterable[Experiment]) -> RunData:
    """Add to the end values how friction differs from measured courses (rms), and these from constants."""
    course = run.courses.get("cof")
    rms = {f"rms_cof {e.name}": course and rms_difference(course, e.course) for e in experiments}
    rms |= {f"rms_constant {e.name}": course and rms_of_constant(e.course, course) for e in experiments}
    return replace(run, ends={**run.ends, **rms})
