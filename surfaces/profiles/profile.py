"""A profile is a line of heights: of a stylus, of a file, or of a map."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.surfaces.base import BoolArray
from warpwear.surfaces.levelling import without_polynomial
from warpwear.surfaces.reading import read

FEWEST = 50  # points, below which nothing is said of a profile
MOST_MISSING = 0.2  # of its points


@dataclass(frozen=True, eq=False)
class Profile:
    """A profile has heights at even distances along a line."""

    spacing: float  # [mm]
    heights: FloatArray  # [mm], positive out of the material, shape (n,), NaN where missing
    about: Mapping[str, Any]  # where it is from, JSON-ready

    @property
    def length(self) -> float:
        """Return the length [mm], a spacing for each point."""
        return self.spacing * self.heights.size

    @property
    def places(self) -> FloatArray:
        """Return the places [mm] of the points from the beginning, shape (n,)."""
        return self.spacing * np.arange(0.5, self.heights.size)

    @property
    def missing(self) -> BoolArray:
        """Return which points are missing, shape (n,)."""
        return np.isnan(self.heights)

    def levelled(self, degree: int) -> "Profile":
        """Return it less the least-squares polynomial of a degree."""
        return replace(self, heights=without_polynomial(self.heights[None], degree=degree)[0])

    def filled(self) -> FloatArray:
        """Return heights [mm] with straight lines where points are missing, shape (n,)."""
        known = np.flatnonzero(~self.missing)
        return np.interp(np.arange(self.heights.size), known, self.heights[known])


def read_profile(
    path: str | Path,
    *,
    spacing: float | None = None,
    height_unit: str | None = None,
    array: str | None = None,
    down: bool = False,
) -> Profile:
    """Read the profile in a file of any format that `warpwear.surfaces.reading.read` knows.

    spacing [mm] and height_unit override what the file says; array: the one to take of a .npz that holds
    several; down: whether the file gives depths. Raises InputError, naming ``disc.surface``, ``disc.pixel``
    or ``disc.height_unit``, where there is none, where it has fewer than 50 points or where a fifth of them
    is missing.
    """
    content = read(path, pixel=spacing, height_unit=height_unit, array=array, profile=True)
    about = {
        "file": Path(path).name,
        "format": content.format,
        "sha256": content.digest,
        "unit": content.unit,
        "notes": [*content.notes, *content.overrides, *(["heights turned over"] if down else [])],
    }
    return checked(Profile(content.pixel[0], -content.heights if down else content.heights, about))


def checked(profile: Profile) -> Profile:
    """Return a profile that has enough points. Raises InputError."""
    count, share = profile.heights.size, float(profile.missing.mean())
    name = f"disc.surface '{profile.about['file']}'"
    if count < FEWEST:
        raise InputError(f"{name} has a profile of {count} points: at least {FEWEST} are needed")
    if share > MOST_MISSING:
        raise InputError(
            f"{name} has {100.0 * share:.3g} % of its points missing: allowed are {100.0 * MOST_MISSING:g} %"
        )
    return profile
