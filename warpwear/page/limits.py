"""What the model of a run cannot show: the sentences of docs/theory/limits.md that apply to it.

The sentences stand in templates/sentences/limits.toml; their conditions, and those of effects.toml, in
conditions.toml beside them.
"""

import math
from typing import Any

from warpwear.errors import prose
from warpwear.results.formats.forms import holds
from warpwear.study.study import Study

#: Names of conditions, with commas between them -> the sentences that apply where all hold.
LIMITS: dict[str, list[str]] = prose("limits")
CONDITIONS: dict[str, str] = prose("conditions")


def limits_of(study: Study) -> list[str]:
    """List the sentences that apply to the runs of a study."""
    return [
        sentence
        for names, sentences in LIMITS.items()
        if all(applies(name, study) for name in names.split(", "))
        for sentence in sentences
    ]


def applies(name: str, study: Study, **numbers: Any) -> bool:
    """Tell whether a condition, by its name, or not that one, holds of a study, or of numbers of a run."""
    condition = name.removeprefix("not ")
    return holds(CONDITIONS[condition], study=study, infinity=math.inf, **numbers) == (name == condition)
