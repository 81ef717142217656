"""Names say what they hold, and docstrings are sentences."""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parent.parent
PRODUCT = ("warpwear", "kernels", "surfaces")
#: Names that say nothing of what they hold, alone.
WORN_OUT_NAMES = {"found", "made", "told", "asked", "kept", "given", "shown"}
#: Most variables, parameters and attributes with such a name, docstrings without a verb, and docstrings with
#: a stray quote, that there may be. These numbers may only fall.
WORN_OUT = 8
WITHOUT_VERB = 0
STRAY_QUOTES = 0
#: Verbs that make a sentence wherever they stand in it, and those that are nouns as well and make one at its
#: beginning, both in their plain form; add what is missing.
VERBS = """
    accept add agree aim allow annotate append apply arrive ask bear become begin belong bend bring
    build bulge calibrate call cancel carry certify change check choose claim clear clip close collect
    combine come compare compile complete compress compute contain continue convert convolve cover
    create decide declare delete depend describe die differ displace dissipate divide do download draw drop
    ensure enter estimate evaluate examine exceed exclude exist expect explain extend fail fall feel
    fetch find flatten fold follow foresee forget format free freeze gather generate get give go grow
    guard handle hang happen hatch hide hold imply include infer insert integrate interpolate interrupt
    invert iterate join judge keep kill know lack launch lead learn leave lend let lie limit listen live
    locate lock look lose lower make matter mean meet merge mislead miss mix move multiply need
    normalise notify offer open own pack paint parse pass pay pick play plot poll pop predict prepare
    prescribe prevent print produce project prolong propagate propose prove provide pull push put quote
    raise reach read rebuild recede recognise recover reduce refine refuse register release remain
    remove render renew reorder repair repeat replace replay reset resolve restore restrict resume
    return reuse reverse rotate run save say scan scatter seal see seem select send serve set settle
    share shear shed show shrink simulate sit sketch skip slide solve sort speak spread squeeze stamp
    stand stay stop store stretch strike strip subtract suggest support survive swap switch tabulate tag
    take tell think throw tie tile toggle touch trace transform travel trim try turn undo unpack update
    use vary verify violate wait walk warm warn watch wear weigh widen wrap write yield zero
"""
NOUNS_TOO = """
    answer balance book bound break capture copy count cut default end export fill fit flag force hand
    import label lay link list load map mark match measure name note order place plan press rank record
    report rest rise round sample scale search shape shift smooth split spring stack start step stress
    sum talk test time type view work
"""
#: Forms that are no plain verb with an s.
FORMS = """
    are be been bore came can cannot could did does found gave had has have held is kept knew lay left
    made may met must said stood told took wanted was went were will would
"""
Documented = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef


@cache
def trees() -> dict[str, ast.Module]:
    """Return what every file of the product and of its measurements says, by its path in the checkout."""
    return {
        path.relative_to(ROOT).as_posix(): ast.parse(path.read_text(encoding="utf-8"))
        for top in (*PRODUCT, "bench")
        for path in sorted((ROOT / top).rglob("*.py"))
    }


def is_caption(node: Documented) -> bool:
    """Tell whether a docstring is printed below a figure, whose caption names what is seen without a verb."""
    decorators = getattr(node, "decorator_list", [])
    return any(ast.unparse(decorator).startswith("words.figure(") for decorator in decorators)


def docstrings(*, bench: bool = False) -> Iterator[tuple[str, str]]:
    """Yield the place and the text of every docstring of the product, and of bench where asked for."""
    for name, tree in trees().items():
        for node in ast.walk(tree) if bench or name.startswith(PRODUCT) else ():
            if isinstance(node, Documented) and not is_caption(node) and (text := ast.get_docstring(node)):
                yield f"{name}: {text.partition(chr(10))[0]}", text


def bound_in(tree: ast.AST) -> Iterator[tuple[str, int]]:
    """Yield the names that a file binds, with their lines: variables, parameters and attributes."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id, node.lineno
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            yield node.attr, node.lineno
        elif isinstance(node, ast.arg):
            yield node.arg, node.lineno


def with_third_person(verbs: str) -> set[str]:
    """Return verbs in their plain form and in that of he, she and it."""
    plain = re.findall(r"\w+", verbs)
    ends = [re.sub(r"(?<=[^aeiou])y$", "ie", re.sub(r"(s|sh|ch|x|o)$", r"\1e", verb)) for verb in plain]
    return {*plain, *(f"{end}s" for end in ends)}


@cache
def anywhere() -> set[str]:
    return with_third_person(VERBS) | {*re.findall(r"\w+", FORMS)}


@cache
def beginnings() -> set[str]:
    return anywhere() | with_third_person(NOUNS_TOO)


def has_verb(text: str) -> bool:
    """Tell whether the first paragraph of a docstring has a verb: "Sum up", but not "Sum of"."""
    first, *others = re.findall(r"[A-Za-z]+", text.partition("\n\n")[0]) or [""]
    noun = re.match(r"\w+( (of|at|in|between|over|for|on|and|that|which)\b|[,.:;])", text)
    starts = first.lower() in (with_third_person(VERBS) if noun else beginnings())
    return starts or not anywhere().isdisjoint(others)


def test_names_say_what_they_hold() -> None:
    places = [
        f"{file}:{line} {name}"
        for file, tree in trees().items()
        for name, line in bound_in(tree)
        if name in WORN_OUT_NAMES and file.startswith(PRODUCT)
    ]
    assert len(places) <= WORN_OUT, f"{len(places)}, name the thing itself:\n" + "\n".join(places)


def test_docstrings_are_sentences() -> None:
    places = [place for place, text in docstrings() if not has_verb(text)]
    assert len(places) <= WITHOUT_VERB, f"{len(places)} without a verb:\n" + "\n".join(places)


def test_docstrings_can_be_read_alone() -> None:
    places = [
        place
        for place, text in docstrings(bench=True)
        if text.startswith(("Of ", "The same", "That ", "As "))
    ]
    assert not places, "docstrings that need another one:\n" + "\n".join(places)


def test_docstrings_have_no_stray_quotes() -> None:
    """Of strings that were one once: odd numbers of quotes, or two around the end of a line."""
    places = [
        place
        for place, text in docstrings(bench=True)
        if text.count('"') % 2 or re.search(r'"\s*\n\s*"', text)
    ]
    assert len(places) <= STRAY_QUOTES, "docstrings with a stray quote:\n" + "\n".join(places)


def test_the_changelog_is_short() -> None:
    """A line an entry, under what it is: added, changed or fixed."""
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert not [line for line in text.splitlines() if len(line) > 120 or line.startswith("  ")]
    assert set(re.findall(r"^### (.*)$", text, re.MULTILINE)) <= {"Added", "Changed", "Fixed", "Removed"}
