"""Show the arguments that a docstring explains one to a line, and types by the names that people know."""

import inspect
import re
from typing import Any

#: What autodoc writes of numpy.typing.ArrayLike and of arrays -> what stands on the page.
TYPES = (
    (r"\S*_Buffer \| .*?_NestedSequence\[complex \| bytes \| str\]", "ArrayLike"),
    (r"(\w+\.|~)*ndarray\[tuple\[(\w+\.|~)*Any, \.\.\.\], (\w+\.|~)*dtype\[(\w+\.|~)*\w+\]\]", "ndarray"),
)


def listed(paragraph: str, names: set[str]) -> list[str]:
    """The lines of a paragraph; where it explains names ("a: of this. b, c: of that."), a point for each."""
    text = " ".join(paragraph.split())
    name = "(?:" + "|".join(sorted(map(re.escape, names), key=len, reverse=True)) + ")"
    heads = f"{name}(?:, {name})*: "
    if not names or not re.match(heads, text):
        return paragraph.split("\n")
    points = re.split(rf"(?<=[.;]) (?={heads})", text)
    return [f"- **{point.partition(': ')[0]}**: {point.partition(': ')[2].rstrip(';')}" for point in points]


def _names(thing: Any) -> set[str]:
    found = set(getattr(thing, "__dataclass_fields__", ())) | {
        n for n in vars(thing) if not n.startswith("_")
    }
    if callable(thing):
        found |= set(inspect.signature(thing).parameters)
    return found


def _docstring(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    if what not in ("function", "class", "method"):
        return
    names = _names(thing)
    paragraphs = re.split(r"\n[ ]*\n", "\n".join(lines))
    made: list[str] = []
    for paragraph in paragraphs:
        plain = not paragraph.startswith((" ", ">>>"))
        made += [*(listed(paragraph, names) if plain else paragraph.split("\n")), ""]
    lines[:] = made


def _signature(app: Any, what: str, name: str, thing: Any, options: Any, given: str, returned: str) -> Any:
    def short(text: str | None) -> str | None:
        for pattern, known in TYPES if text else ():
            text = re.sub(pattern, known, text)
        return text

    return short(given), short(returned)


def setup(app: Any) -> dict[str, bool]:
    """Tell Sphinx of both."""
    app.connect("autodoc-process-docstring", _docstring)
    app.connect("autodoc-process-signature", _signature)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
