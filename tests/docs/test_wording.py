"""Sentences of the pages that readers had to read twice stay as they were mended."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
#: Page -> what it says, and what it said.
SENTENCES = [
    (
        "docs/theory/half-space.md",
        "The preconditioner acts on the whole surface, but only free cells may move",
        "To serve",
    ),
    ("docs/theory/track.md", "the dent is the whole overlap of such a cell", "it is all by which"),
    (
        "docs/theory/wear-and-friction.md",
        "a step's wear does not soften the contact",
        "lends the contact no compl",
    ),
    ("docs/theory/wear-and-friction.md", "Quote the last line, the net section", "Of its lines of sections"),
    ("docs/theory/wear-and-friction.md", "allowing for correlated neighbours", "go together counted as such"),
    ("docs/theory/limits.md", "60 % of the load is at first on the wrong patches", "lie at first to 60 %"),
    ("docs/how-to/inference.md", "Their residuals are correlated over a distance", "residuals go together"),
    ("docs/how-to/inference.md", "changes in steps of whole cells; the inference smooths it", "ring by ring"),
    ("docs/how-to/sweeps.md", "only steady rises or falls", "falls throughout"),
    ("docs/how-to/sweeps.md", "a warning names the folder", "is told with its folder"),
    ("docs/validation/ball-on-plate.md", "After any sliding distance", "After any way"),
    ("docs/validation/ball-on-plate.md", "but not where along a section", "It says nothing of where"),
    ("docs/how-to/before-and-after.md", "single ones that lie apart do not", "that have worn alone"),
    (
        "warpwear/templates/texts/trust.txt",
        "The contact covers {{",
        "How much the mesh",
    ),
    ("docs/theory/running-in.md", "f the loaded share of the track, about 0.2 (not φ∞)", "S w φ∞ t"),
    ("docs/theory/running-in.md", "4.3 % at 900 and 5.8 % at 2400 mm", "2.7 % off at most"),
    ("docs/theory/running-in.md", "one-cell steps | .524 | .603 | .608", "one seed | .494"),
    (
        "warpwear/sweeps/indices.py",
        "would be left if all others were known",
        "the part that goes when it alone",
    ),
    (
        "docs/theory/models.md",
        "How does friction rise as a film wears through",
        "why friction rises and levels off",
    ),
    ("docs/theory/track.md", "**Which shift is enough?**", "One core a contact"),
    ("docs/theory/track.md", "**From 2.4 m to 1 km.**", "One core a contact"),
    ("docs/theory/track.md", "from 2.3 ms (preset, 10 µm cells) to 42 ms", "One core a contact"),
    (
        "docs/theory/wear-and-friction.md",
        "Calibrate on the arrangement that you predict",
        "property of metals",
    ),
    ("docs/how-to/inference.md", "Three tests are", "Enter three"),
    ("docs/theory/models.md", "2.3 ms a contact at 10 µm cells, up to [42 ms]", "3.4 ms"),
    ("docs/theory/running-in.md", "Rq of *profiles along sliding* is about t/4", "Sq is about t/4"),
    ("docs/reference/keys.md", "4 times Rq of the worn counter-body along sliding", "4 times Sq"),
    ("docs/theory/running-in.md", "In runs ℓ hardly depends on t", "ℓ grows with t"),
    ("docs/theory/running-in.md", "85 mm over 300, 88 over 900 and 110 over 2400 mm", "ℓ is 92 mm"),
    ("docs/how-to/your-disc.md", "more than 5 % of the load rests on filled points", "load on lost points"),
]


@pytest.mark.parametrize(("page", "mended", "before"), SENTENCES)
def test_a_sentence_that_was_mended_stays_so(page: str, mended: str, before: str) -> None:
    text = " ".join((ROOT / page).read_text(encoding="utf-8").split())
    assert mended in text
    assert before not in text


def test_figures_of_results_are_the_last_value_of_their_cells() -> None:
    """A semicolon hides a figure that pyplot does not know: two tutorials lacked three of them."""
    for path in (ROOT / "docs").rglob("*.md"):
        assert not re.search(r"^result\.plot\..*;\s*$", path.read_text(encoding="utf-8"), re.M), path


def test_outputs_wrap_in_their_boxes() -> None:
    """Long lines of the first output of Start were cut at the box."""
    rule = re.search(r"div\.cell_output pre \{ font-size[^}]*\}", (ROOT / "docs/static/site.css").read_text())
    assert rule is not None
    assert "white-space: pre-wrap" in rule[0]
