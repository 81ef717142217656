"""Which runs are compared, how they are called, and which of them are drawn as one line with a band."""

import csv
import json
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.results.ensemble import at, dotted, is_label, label_of, short_names, that_matter
from warpwear.results.file import FILE_NAME
from warpwear.study.study import Study

#: Table and folder of runs of a sweep.
TABLE, RUNS = "table.csv", "runs"
#: Names of folders that a sweep gives.
HASHED = re.compile(r"[0-9a-f]{64}")
#: Letters of such a name that tell runs apart.
LETTERS = 8
#: Keys that a name says at most; runs that differ in more are called by study and folder.
MOST_KEYS = 4
#: Names that a note lists at most.
MOST_NAMES = 6


@dataclass(frozen=True, eq=False)
class RunData:
    """What is compared of a run; its file is closed."""

    name: str
    folder: Path
    study: Study
    history: dict[str, FloatArray]  # without a swept run's steps that are cut short, see `whole_steps`
    summary: dict[str, Any]
    course: tuple[FloatArray, FloatArray]  # distance [mm] and CoF, of a swept run the means of whole passes
    across: FloatArray  # places across sliding [mm], shape (ny,)
    wear: dict[str, FloatArray]  # body -> depth over `across` at the end [mm]; empty without a snapshot

    @property
    def cof(self) -> FloatArray | None:
        """Coefficient of friction of every step, if it is known."""
        values = self.history["cof"]
        return values if bool(np.isfinite(values).all()) else None


Course = tuple[FloatArray, FloatArray]


@dataclass(frozen=True, eq=False)
class Group:
    """Runs that differ only in what a band is taken over; without bands each run is one."""

    name: str
    runs: tuple[RunData, ...]

    def courses(self, of: Callable[[RunData], Course | None]) -> tuple[FloatArray, FloatArray] | None:
        """Places of the longest course, (places,), and the values of all there, (runs, places); None of none.

        of: gives places and values of a run, each (n,), or None where it has none. NaN beyond its ends.
        """
        known = [course for run in self.runs if (course := of(run)) is not None]
        if not known:
            return None
        places = max((x for x, _ in known), key=lambda x: (x[-1], x.size))
        return places, np.array([at(places, x, values) for x, values in known])


def is_sweep(folder: Path) -> bool:
    """Tell whether a folder is that of a sweep."""
    return (folder / RUNS).is_dir() and not (folder / FILE_NAME).is_file()


def folders_of(given: Sequence[str | Path]) -> tuple[list[Path], list[str]]:
    """Put its finished runs where the folder of a sweep stands, in its table's order; also return notes.

    Raises InputError for a sweep that has not come to its end, or of which no run has.
    """
    found: list[Path] = []
    notes: list[str] = []
    for folder in map(Path, given):
        if not is_sweep(folder):
            found.append(folder)
            continue
        if not (folder / TABLE).is_file():
            raise InputError(
                f"{folder} is a sweep without {TABLE}: it was stopped. Finish it (warpwear sweep --resume), "
                f"or give the folders in {folder / RUNS}"
            )
        with (folder / TABLE).open(newline="", encoding="utf-8") as file:
            rows = [(row.get("run", ""), row.get("status")) for row in csv.DictReader(file)]
        done = dict.fromkeys(run for run, status in rows if status == "done" and HASHED.fullmatch(run))
        if not done:
            raise InputError(f"{folder} is a sweep of which no run has finished: there is nothing to compare")
        if failed := sum(status != "done" for _, status in rows):
            notes.append(f"{failed} of the {len(rows)} runs of {folder} failed and are left out.")
        found += [folder / RUNS / run for run in done]
    return found, notes


def grouped(runs: Sequence[RunData], band_over: Sequence[str]) -> list[Group]:
    """Name each run, and put those that differ in keys of band_over alone into groups.

    Groups are named by what differs between them; so are runs of sweeps, whose folders have no names for
    people. Raises InputError for a key in which no two runs differ.
    """
    differ = differing(runs)
    for key in band_over:
        if key not in differ:
            told = ", ".join(differ) or "nothing"
            raise InputError(f"--band-over {key}: the runs do not differ in it; they differ in {told}")
    by_keys = band_over or any(HASHED.fullmatch(run.folder.name) for run in runs)
    names = _labels(runs, differ) if by_keys else None
    named = [replace(run, name=name) for run, name in zip(runs, unlike(names or _names(runs)), strict=True)]
    if not band_over:
        return [Group(run.name, (run,)) for run in named]
    kept = {key: values for key, values in differ.items() if key not in band_over}
    members: dict[tuple[str, ...], list[int]] = {}
    for number in range(len(runs)):
        members.setdefault(tuple(values[number] for values in kept.values()), []).append(number)
    labels = _labels(runs, kept)
    found = []
    for group in members.values():
        name = labels[group[0]] or "all runs" if labels else f"{named[group[0]].name} and those like it"
        found.append((name, tuple(named[number] for number in group)))
    return [Group(name, of) for name, (_, of) in zip(unlike([n for n, _ in found]), found, strict=True)]


def differing(runs: Sequence[RunData]) -> dict[str, list[str]]:
    """Dotted key -> its value in each run, of the keys in which they differ."""
    flat = [dotted(that_matter(run.study)) for run in runs]
    keys = dict.fromkeys(key for values in flat for key in values)
    found = {key: [_told(values.get(key, "–")) for values in flat] for key in keys}
    differ = {key: values for key, values in found.items() if len(set(values)) > 1}
    return dict(sorted(differ.items(), key=lambda item: is_label(item[0])))  # seeds are said last


def _labels(runs: Sequence[RunData], differ: Mapping[str, list[str]]) -> list[str] | None:
    """Say what sets each run apart, the study's name in front where they have several; None of many keys."""
    if len(differ) > MOST_KEYS:
        return None
    names = short_names(list(differ))
    said = [label_of({key: v[n] for key, v in differ.items()}, names) for n in range(len(runs))]
    titles = [run.study.study.name for run in runs]
    if len(set(titles)) == 1:
        return said
    return [f"{title}, {label}" if label else title for title, label in zip(titles, said, strict=True)]


def _told(value: Any) -> str:
    told = value if isinstance(value, str) else json.dumps(value, default=str, ensure_ascii=False)
    return re.sub(r"^(-?\d+)\.0(?= |$)", r"\1", told)


def _names(runs: Sequence[RunData]) -> list[str]:
    """Name runs by their study, their folder where two are alike, else the path."""
    folders = [run.folder.resolve() for run in runs]
    labels = [run.study.study.name for run in runs]
    short = [f.name[:LETTERS] if HASHED.fullmatch(f.name) else f.name for f in folders]
    for better in (short, [str(run.folder) for run in runs]):
        seen = Counter(labels)
        labels = [new if seen[old] > 1 else old for old, new in zip(labels, better, strict=True)]
    return labels


def unlike(names: Sequence[str], taken: Sequence[str] = (), *, of: str = "") -> Iterator[str]:
    """Give names that differ from each other and from those taken. of: said of one that is taken."""
    found = list(taken)
    for label in names:
        name = label if label not in found else f"{label}{of}"
        count = 2
        while name in found:
            name, count = f"{label} ({count})", count + 1
        found.append(name)
        yield name


def listed(names: Sequence[str], number: int) -> str:
    """List names of runs for a note; many of them by their number alone. number: of all runs."""
    if len(names) <= MOST_NAMES:
        return ", ".join(names)
    return f"all {number} runs" if len(names) == number else f"{len(names)} of the {number} runs"
