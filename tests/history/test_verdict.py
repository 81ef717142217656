"""The verdict on a run: its errors hold, its parts add up, and what takes all trust is known as such."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import warpwear
from warpwear import Study
from warpwear.history.end_values import Summary, Verdict
from warpwear.history.verdict import rank_of, verdict_of
from warpwear.runs import doubts
from warpwear.runs.invariants import Invariants

SMOOTH = {"stepping.scheme": "implicit", "stepping.increment": "1 mm", "sliding.distance": "300 mm"}
ROUGH = {"sliding.distance": "3 mm", "output.snapshots": []}
#: Part of a summary of a rough run that knows of no error.
PLAIN = {
    "cell_um": 5.0,
    "scar_mm": {"along": 0.5, "across": 0.4},
    "load_residual_N": {"largest": 1e-12},
    "load_N": 8.0,
    "volume_mm3": {"counter": 1e-3, "disc": 0.0},
    "warnings": [],
    "finished": True,
    "assumptions": {},
    "cof": {"end": 0.6},
}
TRACK = {
    "parts": {"estimated_error_at_most": 0.03},
    "last_cycle": {"area_contact_mm2": {"forward": 1.2, "backward": 0.8}},
}


def rough(**friction: Any) -> Study:
    return Study.load("v3-fine").replace({f"friction.{key}": value for key, value in friction.items()})


def judged(s: dict[str, Any], history: dict[str, Any] | None = None, **friction: Any) -> Verdict:
    return verdict_of(rough(**friction), Summary.of(PLAIN | s), history or {})


@pytest.mark.parametrize("cell", [30.0, 20.0, 10.0])
def test_the_errors_of_a_smooth_contact_hold(cell: float) -> None:
    """Against the closed form of a wearing ball: area and mean depth of the scar are within the errors."""
    study = Study.load("v1").replace(SMOOTH | {"grid.cell": f"{cell} um"})
    verdict, summary = (result := warpwear.run(study)).summary["verdict"], result.summary
    wear, load = sum(study.wear_coefficients), study.contact.load
    exact = math.pi * math.sqrt(4.0 * wear * load * 300.0 * 3.0 / math.pi)
    error = abs(summary["area_mm2"]["contact"] / exact - 1.0)
    assert 0.0 < error < verdict["area_relative"] < 0.2
    assert verdict["text"].startswith(f"area ± {100 * verdict['area_relative']:.2g} % (cell); mean depth")
    depth = summary["volume_mm3"]["disc"] / summary["area_mm2"]["nominal"]
    mean = study.wear_coefficients[1] * load * 300.0 / exact
    assert abs(depth / mean - 1.0) < verdict["depth_relative"]
    assert verdict["trusted"]


def test_the_error_of_a_rough_scar_holds_and_that_of_its_area_is_not_known() -> None:
    """Of the same surface on other cells; nobody knows the mesh's error from one run alone."""
    runs = [
        warpwear.run(Study.load("v3-fine").replace(ROUGH | {"grid.cell": f"{cell} um"}))
        for cell in (4, 10, 20)
    ]
    sizes = [run.summary["area_mm2"]["nominal"] for run in runs]
    for run, size in zip(runs[1:], sizes[1:], strict=True):
        verdict = run.summary["verdict"]
        assert abs(sizes[0] / size - 1.0) < verdict["depth_relative"]
        assert verdict["area_relative"] is None
        assert "area ± not known: halve the cell and compare; mean depth of the scar ±" in verdict["text"]


