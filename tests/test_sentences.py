"""Sentences of templates are all said somewhere, and get what they have fields for."""

import ast
import re
from collections import defaultdict
from pathlib import Path

import pytest

from warpwear import Study
from warpwear.errors import prose

ROOT = Path(__file__).parent.parent
#: File of templates -> what says its sentences, and where.
SAID = {
    "refusals": ("refused", ["warpwear/study/**/*.py"]),
    "doubts": ("say", ["warpwear/study/doubts.py", "warpwear/runs/doubts.py"]),
    "measurements": ("(say|refused)", ["surfaces/**/*.py"]),
    "runs": (
        r"(say|self\._refused)",
        [f"warpwear/runs/{n}.py" for n in ("array_surface", "checkpoint", "order")],
    ),
    "violations": ("Violation.of", ["warpwear/runs/invariants.py"]),
}
#: Fields that are given to every violation, and to what is said of checkpoints.
OF_ALL = {"what", "where", "path", "overwrite_it", "resume_it"}


def calls(what: str, globs: list[str]) -> list[ast.Call]:
    """Find the calls of these names with a name of a sentence."""
    trees = [ast.parse(path.read_text(encoding="utf-8")) for glob in globs for path in ROOT.glob(glob)]
    every = [node for tree in trees for node in ast.walk(tree) if isinstance(node, ast.Call)]
    named = [call for call in every if re.fullmatch(what, ast.unparse(call.func))]
    return [call for call in named if call.args and isinstance(call.args[0], ast.Constant)]


@pytest.mark.parametrize("name", SAID)
def test_every_sentence_is_said_and_gets_its_fields(name: str) -> None:
    texts = prose(name)
    said = {ast.literal_eval(call.args[0]): call for call in calls(*SAID[name])}
    assert said.keys() == texts.keys()
    for sentence, call in said.items():
        fields = set(re.findall(r"{(\w+)", str(texts[sentence]).replace("{'", ""))) - OF_ALL
        assert fields == {value.arg for value in call.keywords if value.arg} - OF_ALL, sentence


@pytest.mark.parametrize("name", SAID)
def test_what_fields_ask_of_a_study_is_there_and_has_their_format(name: str) -> None:
    study = Study.load("running-in")
    values = defaultdict(lambda: 1.5, study=study, film=study.friction.film, block=study.blocks[0])
    values |= {key: getattr(study, key) for key in ("grid", "sliding", "friction", "wear")}
    for sentence in prose(name).values():
        texts = [sentence] if isinstance(sentence, str) else sentence.values()
        assert all(text.format_map(values) for text in texts if isinstance(text, str))
