"""A run has one of these arrangements of bodies: each has a name, and studies that ask for it.

`warpwear.runs.arrangements` makes their models. Quantities that only runs of one have name it.
"""

from collections.abc import Callable
from dataclasses import dataclass

from warpwear.study.study import Study


@dataclass(frozen=True)
class Arrangement:
    """Describes one arrangement of the bodies."""

    called: str  # runs of it, in words
    serves: Callable[[Study], bool]


#: The first that serves a study is the study's.
ARRANGEMENTS = {
    "track": Arrangement("runs over a track", lambda study: study.is_swept),
    "patches": Arrangement("runs with patches", lambda study: study.study.model == "two-scale"),
    "rest": Arrangement("runs at rest", lambda study: True),
}


def name_of(study: Study) -> str:
    """Name the arrangement that a study asks for."""
    return next(name for name, one in ARRANGEMENTS.items() if one.serves(study))