def test_known_errors_add_up_as_squares() -> None:
    history = {"area_static": np.array([0.9, math.nan]), "area_contact": np.array([1.0, 2.0])}
    verdict = judged({"track": TRACK, "load_on_filled_percent": {"largest": 4.0}}, history)
    parts = {"length of steps": 0.03, "direction": 0.2, "wear within a step": 0.1, "points filled in": 0.04}
    assert verdict.area_parts == pytest.approx({"cell": None, "balance of the load": 0.0} | parts, abs=1e-12)
    assert verdict.area_relative == pytest.approx(math.hypot(*parts.values()))
    assert verdict.text.startswith(
        "area ± 23 % (length of steps 3 %, direction 20 %, wear within a step 10 %, points filled in 4 %), "
        "the cell's part not known: halve the cell and compare; mean depth of the scar ± 4.5 % (a cell"
    )
    jumped = judged({"cycle_jump": {"depth_error": {"counter": 0.06, "disc": 0.01}}})
    assert jumped.depth_relative == pytest.approx(math.hypot(0.045, 0.06))
    assert "scar ± 7.5 % (a cell at its rim, cycles jumped over 6 %); friction" in jumped.text
    unbalanced = judged({"load_residual_N": {"largest": 0.4}})
    assert unbalanced.text.startswith("area ± 5 % (balance of the load), the cell's part not known")


@pytest.mark.parametrize(
    ("friction", "assumed", "words"),
    [
        ({"coefficient": 0.5}, True, "friction assumed, at the end"),
        ({"coefficient": 0.5, "calibrate": "initial"}, False, "friction given, at the start"),
        ({"law": "coulomb", "coefficient": 0.5}, False, "friction given"),
        ({"shear_strength": "4 MPa"}, False, "predicted from the area, by a shear strength that is given"),
        ({"shear_strength": "4 MPa"}, True, "predicted from the area, by a shear strength that is assumed"),
    ],
)
def test_whence_friction_is(friction: dict[str, Any], assumed: bool, words: str) -> None:
    keys = ("friction.coefficient", "friction.shear_strength") if assumed else ()
    verdict = judged({"assumptions": dict.fromkeys(keys, "")}, **friction)
    assert verdict.text.endswith(words)
    assert f"; friction {verdict.friction}" in verdict.text


def test_what_takes_all_trust_is_said_first() -> None:
    verdict = judged({"warnings": ["areas scatter from step to step and mean nothing.", "a note"]})
    assert verdict.text.startswith("not to be trusted: 1 warning; area")
    assert not verdict.trusted
    unfinished = judged({"finished": False, "cof": {"end": None}})
    assert unfinished.text.startswith("interrupted: as far as it came; area")
    assert unfinished.text.endswith("friction unknown before the end")


def test_what_is_heavy_is_known_by_its_words() -> None:
    """Of the sentences that runs say, so that nobody rewords one unseen."""
    study = rough(shear_strength="4 MPa")
    row = warpwear.run(study.replace(ROUGH | {"grid.cell": "20 um"})).history
    last = {name: float(values[-1]) for name, values in row.items()}
    checks = Invariants(study.replace({"grid.cell": "20 um"}))
    wrong = [
        *checks.of_row(last | {"area_contact": math.nan}),
        *checks.of_row(last | {"load_residual": 4.0}),
        *checks.of_row(last | {"wear_volume_disc": 1.0}),
        *checks.of_row(last, touches_edge=True),
        *checks.of_row(last, touches_rim=True),
    ]
    sentences = [violation.sentence for violation in wrong]
    sentences += doubts.of_count(study, 3.0, "At times")
    sentences += doubts.of_history(study, row | {"cof": row["cof"] + 9.0}, finished=True)
    explicit = Study.load("v1").replace({"stepping.force": True, "stepping.increment": "3 mm"})
    sentences += [sentence for sentence in explicit.notices() if "stability" in sentence]
    assert len(sentences) == 8
    assert [rank_of(sentence, "warning") for sentence in sentences] == [0] * 8
    unused = study.replace({"wear.decay": "0.1 1/mm", "contact.boundary": "free"}).notices()
    assert [rank_of(sentence, "note") for sentence in unused] == [3, 3]


def test_summary_and_notebook_begin_with_it(tmp_path: Path) -> None:
    study = Study.load("v1").replace(SMOOTH | {"grid.cell": "30 um"})
    result = warpwear.run(study, out=tmp_path / "run", plots=False)
    written = json.loads((tmp_path / "run" / "summary.json").read_text(encoding="utf-8"))
    assert Summary.of(written) == Summary.of(result.summary)
    assert next(iter(result.summary)) == "verdict"
    assert f"<b>Verdict.</b> {result.summary['verdict']['text']}." in result._repr_html_()
