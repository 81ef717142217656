"""Runs of one study side by side: bands over those that differ in a seed, and how groups are called."""

import hashlib
import json
import tomllib
from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np

from warpwear.grid import FloatArray
from warpwear.laws.archard import BODIES
from warpwear.results.file import ResultFile
from warpwear.study.loading import insert
from warpwear.study.study import Study

#: Percentiles between which a band lies, and how they are found: rank p (n + 1) of n runs (Weibull), so that
#: another run lies between them with that chance. By the usual p (n − 1) it is 84 % and not 90 of 32 runs.
BAND = (5.0, 95.0)
RANK: Final = "weibull"
#: Runs from which on the ends of a band lie between runs.
WHOLE = 19
#: Sections and keys of a study that no number of its result depends on; None is the whole section.
NO_MATTER: dict[str, tuple[str, ...] | None] = {
    "study": ("name", "description", "author", "publisher", "license"),
    "run": None,
    "assumed": None,
}
#: Number of what a stored run holds; it rises when the same study gives other numbers.
RESULT_FORMAT = 1
#: Letters of a label that a figure's legend shows.
LONGEST = 60


def that_matter(study: Study) -> dict[str, Any]:
    """Return the sections of a resolved study, without what no number of its result depends on."""
    sections = tomllib.loads(study.to_toml())
    for section, keys in NO_MATTER.items():
        for key in keys or [*sections.get(section, ())]:
            sections.get(section, {}).pop(key, None)
    return sections


def name_of(study: Study, *, device: str, files: Mapping[str, str]) -> str:
    """SHA-256 of all that decides the numbers of a run, as hexadecimal text.

    That is the resolved study without its names, what its files hold (not where they lie), the kind of device
    and `RESULT_FORMAT`. files: digests of these, by the keys that name them.
    """
    sections = that_matter(study)
    for key, digest in files.items():
        insert(sections, key, digest)
    about = {"study": sections, "device": device.partition(":")[0], "format": RESULT_FORMAT}
    return hashlib.sha256(json.dumps(about, sort_keys=True).encode()).hexdigest()


def digests_in(result: ResultFile) -> dict[str, str]:
    """Map keys of a result's study to the SHA-256 of what their files held, as far as it carries that."""
    known = result.record.get("files", {})
    return {key: known[key] for key in result.study.files if isinstance(known.get(key), str)}


def short_names(keys: Sequence[str]) -> dict[str, str]:
    """Map each dotted key to its last part, as far as that says which of the keys it is."""
    ends = [key.rpartition(".")[2] for key in keys]
    plain = {end for end in ends if ends.count(end) == 1 and end not in BODIES}
    return {key: end if end in plain else key for key, end in zip(keys, ends, strict=True)}


def label_of(values: Mapping[str, Any], names: Mapping[str, str]) -> str:
    """Say what sets a group apart, 'load 4 N, hardness 590 MPa'. values, names: by dotted key."""
    return ", ".join(f"{name} {values[key]}" for key, name in names.items())


def in_legend(label: str) -> str:
    """Shorten a label, which may be the name of any file, for a legend."""
    return label if len(label) <= LONGEST else f"{label[: LONGEST - 1]}…"


def is_label(key: str) -> bool:
    """Tell whether the numbers of a key only tell one case from another, as seeds do."""
    return key.rpartition(".")[2] == "seed"


def at(places: FloatArray, distance: FloatArray, values: FloatArray) -> FloatArray:
    """Interpolate between known values by straight lines; NaN beyond the ends but for round-off."""
    if distance.size == places.size and np.array_equal(distance, places):
        return values
    room = 1e-9 * float(np.abs(distance[[0, -1]]).max())
    beyond = (places < distance[0] - room) | (places > distance[-1] + room)
    return np.where(beyond, np.nan, np.interp(places, distance, values))


def band(values: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return mean, 5th and 95th percentile, (places,) each, of courses (runs, places); NaN of none known."""
    numbers = np.isfinite(values).sum(axis=0)
    courses = np.full((3, values.shape[1]), np.nan)
    # Of places that all runs reach at once; nanpercentile goes place by place.
    for those, percentile in ((numbers == len(values), np.percentile), (numbers > 0, np.nanpercentile)):
        missing = those & np.isnan(courses[0])
        if missing.any():
            some = values[:, missing]
            courses[0, missing] = np.clip(
                np.nanmean(some, axis=0), np.nanmin(some, axis=0), np.nanmax(some, axis=0)
            )
            courses[1:, missing] = percentile(values[:, missing], BAND, axis=0, method=RANK)
    return courses[0], courses[1], courses[2]


def band_name(count: int) -> str:
    """Say what a band of so many runs holds: below 19 its ends are the least and the most of them."""
    return "5 to 95 %" if count >= WHOLE else "least to most"


def band_told(numbers: Sequence[int]) -> str:
    """Say for a title what lines and bands show. numbers: of runs in each group."""
    most, fewest = max(numbers, default=1), min(numbers, default=1)
    if most == 1:
        return ""
    names = dict.fromkeys((band_name(fewest), band_name(most)))
    return f"mean and {' or '.join(names)} of {most if most == fewest else f'{fewest} to {most}'} runs"
