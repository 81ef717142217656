"""The line for people that describes a study, kept true when keys are changed."""

from collections.abc import Sequence

#: Between a description and the keys changed since it was written.
CHANGED = "; changed: "
#: Most keys that are named; the rest are "others".
NAMED = 4
OTHERS = " and others"


def is_described(key: str) -> bool:
    """Whether a description may speak of it: not of names, of what is checked, and of what is written."""
    section = key.partition(".")[0]
    return key == "study.model" or section not in ("study", "checks", "output", "assumed")


def with_changes(description: str, changed: Sequence[str]) -> str:
    """A description followed by the keys changed since, each once, also where it already names some."""
    text, _, told = description.partition(CHANGED)
    more = told.endswith(OTHERS)
    known = [name for name in told.removesuffix(OTHERS).split(", ") if name]
    names = list(dict.fromkeys([*known, *changed]))
    if not names:
        return description
    listed = ", ".join(names[:NAMED])
    return f"{text}{CHANGED}{listed}{OTHERS if more or len(names) > NAMED else ''}"
