"""Constants of friction by three states from courses of one pair."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from warpwear.errors import named_in_python
from warpwear.measured.course import experiment_of
from warpwear.measured.friction.analysis import lap_of
from warpwear.measured.friction.report import labelled
from warpwear.measured.friction.states import StatesFit, fit_states, part_of, states_rows
from warpwear.measured.motion import motion_of
from warpwear.measured.options import optional
from warpwear.measured.report import Report
from warpwear.measured.rows import read_rows
from warpwear.results.report import Row, record
from warpwear.study.units import TINIEST, several

#: Numbers of a fit that are keys.
KEYS = 7


@dataclass(frozen=True, kw_only=True, repr=False)
class StatesCalibration(Report):
    """Hold the constants of [friction.states] of one course, or of several of one pair.

    Attributes
    ----------
    fits : dict
        Name of a course -> its `numbers` with errors, `values` with their `covariance`, and `rms`; of several
        courses with one spread and one friction of bare metal.
    alone : dict
        The same of each course by itself.
    """

    fits: dict[str, StatesFit]
    alone: dict[str, StatesFit]

    def _title(self) -> str:
        return "friction by film, bare metal and cover: a law that fits, not a prediction"

    def _rows(self) -> list[Row]:
        if len(self.fits) == 1:
            return self._table()[0]
        named = [[Row("", "name", name), *rows] for name, rows in zip(self.fits, self._table(), strict=True)]
        told = [row for rows in named for row in (Row(rows[0].value, "", ""), *labelled(rows))]
        return [*told, Row("", "tests", [record(rows) for rows in named])]

    def _table(self) -> list[list[Row]]:
        alone = {name: fit.rms for name, fit in self.alone.items()}
        return [
            [
                *states_rows(fit),
                Row("rms by itself" * (len(self.fits) > 1), "rms_alone", alone[name], digits=2),
                Row("in a study", "", _in_study(fit)),
            ]
            for name, fit in self.fits.items()
        ]


def _in_study(fit: StatesFit) -> str:
    """Write a fit as keys of a study; a cycle is the lap of two strokes."""
    if fit.numbers["seed"][0] < TINIEST:
        return f"none: the seed is below {TINIEST:g}, which no key is"
    keys = ", ".join(f"{name} = {value:.4g}" for name, (value, _) in [*fit.numbers.items()][:KEYS])
    per = "mm" if fit.unit == "mm" else "lap"
    return f'[friction] law = "states", [friction.states] {keys}, per = "{per}"'


@named_in_python()
def calibrate_states(
    experiments: str | Path | Sequence[str | Path],
    *,
    columns: str | None = None,
    radius: Any = None,
    stroke: Any = None,
    speed: Any = None,
    load: Any = None,
    until: Any = None,
) -> StatesCalibration:
    """Find the constants of friction by film, bare metal and cover from courses of friction.

    Parameters
    ----------
    experiments : path, or list of paths
        Records of tests of one pair. Of several the rate of spreading and the friction of bare metal, which
        are the pair's, are fitted at once; all else is each test's own.
    columns : str, optional
        Which columns of the records to take.
    radius, stroke, speed, load : str, optional
        Of the track, of one pass, of sliding, and the normal load, where the records do not say them. Without
        radius, stroke, or laps beside distances, rates are per mm.
    until : str, optional
        Sliding distance up to which courses are fitted; by default thrice that of the end of the jump.

    Returns
    -------
    StatesCalibration
        The constants with errors and covariances, wait, width, overshoot and level.

    Raises
    ------
    InputError
        For a record that cannot be read, or whose friction does not rise.

    Examples
    --------
    >>> found = warpwear.calibrate_states("ball-on-disc.csv", radius="6 mm", until="4 m")
    >>> wait, error = found.fits["ball-on-disc"].numbers["wait"]
    >>> round(wait)
    41
    """
    motion = motion_of(radius=radius, stroke=stroke, speed=speed, load=load)
    end = optional("--until", until, "mm")
    parts = {}
    for path in several(experiments):
        rows = read_rows(path, columns)
        course = experiment_of(rows, motion)
        name = course.name if course.name not in parts else str(path)
        parts[name] = part_of(course, lap_of(rows, motion), end)
    alone = {name: fit_states([part])[0] for name, part in parts.items()}
    fits = alone if len(parts) == 1 else dict(zip(parts, fit_states([*parts.values()]), strict=True))
    return StatesCalibration(fits=fits, alone=alone)
