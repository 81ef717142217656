"""Which runs are compared, how they are called, and which of them are drawn as one line with a band."""

import json
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain, count, pairwise
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from warpwear.ensembles.ensemble import EnsembleRow, Group
from warpwear.ensembles.table import read_csv
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.history.end_values import ENDS, Summary
from warpwear.history.quantities import printed
from warpwear.laws.archard import BODIES
from warpwear.result import Result
from warpwear.results.ensemble import is_label, label_of, short_names, that_matter
from warpwear.results.file import FILE_NAME
from warpwear.results.track import course, groove, whole_steps
from warpwear.study.keys import dotted
from warpwear.study.study import Study
from warpwear.study.text import readable

#: Length along sliding over which profiles are averaged, as a part of the scar's.
STRIP = 0.125
#: Table and folder of runs of a sweep.
TABLE, RUNS = "table.csv", "runs"
#: Names of folders that a sweep gives.
HASHED = re.compile(r"[0-9a-f]{64}")
#: Letters of such a name that tell runs apart.
LETTERS = 8
#: Keys that a name says at most; runs that differ in more are called by study and folder.
MOST_KEYS = 4
#: Letters of a value that stand in a cell.
LONGEST = 60
#: Names that a note lists at most.
MOST_NAMES = 6


@dataclass(frozen=True, eq=False)
class RunData(EnsembleRow):
    """Hold what is compared of a run; its file is closed.

    Its courses are those of steps, of a swept run without those that are cut short, see `whole_steps`; "cof",
    where it is known: of a swept run the means of whole passes, if it made several; and with a snapshot
    "profile_BODY": the change of height at the end [µm] over places across sliding [mm].
    """

    study: Study
    folder: Path
    summary: Summary


def read_run(folder: Path) -> RunData:
    """Read what is compared of a run. Raises InputError."""
    with Result.open(folder) as result:
        study, summary = result.study, Summary.of(result.summary)
        history, whole = result.history, whole_steps(result)
        courses = {name: (history["distance"][whole], values[whole]) for name, values in history.items()}
        passes = course(result, "cof")
        if not np.isfinite(courses["cof"][1]).all():
            del courses["cof"]
        elif passes[1].size >= min(courses["cof"][1].size, 2):
            courses["cof"] = passes
        if result.snapshot_distances.size and not study.samples_area:
            along = summary.patch_along
            courses |= {f"profile_{body}": (result.y, -1e3 * _worn(result, body, along)) for body in BODIES}
        ends = {name: getattr(summary, name) for name in ENDS}
        return RunData(study.study.name, ends, courses, study, folder, summary)


def _worn(result: Result, body: str, along: float) -> FloatArray:
    """Return the mean depth [mm], shape (ny,), that a body has lost at the end in the middle of the scar.

    along: length of the scar [mm]. That of a track is the mean of its groove: its middle was in contact at
    times only.
    """
    if body == "disc" and result.study.is_swept:
        return groove(result, len(result.snapshots) - 1).worn
    depth: FloatArray = getattr(result.snapshot(-1), f"wear_{body}")
    half = 0.5 * STRIP * along / result.study.grid.cell
    rows = np.abs(np.arange(depth.shape[0]) - 0.5 * (depth.shape[0] - 1)) <= max(half, 0.5)
    return np.asarray(depth[rows].mean(axis=0))


def is_sweep(folder: Path) -> bool:
    """Tell whether a folder is that of a sweep."""
    return (folder / RUNS).is_dir() and not (folder / FILE_NAME).is_file()


def folders_of(folders: Sequence[Path]) -> tuple[list[Path], list[str]]:
    """Put its finished runs where the folder of a sweep stands, in its table's order; also return notes.

    Raises InputError for a sweep that has not come to its end, or of which no run has.
    """
    run_folders: list[Path] = []
    notes: list[str] = []
    for folder in folders:
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
        rows = [(row.get("run", ""), row.get("status")) for row in read_csv(folder / TABLE)]
        done = dict.fromkeys(run for run, status in rows if status == "done" and HASHED.fullmatch(run))
        if not done:
            raise InputError(f"{folder} is a sweep of which no run has finished: there is nothing to compare")
        if failed := sum(status != "done" for _, status in rows):
            notes.append(f"{failed} of the {len(rows)} runs of {folder} failed and are left out.")
        run_folders += [folder / RUNS / run for run in done]
    return run_folders, notes


def grouped(runs: Sequence[RunData], band_over: Sequence[str]) -> list[Group[RunData]]:
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
    """Map each dotted key in which runs differ to its value in each of them, "–" where nothing uses it."""
    flat = [dotted(that_matter(run.study)) for run in runs]
    keys = dict.fromkeys(key for values in flat for key in values)
    unset = [dict.fromkeys(run.study.unused_keys, "–") for run in runs]
    every = list(zip(flat, unset, strict=True))
    texts = {key: [_written(own.get(key, unused.get(key, "none"))) for own, unused in every] for key in keys}
    differ = {key: values for key, values in texts.items() if len(set(values)) > 1}
    return dict(sorted(differ.items(), key=lambda item: is_label(item[0])))  # seeds are said last


def differences(groups: Sequence[Group[RunData]]) -> dict[str, list[list[str]]]:
    """Map each dotted key in which runs differ to the values in each group, as people write them."""
    starts = np.cumsum([0, *(len(group.rows) for group in groups)])
    every = differing([run for group in groups for run in group.rows])
    return {
        key: [list(dict.fromkeys(map(_readable, values[a:b]))) for a, b in pairwise(starts)]
        for key, values in every.items()
    }


def _readable(value: str) -> str:
    """Write a value of a study as people do, a list of them without its brackets, and not too long."""
    parts = [str(readable(part)).strip() for part in re.sub(r'[\[\]"]', "", value).split(", ")]
    parts = [re.sub(r"(?<=\d )\S+$", lambda unit: printed(unit[0]), part) for part in parts]
    text = ", ".join(re.sub(r"\.0(?= |$)", "", part) for part in parts)
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…"


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
        others = (f"{label} ({number})" for number in count(2))
        seen.append(next(name for name in chain((label, f"{label}{suffix}"), others) if name not in seen))
        yield seen[-1]


def told(sentences: Iterable[tuple[RunData, str]], number: int, *, of_all: bool = True) -> Iterator[str]:
    """Say each sentence once, with the names of the runs that it is said of.

    number: of all runs. of_all: whether their names stand before what is said of all of them.
    """
    names: dict[str, list[str]] = {}
    for run, sentence in sentences:
        names.setdefault(sentence, []).append(run.name)
    for sentence, who in names.items():
        yield sentence if len(who) == number and not of_all else f"{listed(who, number)}: {sentence}"


def listed(names: Sequence[str], number: int) -> str:
    """List names of runs for a note; many of them by their number alone. number: of all runs."""
    if len(names) <= MOST_NAMES:
        return ", ".join(names)
    return f"all {number} runs" if len(names) == number else f"{len(names)} of the {number} runs"
