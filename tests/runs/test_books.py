"""Steps that the device makes in a row are entered into the history at once, as each by itself would be."""

from typing import Any

import pytest
from numpy.testing import assert_array_equal

import warpwear
from warpwear import Study
from warpwear.history.rows import Rows
from warpwear.runs.invariants import Invariants
from warpwear.runs.loop import StepLoop

FEW = {"grid.cell": "50 um", "sliding.distance": "240 mm"}
STUDIES: dict[str, tuple[str, dict[str, Any]]] = {
    "stops": ("v1", FEW | {"output.snapshots": ["0.3 mm", "30 mm"]}),
    "from the first step on": ("v1", FEW | {"output.snapshots": ["120 mm"]}),
    "no speed": ("v1", FEW | {"sliding.speed": None}),
    "at the edge": ("v1", FEW | {"grid.extent": "0.6 mm", "checks.strict": False}),
    "implicit": ("v3-fine", {"grid.cell": "20 um", "sliding.distance": "30 mm"}),
}


def ran(case: str) -> Any:
    preset, changes = STUDIES[case]
    return warpwear.run(Study.load(preset).replace(changes), threads=1)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("case", STUDIES)
def test_steps_entered_at_once_are_those_entered_alone(case: str, monkeypatch: pytest.MonkeyPatch) -> None:
    looked: list[Any] = []
    of_row = Invariants.of_row
    monkeypatch.setattr(
        Invariants, "of_row", lambda *given, **more: looked.append(given) or of_row(*given, **more)
    )
    at_once, of_blocks = ran(case), len(looked)
    monkeypatch.setattr(StepLoop, "_entered", lambda *_: False)
    alone = ran(case)
    count = len(alone.history["distance"])
    assert len(looked) - of_blocks == count
    assert of_blocks <= (count if case == "at the edge" else 8)
    assert at_once.history.keys() == alone.history.keys()
    for name, values in alone.history.items():
        assert_array_equal(at_once.history[name], values, err_msg=name)
    assert at_once.summary["warnings"] == alone.summary["warnings"]
    assert ("reached the domain" in " ".join(alone.summary["warnings"])) == (case == "at the edge")


def test_rows_are_the_same_one_by_one_and_together() -> None:
    columns = {"a": [1.0, 2.0, 3.0], "b": [4.0, 5.0, 6.0]}
    one, other = Rows(), Rows()
    for a, b in zip(*columns.values(), strict=True):
        one.append({"a": a, "b": b})
    other.extend({name: values[:2] for name, values in columns.items()})
    other.append({"b": 6.0, "a": 3.0})
    assert one.names == other.names
    assert_array_equal(one.table, other.table)
    assert_array_equal(other.column("b"), columns["b"])
    assert one.last == other.last == {"a": 3.0, "b": 6.0}
