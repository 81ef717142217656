"""The cases of the benchmark. A model that is added later adds a function and a line to CASES."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from contenders.roster import (
    Setting,
    steps,
    study_on,
)
from measure.timing import Row, Unit

from cases.displaced import sliding
from cases.on_track import run_full_pass, run_track
from cases.patches import patches
from cases.whole_runs import sampled_run, whole_run
from warpwear import Study

#: Folder of the scripts, on the path of a process that measures for itself.
BENCH = str(Path(__file__).parents[1])
EARLY = [3.0e-3] * 10  # [mm]: near F/H
LATE = [2400.0, 3.0, 3.0]  # implicit steps may be long: most of the footprint touches
EARLY_STEP, LATE_STEP = 3.0e-3, 3.0


def early(cells: int, setting: Setting) -> list[Row]:
    """A step of 3 µm after ten of them: the contact is near F/H."""
    return steps("early", study_on(cells), EARLY, EARLY_STEP, Unit(cells), setting)


def late(cells: int, setting: Setting) -> list[Row]:
    """A step of 3 mm after 2400 mm: 61 % of the domain touches."""
    return steps("late", study_on(cells), LATE, LATE_STEP, Unit(cells), setting)


def run_v3(_: int, setting: Setting) -> list[Row]:
    """The whole of v3: 8000 explicit steps on 150² cells."""
    study = Study.load("v3")
    return whole_run("v3", study, Unit(study.cells.nx), setting, share=0.2 if setting.quick else 1.0)


def run_fine(_: int, setting: Setting) -> list[Row]:
    """The whole of v3-fine: 1099 balanced steps on 1500² cells."""
    return _run("v3-fine", Study.load("v3-fine"), setting)


def run_springs(_: int, setting: Setting) -> list[Row]:
    """The whole of v3-fine on springs of 1.9e6 N/mm³ capped at 590 MPa."""
    study = Study.load("v3-fine").replace(
        {"contact.stiffness": "1.9e6 N/mm^3", "contact.hardness": "590 MPa"}
    )
    return _run("v3-fine-springs", study, setting)


def _run(case: str, study: Study, setting: Setting) -> list[Row]:
    unit = Unit(study.cells.nx)
    if setting.quick:
        return sampled_run(case, study, 8, unit, setting)
    return whole_run(case, study, unit, setting)


@dataclass(frozen=True)
class Case:
    """A line of the table of cases."""

    run: Callable[[int, Setting], list[Row]]
    sizes: tuple[int, ...] | None = None  # cells along a side; None: those asked for
    default_sizes: tuple[int, ...] | None = None  # where none is asked for; None: the table's
    fields: float = 10.5  # float64 fields of that size that it holds at its peak

    @property
    def about(self) -> str:
        return (self.run.__doc__ or "").strip()


CASES: dict[str, Case] = {
    "early": Case(early),
    "late": Case(late),
    "v3": Case(run_v3, sizes=(150,)),
    "v3-fine": Case(run_fine, sizes=(1500,)),
    "v3-fine-springs": Case(run_springs, sizes=(1500,)),
    "sliding": Case(sliding, fields=14.0),
    "patches": Case(patches, sizes=(1500,), fields=20.0),
    "track": Case(run_track, sizes=(750,), fields=40.0),
    "track-pass": Case(run_full_pass, sizes=(1500,), fields=120.0),
}
#: What --quick takes where no size is asked for.
QUICK_SIZES = (2048,)
