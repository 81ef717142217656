"""What a sweep leaves in its folder: tables, figures, and a page that shows them without a network."""

import tempfile
from functools import partial
from pathlib import Path

import numpy as np

from warpwear.ensembles.ensemble import Group
from warpwear.errors import InputError
from warpwear.history.end_values import ENDS
from warpwear.history.quantities import Quantity
from warpwear.measured.experiment import Experiment
from warpwear.page.folder import write_report as write_folder
from warpwear.results import manifest
from warpwear.results.ensemble import band_name
from warpwear.sweeps.figures import figures_of
from warpwear.sweeps.page import MOST_FAILURES, failures, page
from warpwear.sweeps.table import TABLES, SweepResult, SweepRow

#: The page of a sweep.
PAGE = "sweep.html"
#: What a sweep writes beside its runs and figures.
FILES = (*TABLES, PAGE)
#: Index or correlation below which a key decides nothing.
IDLE = 0.02


def write_report(result: SweepResult, folder: Path, experiments: tuple[Experiment, ...] = ()) -> list[Path]:
    """Write `FILES` and figures/, each as a whole; return what was written.

    Raises InputError where they cannot be written; the runs are kept.
    """
    try:
        with tempfile.TemporaryDirectory(prefix=".tables-", dir=folder) as name:
            work = Path(name)
            result.write_tables(work)
            figures, make = figures_of(result, experiments), partial(page, result, experiments=experiments)
            write_folder(work, figures, pages={PAGE: make}, within=manifest.FIGURES)
            return _moved(work, folder)
    except (OSError, InputError) as error:
        cause = error.__cause__ if isinstance(error, InputError) else error
        if not isinstance(cause, OSError):
            raise
        raise InputError(
            f"out = {folder}: tables and figures could not be written: {cause.strerror or cause}; the runs "
            "are kept, and the same command with --resume writes them"
        ) from error


def _moved(work: Path, folder: Path) -> list[Path]:
    """Move tables and figures into the folder of a sweep, in place of its older ones alone."""
    ours = manifest.written(folder)
    tables = [name for name in FILES if (work / name).is_file()]
    names = [*tables, *sorted(f"{manifest.FIGURES}/{path.name}" for path in work.glob("*/*.png"))]
    (folder / manifest.FIGURES).mkdir(exist_ok=True)
    for name in {*names} - ours:
        manifest.set_aside(folder / name)
    manifest.write(folder, ours | {*names}, work=work)
    return [(work / name).replace(folder / name) for name in names]


def summary_text(result: SweepResult) -> str:
    """Return the groups of a sweep and what decides the coefficient of friction, for the screen."""
    done = sum(row.status == "done" for row in result.rows)
    lines = [f"{done} of {len(result.rows)} runs done"]
    groups = result.ensemble().groups
    width = max(len(group.name) for group in groups)
    given = result.plan.study.friction.fitted in ("end", "coulomb", "states")  # then it is no answer
    told = ENDS["area_contact" if given else "cof"]
    lines += [f"{g.name:<{width}}  {_end_of(g, told)}" for g in groups]
    if len(result.plan.keys) > 1 and done > 1:
        indices, what = result.sobol(), "rank correlation; of words and seeds η²"
        what = what if indices is None else "Sobol's total index, 95 % interval"
        shares = ", ".join(f"{key} {words}" for key, words in result.influence_in_words().items())
        lines.append(f"what decides it ({what}): {shares}")
        lines += [indices.doubt] if indices is not None and indices.doubt else []
        lines += _without_influence(result)
    return "\n".join([*lines, *failures(result)])


def _without_influence(result: SweepResult) -> list[str]:
    """Say why a hardness that is varied decides nothing: of a disc at rest that has run in."""
    study, influence = result.plan.study, result.influence()
    idle = [key for key in influence if key.endswith(".hardness") and abs(influence[key]) < IDLE]
    runs_in = not study.is_swept and study.study.model == "micro" and study.stepping.scheme == "implicit"
    if not idle or not runs_in:
        return []
    why = "a disc at rest runs in until no cell is at the hardness; it decides early friction, and a track"
    return [f"{' and '.join(idle)} without influence at the end: {why}"]


def _end_of(group: Group[SweepRow], told: Quantity) -> str:
    """Return what the runs of a group came to, for the screen."""
    mean, low, high = group.band(told.name)
    if not np.isfinite(mean):
        return f"no {told.label}"
    name = band_name(len(group.numbers(told.name)))
    band = f", {name} of {len(group.rows)} runs: {low:.4g} to {high:.4g}" * (len(group.rows) > 1)
    return f"{told.label} {mean:.4g} {told.unit}".rstrip() + band


def failed_sentence(result: SweepResult) -> str | None:
    """Say how many runs failed, which, and where it says why; None where all are done."""
    failed = [number for number, row in enumerate(result.rows) if row.status != "done"]
    if not failed:
        return None
    named = ", ".join(map(str, failed[:MOST_FAILURES])) + (", …" if len(failed) > MOST_FAILURES else "")
    where = "the result's table" if result.folder is None else str(result.folder / "table.csv")
    return (
        f"{len(failed)} of {len(result.rows)} runs failed, row{'s' * (len(failed) > 1)} {named} from 0: the "
        f"column status of {where} says why"
    )
