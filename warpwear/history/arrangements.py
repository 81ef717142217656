"""A run has one of these arrangements of bodies: each has a name, and studies that ask for it.

`warpwear.runs.arrangements` makes their models. Quantities that only runs of one have name it.
"""

from collections.abc import Callable

from warpwear.study.study import Study

#: Name -> what runs of it are called, and whether a study makes one; the first that does is the study's.
ARRANGEMENTS: dict[str, tuple[str, Callable[[Study], bool]]] = {
    "track": ("runs over a track", lambda study: study.is_swept),
    "patches": ("runs with patches", lambda study: study.study.model == "two-scale"),
    "rest": ("runs at rest", lambda study: True),
}


def name_of(study: Study) -> str:
    """Name the arrangement that a study asks for."""
    return next(name for name, (_, serves) in ARRANGEMENTS.items() if serves(study))
