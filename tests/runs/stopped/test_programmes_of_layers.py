"""Programmes whose bodies have layers: each block wears through them by its own load."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_stopped import HALF_SPACE, differences, run_stopped, study_of
from cases_track import small
from numpy.testing import assert_allclose

import warpwear
from warpwear import Study

LAYERS: dict[str, Any] = {
    "disc.layers": [
        {"name": "coat", "thickness": "40 nm", "wear": "4e-4 mm^3/N/m"},
        {"name": "bond", "thickness": "10 nm", "wear": "9e-3 mm^3/N/m"},
    ],
    "counter.layers": [{"name": "skin", "thickness": "30 nm", "wear": "2e-3 mm^3/N/m"}],
}
LOADS = (4.0, 16.0, 6.0)
AT_REST = ("micro, implicit", "half-space", "two-scale", "two-scale, half-space")
TRACKS: dict[str, tuple[str, list[dict[str, Any]]]] = {
    "strokes": ("full", [{"stroke": f"{stroke} mm", "cycles": 1} for stroke in (0.9, 0.5, 1.2)]),
    "circles": (
        "rotating",
        [{"track_radius": f"{radius} mm", "revolutions": 2} for radius in (0.161, 0.9, 0.161)],
    ),
}
CASES = (*AT_REST, *TRACKS, *(f"{track}, half-space" for track in TRACKS))


def programme(case: str) -> Study:
    """Blocks of other loads, and on tracks of other strokes or circles of the disc."""
    if case in AT_REST:
        study, blocks = study_of(case, 1e9), [{"distance": "0.0625 mm"}] * 3
    else:
        track, _, law = case.partition(", ")
        name, blocks = TRACKS[track]
        study = small(name).replace(HALF_SPACE if law else {})
    blocks = [block | {"load": f"{load} N"} for block, load in zip(blocks, LOADS, strict=True)]
    return study.replace({"output.snapshots": []} | LAYERS).replace(block=blocks)


@pytest.mark.parametrize("case", [*CASES[:-2], pytest.param(CASES[-2], marks=pytest.mark.slow), CASES[-1]])
def test_blocks_wear_through_layers_by_their_loads(case: str, tmp_path: Path, device: str) -> None:
    """Σ V_m / K_m = Σ F_i L_i after every block, and a run that was stopped goes on bit for bit."""
    study = programme(case)
    one, other = tmp_path / "alone", tmp_path / "stopped"
    with warpwear.run(study, out=one, plots=False, threads=1, device=device) as result:
        history, number, summary = result.history, result.history["block"], result.summary
    for body, profile in zip(("counter", "disc"), study.pair.profiles or (), strict=True):
        volumes = {m.name: history[f"wear_volume_{body}_{m.name}"] for m in profile.materials}
        assert_allclose(sum(volumes.values()), history[f"wear_volume_{body}"], rtol=1e-11)
        for block in study.blocks:
            last = number == block.number
            worn = sum(volumes[m.name][last][-1] / m.wear for m in profile.materials)
            carried = sum(b.load * b.length for b in study.blocks[: block.number])
            assert worn == pytest.approx(carried, rel=1e-12)
        assert np.ptp(history[f"load_share_{body}_substrate"]) > 0.5
        assert abs(summary[f"layers_{body}"]["volumes_over_K_less_FL"]) < 1e-12
    inside = int(np.flatnonzero(number == 2.0)[0]) + 2
    run_stopped(study, other, inside, threads=2, device=device)
    run_stopped(study, other, 3, resume=True, threads=1, device=device)
    warpwear.run(study, out=other, plots=False, resume=True, threads=1, device=device).close()
    assert differences(one, other) == []


@pytest.mark.parametrize("case", AT_REST)
def test_a_flat_on_a_flat_is_worn_to_the_closed_form(case: str, device: str) -> None:
    """Every cell has borne Σ F_i L_i / A, in however many blocks."""
    flat = {"counter.radius": "inf mm", "disc.synthetic": {"kind": "flat"}}
    study = programme(case)
    if study.study.model == "two-scale":
        flat |= {"contact.bulk_stiffness": "1e5 N/mm^3"}
    elif study.contact.law == "half-space":
        flat |= {"contact.boundary": "periodic"}
    result = warpwear.run(study.replace(flat), device=device)
    carried = sum(block.load * block.length for block in study.blocks)
    for body, profile in zip(("counter", "disc"), study.pair.profiles or (), strict=True):
        expected = profile.worn(np.zeros(1), np.array([carried / study.cells.area]))[0]
        depth = result.history[f"wear_depth_{body}"][-1]
        assert depth == pytest.approx(expected, rel=1e-12)
