"""What lies on the disc stays with it: arrays declare their frame, by which a programme's circles go."""

import numpy as np
import pytest
from cases_features import attach
from cases_track import WINDOW, small

import warpwear


def test_an_array_of_any_part_follows_its_circle(monkeypatch: pytest.MonkeyPatch, device: str) -> None:
    """It is declared to lie on the disc, and named nowhere else."""
    made = attach(monkeypatch)
    turns = [(0.161, 2), (0.9, 1), (0.161, 1)]
    block = [{"track_radius": f"{radius} mm", "revolutions": count} for radius, count in turns]
    study = small("rotating").replace({"checks.strict": False}, block=block)  # no field says where it lies
    history = warpwear.run(study, device=device).history
    steps = [np.count_nonzero(history["block"] == number) for number in (1.0, 2.0, 3.0)]
    lain = [round(one.depth.numpy()[:, :, 0].sum() / one.of_step) for one in made]
    vectors = WINDOW * -(-WINDOW // 8)
    assert lain == [vectors * count for count in (steps[0], steps[1], steps[0] + steps[2])]
