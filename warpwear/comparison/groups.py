"""Which runs are compared, how they are called, and which of them are drawn as one line with a band."""

import csv
import json
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.history.end_values import Summary
from warpwear.results.ensemble import at, is_label, label_of, short_names, that_matter
from warpwear.results.file import FILE_NAME
from warpwear.study.keys import dotted
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
    """Hold what is compared of a run; its file is closed."""

    name: str
    folder: Path
    study: Study
    history: dict[str, FloatArray]  # without a swept run's steps that are cut short, see `whole_steps`
    summary: Summary
    course: tuple[FloatArray, FloatArray]  # distance [mm] and CoF, of a swept run the means of whole passes
    across: FloatArray  # places across sliding [mm], shape (ny,)
    wear: dict[str, FloatArray]  # body -> depth over `across` at the end [mm]; empty without a snapshot

    @property
    def cof(self) -> FloatArray | None:
        """Return the coefficient of friction of every step, if it is known."""
        values = self.history["cof"]
        return values if bool(np.isfinite(values).all()) else None


Course = tuple[FloatArray, FloatArray]


@dataclass(frozen=True, eq=False)
class Group:
    """Hold runs that differ only in what a band is taken over; without bands each run is one."""

    name: str
    runs: tuple[RunData, ...]

    def courses(self, course_of: Callable[[RunData], Course | None]) -> tuple[FloatArray, FloatArray] | None:
        """Return places of the longest course, (places,), and all values there, (runs, places); None of none.

        course_of: gives places and values of a run, (n,) each, or None. NaN beyond the ends of a course.
        """
        known = [course for run in self.runs if (course := course_of(run)) is not None]
        if not known:
            return None
        places = max((x for x, _ in known), key=lambda x: (x[-1], x.size))
        return places, np.array([at(places, x, values) for x, values in known])


def is_sweep(folder: Path) -> bool:
    """Tell whether a folder is that of a sweep."""
    return (folder / RUNS).is_dir() and not (folder / FILE_NAME).is_file()


def folders_of(folders: Sequence[str | Path]) -> tuple[list[Path], list[str]]:
    """Put its finished runs where the folder of a sweep stands, in its table's order; also return notes.

    Raises InputError for a sweep that has not come to its end, or of which no run has.
    """
    run_folders: list[Path] = []
    notes: list[str] = []
    for folder in map(Path, folders):
        if folder.is_file() and not h5py.is_hdf5(folder):
            raise InputError(f"{folder} is no run; give records by --experiment, experiments=[…]")
        if not is_sweep(folder):
            run_folders.append(folder)
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
        run_folders += [folder / RUNS / run for run in done]
    return run_folders, notes


def grouped(runs: Sequence[RunData], band_over: Sequence[str]) -> list[Group]:
    """Name each run, and put those that differ in keys of band_over alone into groups.

    Groups are named by what differs between them; so are runs of sweeps, whose folders have no names for
    people. Raises InputError for a key in which no two runs differ.
    """
    differ = differing(runs)
    for key in band_over:
        if key not in differ:
            others = ", ".join(differ) or "nothing"
            raise InputError(f"--band-over {key}: the runs do not differ in it; they differ in {others}")
    by_keys = band_over or any(HASHED.fullmatch(run.folder.name) for run in runs)
    names = _labels(runs, differ) if by_keys else None
    named = [replace(run, name=name) for run, name in zip(runs, unlike(names or _names(runs)), strict=True)]
    if not band_over:
        return [Group(run.name, (run,)) for run in named]
    between = {key: values for key, values in differ.items() if key not in band_over}
    groups: dict[tuple[str, ...], list[int]] = {}
    for number in range(len(runs)):
        groups.setdefault(tuple(values[number] for values in between.values()), []).append(number)
    labels = _labels(runs, between) or [f"{run.name} and those like it" for run in named]
    titles = unlike([labels[numbers[0]] or "all runs" for numbers in groups.values()])
    members = (tuple(named[number] for number in numbers) for numbers in groups.values())
    return [Group(title, those) for title, those in zip(titles, members, strict=True)]


def differing(runs: Sequence[RunData]) -> dict[str, list[str]]:
    """Map each dotted key in which runs differ to its value in each of them."""
    flat = [dotted(that_matter(run.study)) for run in runs]
    keys = dict.fromkeys(key for values in flat for key in values)
    texts = {key: [_written(values.get(key, "–")) for values in flat] for key in keys}
    differ = {key: values for key, values in texts.items() if len(set(values)) > 1}
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


def _written(value: Any) -> str:
    """Write a value of a study, a whole number without its decimals."""
    text = value if isinstance(value, str) else json.dumps(value, default=str, ensure_ascii=False)
    return re.sub(r"^(-?\d+)\.0(?= |$)", r"\1", text)


def _names(runs: Sequence[RunData]) -> list[str]:
    """Name runs by their study, their folder where two are alike, else the path."""
    folders = [run.folder.resolve() for run in runs]
    labels = [run.study.study.name for run in runs]
    short = [f.name[:LETTERS] if HASHED.fullmatch(f.name) else f.name for f in folders]
    for better in (short, [str(run.folder) for run in runs]):
        seen = Counter(labels)
        labels = [new if seen[old] > 1 else old for old, new in zip(labels, better, strict=True)]
    return labels


def unlike(names: Sequence[str], taken: Sequence[str] = (), *, suffix: str = "") -> Iterator[str]:
    """Give names that differ from each other and from those taken. suffix: behind one that is taken."""
    seen = list(taken)
    for label in names:
        name = label if label not in seen else f"{label}{suffix}"
        count = 2
        while name in seen:
            name, count = f"{label} ({count})", count + 1
        seen.append(name)
        yield name


def names_by_sentence(sentences: Iterable[tuple[RunData, str]]) -> dict[str, list[str]]:
    """Map each sentence to the names of the runs that it is said of."""
    names: dict[str, list[str]] = {}
    for run, sentence in sentences:
        names.setdefault(sentence, []).append(run.name)
    return names


def listed(names: Sequence[str], number: int) -> str:
    """List names of runs for a note; many of them by their number alone. number: of all runs."""
    if len(names) <= MOST_NAMES:
        return ", ".join(names)
    return f"all {number} runs" if len(names) == number else f"{len(names)} of the {number} runs"
