"""Features that have columns of the history stand side by side, each in its own, on every host of a track."""

import numpy as np
import pytest
from cases_features import STEPS, Debris, attach, needs_transforms, rows_of
from cases_track import small
from numpy.testing import assert_array_equal

from warpwear.engine.executor import Executor
from warpwear.models.features.feature import Feature
from warpwear.models.features.features import Features


class Weightless(Debris):
    of_step = 0.0


@pytest.mark.parametrize("law", ["local", "half-space"])
def test_a_feature_beside_another_one(law: str, monkeypatch: pytest.MonkeyPatch, device: str) -> None:
    """It is added in one place; both hosts give it columns, and other features theirs."""
    needs_transforms(small("full").replace({"contact.law": law}), device)
    alone = rows_of(law, device)
    made = attach(monkeypatch, Weightless)
    beside = rows_of(law, device)
    assert len(alone) == STEPS
    assert alone[-1]["pieces_disc"] > 0.0
    assert beside == alone
    ends = np.cumsum([0.5] * STEPS).tolist()
    assert made[-1].entered == [(end, -end) for end in ends]


def test_two_of_one_name_are_refused() -> None:
    class Other(Debris):
        columns = ("area", "debris")

        def __init__(self) -> None: ...

    third = type("Third", (Other,), {"columns": ("debris",)})()
    with pytest.raises(ValueError, match=r"^columns of the history that two would write: debris$"):
        Features({"other": Other(), "third": third}, own=("distance",))


def test_two_that_set_one_property_are_refused(device: str) -> None:
    class Hard(Feature):
        def __init__(self, executor: Executor) -> None:
            self.properties = {"cap_ratio": executor.zeros()}

    with Executor(small("full").cells, device=device) as executor:
        one = Features({"one": Hard(executor)})
        assert_array_equal(one.cells.cap_ratio.numpy(), 0.0)
        with pytest.raises(ValueError, match=r"^properties of cells that two would set: cap_ratio$"):
            Features({"one": Hard(executor), "other": Hard(executor)})
