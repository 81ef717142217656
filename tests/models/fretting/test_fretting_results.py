"""What people see of a fretting run: figures without faults, the summary, the page, a draft."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_figures import drawn, faults_of
from cases_fretting import BORDER, FRICTION, LOAD, sheared, study_of

import warpwear
from warpwear import Study
from warpwear.calibration.bayes.runs import needs_runs, scales
from warpwear.calibration.energy import calibrate_energy
from warpwear.drafts.draft import draft
from warpwear.figures.of_run.table import FIGURES
from warpwear.laws.fretting import loop, regime_of
from warpwear.page.limits import limits_of
from warpwear.runs.console import Progress
from warpwear.runs.run import RunOptions, run_study

NAMES = {name for name, entry in FIGURES.items() if entry.section == "fretting"}
RUNS: dict[str, dict[str, Any]] = {
    "partial": {"wear__counter": "1e-5 mm^3/N/m", "wear__disc": "2e-5 mm^3/N/m", "over": 3.2},
    "gross": {"sliding__stroke": "8 um", "sliding__stroke_of": "body", "over": 4.0},
}


@pytest.fixture(scope="module", params=RUNS)
def result(request: pytest.FixtureRequest) -> warpwear.Result:
    """A hundred thousand cycles with four snapshots."""
    return warpwear.run(sheared(64, **RUNS[request.param], output__snapshots="auto"))


def test_figures_are_fit_to_print(result: warpwear.Result) -> None:
    seen = NAMES & {*result.plot.names()}
    assert seen >= NAMES - {"slip_map"}  # which gross slip has not
    faults = [fault for name in sorted(seen) for fault in faults_of(name, *drawn(result, name))]
    assert not faults, "\n".join(faults)


def test_the_summary_tells_regime_energy_and_slope(result: warpwear.Result) -> None:
    told, history = result.summary["fretting"], result.history
    sticks = bool(history["stick_area"][-1])
    assert told["regime"] == ("partial" if sticks else "gross")
    assert told["energy_total_J"] == pytest.approx(history["friction_energy"][-1])
    for body, law in zip(("counter", "disc"), result.study.wear_laws, strict=True):
        assert told["alpha_mm3_per_J"][body] == pytest.approx(1e3 * law.steady / FRICTION, rel=1e-9)
    assert told["energy_mJ"] == history["energy"][-1]
    slip = f"{told['regime']} slip; in the last cycle {told['energy_mJ']:.3g} mJ and a mean slip of"
    assert slip in str(result)
    assert "lies still" not in str(result)
    assert told["displacement_border_mm"] == history["displacement_border"][-1]
    assert any("third body" in sentence for sentence in limits_of(result.study))


def test_the_energy_of_a_test_is_that_of_its_loops(tmp_path: Path) -> None:
    """Where much sticks it is far below μ F times the way that the bodies go."""
    with warpwear.run(sheared(32, sliding__cycles=2000), out=tmp_path / "run", plots=False) as result:
        energy, slid = result.history["friction_energy"][-1], result.history["distance"][-1]
    told = calibrate_energy(result=tmp_path / "run").energy
    assert told == energy
    assert told < 0.1e-3 * FRICTION * LOAD * slid


def test_a_line_has_no_loops_of_displacement() -> None:
    study = study_of(
        counter__shape="cylinder",
        contact__load="20 N/mm",
        contact__boundary="line",
        grid__extent=["0.64 mm", "5 um"],
        sliding__cycles=2000,
        sliding__positions="mean",
        output__snapshots="auto",
    )
    result = warpwear.run(study)
    # in gross slip a map of slip would be of one colour, and a row of cells has lines in place of maps
    assert set(result.plot.left_out) & NAMES == {"fretting_loops", "running_conditions", "slip_map"}
    lines = result.plot.pressure_map().axes[0].lines
    assert [str(line.get_label()) for line in lines][-2:] == ["after 2000 cycles", "Hertz, unworn bodies"]
    peak = result.study.hertz.peak_pressure if result.study.hertz else 0.0
    assert np.max(lines[-1].get_ydata()) == pytest.approx(peak)
    assert "contact_map" in result.plot.left_out
    faults = [
        fault for name in NAMES & {*result.plot.names()} for fault in faults_of(name, *drawn(result, name))
    ]
    assert not faults, "\n".join(faults)


@pytest.mark.parametrize(("ratio", "slide"), [(0.3, 0.0), (0.9, 0.0), (1.0, 2.0)])
def test_a_loop_holds_its_tips_and_its_energy(ratio: float, slide: float) -> None:
    """Under a ball it is Mindlin and Deresiewicz's."""
    elastic = BORDER * (1.0 - (1.0 - ratio) ** (2 / 3))
    limit, amplitude = FRICTION * LOAD, elastic + slide * BORDER
    unloading = 2.0 * BORDER * (1.0 - (1.0 - ratio) ** (2 / 3))
    own = 1.0 - 2.0 * (ratio - 0.6 * (1.0 - (1.0 - ratio) ** (5 / 3))) / ratio / (elastic / BORDER)
    energy = (own + slide) / (1.0 + slide)
    force, place = loop(ratio * limit, amplitude, BORDER, energy, limit=limit)
    assert (force.max(), place.max()) == pytest.approx((ratio * limit, amplitude))
    area = abs(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(place)))
    assert area == pytest.approx(energy * 4.0 * ratio * limit * amplitude, rel=1e-3)
    middle = place[50]  # at no force, on the way back
    assert middle == pytest.approx(
        amplitude - 2.0 * BORDER * (1.0 - (1.0 - 0.5 * ratio) ** (2 / 3)), rel=1e-6
    )
    assert unloading > 0.0


def test_regimes_are_named() -> None:
    contact = np.full(3, 1.0)
    for stick, name in (
        ([0.95, 0.95, 0.92], "stick"),
        ([0.95, 0.5, 0.4], "partial"),
        ([0.0, 0.0, 0.2], "mixed"),
        ([0.0, 0.0, 0.0], "gross"),
    ):
        assert regime_of(np.array(stick), contact) == name


def test_a_draft_frets(tmp_path: Path) -> None:
    study = Study.stored(draft("fretting", name="mine", folder=tmp_path))
    assert study.kinematics == "fretting"
    ball = {"counter.shape": "ball", "counter.radius": "5 mm", "contact.load": "20 N"}
    forced = draft("fretting", name="mine", folder=tmp_path, changes=ball | {"sliding.force": "7 N"})
    assert "stroke" not in Study.stored(forced).sliding.model_fields_set


def test_an_inference_knows_that_friction_decides_what_sticks() -> None:
    """Under a force other coefficients need other runs; no course is that of both wears' sum alone."""
    for study, needed in ((sheared(64), True), (study_of(), False)):
        assert needs_runs(study, "friction.coefficient", scaled=scales(study)) is needed
        assert needs_runs(study, "wear.disc", scaled=scales(study))


def test_a_run_counts_its_steps_and_not_the_cycles_that_they_stand_for(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with run_study(sheared(32), RunOptions(progress=Progress("fretting", pace=(-1.0, -1.0)))) as result:
        count = result.history["distance"].size
    told = re.findall(r"step (\d+) of (\d+)", capsys.readouterr().err)
    assert told == [(str(number), str(count)) for number in range(1, count)]  # the last needs no line
