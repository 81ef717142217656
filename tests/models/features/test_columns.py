"""Features that have columns of the history stand side by side, each in its own, on every host of a track."""

from typing import Any

import numpy as np
import pytest
from cases_features import Debris, attach, needs_transforms
from cases_track import rough, small
from numpy.testing import assert_array_equal

from warpwear.engine.executor import Executor
from warpwear.models.features.feature import Feature
from warpwear.models.features.features import Features
from warpwear.models.track.half_space import SlidingHalfSpace
from warpwear.models.track.local import SlidingContact

PARTICLES = {"wear.particle": "60 um", "wear.particle_thickness": "0.6 um"}
STEPS = 20


class Weightless(Debris):
    of_step = 0.0


def rows_of(law: str, device: str) -> list[dict[str, Any]]:
    """Steps of wear in particles."""
    scheme = {"stepping.scheme": "explicit" if law == "local" else "implicit"}
    study = small("full", stepping__force=True).replace(PARTICLES | scheme | {"contact.law": law})
    shifts, increments = [study.track.row(step) for step in range(STEPS)], [0.5] * STEPS
    with Executor(study.cells, device=device) as executor:
        task, disc = study.contact_task, rough(study.track.rows)
        if law == "local":
            return [step.row for step in SlidingContact(task, disc, executor).replay(shifts, increments)[1]]
        contact = SlidingHalfSpace(task, disc, executor)
        return [contact.step(*move).row for move in zip(shifts, increments, strict=True)]


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
