"""Docstrings can be read alone, and the changelog is short; that docstrings are sentences ruff sees to."""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parent.parent
PRODUCT = ("warpwear", "kernels", "surfaces")
Documented = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef


@cache
def trees() -> dict[str, ast.Module]:
    """Return what every file of the product and of its measurements says, by its path in the checkout."""
    return {
        path.relative_to(ROOT).as_posix(): ast.parse(path.read_text(encoding="utf-8"))
        for top in (*PRODUCT, "bench")
        for path in sorted((ROOT / top).rglob("*.py"))
    }


def docstrings() -> Iterator[tuple[str, str]]:
    """Yield the place and the text of every docstring of the product, and of bench."""
    for name, tree in trees().items():
        for node in ast.walk(tree):
            if isinstance(node, Documented) and (text := ast.get_docstring(node)):
                yield f"{name}: {text.partition(chr(10))[0]}", text


def test_docstrings_can_be_read_alone() -> None:
    places = [place for place, text in docstrings() if text.startswith(("Of ", "The same", "That ", "As "))]
    assert not places, "docstrings that need another one:\n" + "\n".join(places)


def test_docstrings_have_no_stray_quotes() -> None:
    """Of strings that were one once: odd numbers of quotes, or two around the end of a line."""
    places = [place for place, text in docstrings() if text.count('"') % 2 or re.search(r'"\s*\n\s*"', text)]
    assert not places, "docstrings with a stray quote:\n" + "\n".join(places)


def test_the_changelog_is_short() -> None:
    """A line an entry, under what it is: added, changed or fixed."""
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert not [line for line in text.splitlines() if len(line) > 120 or line.startswith("  ")]
    assert set(re.findall(r"^### (.*)$", text, re.MULTILINE)) <= {"Added", "Changed", "Fixed", "Removed"}
