"""Attachments that have columns of the history stand side by side, each in its own."""

from typing import Any

import numpy as np
import pytest
from cases_attached import Debris
from cases_track import rough, small

from warpwear.engine.executor import Executor
from warpwear.models.attachment import give_columns
from warpwear.models.track import local

PIECES = {"wear.particle": "60 um", "wear.particle_thickness": "0.6 um", "stepping.scheme": "explicit"}


def rows_of(device: str, made: list[Debris] | None, monkeypatch: pytest.MonkeyPatch) -> list[dict[str, Any]]:
    """Steps of wear in pieces, with debris after them where it is to be made."""
    study = small("full", stepping__force=True).replace(PIECES)
    options: dict[str, Any] = {}
    with Executor(study.cells, device=device) as executor, monkeypatch.context() as patch:
        if made is not None:

            def recession(curve: Any, executor: Executor, bodies: Any) -> Debris:
                made.append(Debris(executor, bodies.disc.shape[0]))
                made[0].of_step = 0.0
                return made[0]

            patch.setattr(local, "Recession", recession)
            options["bearing_curve"] = object()
        disc = rough(study.track.rows)
        contact = local.SlidingContact(study.contact_task, disc, executor, **options)
        shifts = [study.track.row(step) for step in range(20)]
        count, steps = contact.replay(shifts, [0.5] * 20)
        rows = [step.row for step in steps]
        assert len(rows) == count == 20
        return rows


def test_two_attachments_with_columns(monkeypatch: pytest.MonkeyPatch, device: str) -> None:
    made: list[Debris] = []
    alone, beside = (rows_of(device, these, monkeypatch) for these in (None, made))
    assert alone[-1]["pieces_disc"] > 0.0
    assert beside == alone
    ends = np.cumsum([0.5] * 20).tolist()
    assert made[0].entered == [(end, -end) for end in ends]


def test_two_of_one_name_are_refused() -> None:
    class Other(Debris):
        columns = ("area", "debris")

        def __init__(self) -> None: ...

    with pytest.raises(ValueError, match=r"^columns of the history that two would write: debris$"):
        give_columns([Other(), type("Third", (Other,), {"columns": ("debris",)})()], ("distance",))
