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
from warpwear.history.verdict import rank_of, sides_of, verdict_of
from warpwear.runs import doubts
from warpwear.runs.invariants import Invariants

SMOOTH = {"stepping.scheme": "implicit", "stepping.increment": "1 mm", "sliding.distance": "300 mm"}
ROUGH = {"sliding.distance": "3 mm", "output.snapshots": []}
#: Part of a summary of a run that knows of no error: 36 cells of 5 µm in contact, of 60 sides.
PLAIN = {
    "cell_um": 5.0,
    "scar_mm": {"along": 0.05, "across": 0.04},
    "area_mm2": {"contact": 1e-3},
    "contact_sides": 60,
    "load_residual_N": {"largest": 1e-12},
    "load_N": 8.0,
    "warnings": [],
    "finished": True,
    "assumptions": {},
    "cof": {"end": 0.6},
}
CELL_AREA, LAST = 2.5e-5, 36 * 2.5e-5
#: Area over the perimeter times the cell that cells add to a contact of the half-space.
ADDED = 0.118114
TRACK = {"grid.cell": "5 um", "grid.extent": "0.4 mm", "sliding.shift": 8, "sliding.distance": "90 mm"}


def rough(**friction: Any) -> Study:
    return Study.load("v3-fine").replace({f"friction.{key}": value for key, value in friction.items()})


def track(law: str, **changes: Any) -> Study:
    return Study.load("track").replace(TRACK | {"contact.law": law} | changes)


def judged(s: dict[str, Any], study: Study | None = None, **history: Any) -> Verdict:
    columns = {"area_contact": np.array([LAST]), "distance": np.ones(1), "increment": np.ones(1)}
    return verdict_of(study or rough(), Summary.of(PLAIN | s), columns | history)


@pytest.mark.parametrize("cell", [30.0, 20.0, 10.0])
def test_the_errors_of_a_smooth_contact_hold(cell: float) -> None:
    """Against the closed form of a wearing ball: area and scar are within the errors."""
    study = Study.load("v1").replace(SMOOTH | {"grid.cell": f"{cell} um"})
    verdict, summary = (result := warpwear.run(study)).summary["verdict"], result.summary
    wear, load = sum(study.wear_coefficients), study.contact.load
    exact = math.pi * math.sqrt(4.0 * wear * load * 300.0 * 3.0 / math.pi)
    error = abs(summary["area_mm2"]["contact"] / exact - 1.0)
    assert 0.0 < error < verdict["area_relative"] < 0.1
    assert verdict["area_corrected_mm2"] is None
    assert verdict["text"].startswith(f"area {summary['area_mm2']['contact']:.3g} mm² ± ")
    assert "step" not in verdict["area_parts"]  # an implicit step at rest
    width = 2.0 * math.sqrt(exact / math.pi)
    assert abs(summary["scar_mm"]["along"] - width) < verdict["scar_error_mm"] == pytest.approx(2e-3 * cell)
    assert verdict["trusted"]


def test_the_errors_of_a_rough_contact_at_rest_hold() -> None:
    """Of the same surface on other cells."""
    runs = [
        warpwear.run(Study.load("v3-fine").replace(ROUGH | {"grid.cell": f"{cell} um"})).summary
        for cell in (4, 10, 20)
    ]
    for run in runs[1:]:
        verdict = run["verdict"]
        assert [*verdict["area_parts"]] == ["cells", "balance of the load"]
        assert (
            abs(runs[0]["area_mm2"]["contact"] / run["area_mm2"]["contact"] - 1.0) < verdict["area_relative"]
        )
        assert abs(runs[0]["scar_mm"]["along"] - run["scar_mm"]["along"]) < verdict["scar_error_mm"]


def test_sides_of_a_contact_are_counted() -> None:
    """Of one cell four, of a block its perimeter, of a hole in it four more; none at the domain's edge."""
    cells = np.zeros((9, 8), dtype=bool)
    assert sides_of(cells) == 0
    cells[4, 4] = True
    assert sides_of(cells) == 4
    cells[2:5, 3:7] = True
    assert sides_of(cells) == 2 * (3 + 4)
    cells[3, 4] = False
    assert sides_of(cells) == 2 * (3 + 4) + 4
    cells[:] = False
    cells[:3] = True  # goes on along the first rows and both columns of the edge
    assert sides_of(cells) == 8
    assert sides_of(~cells) == 8
    study = Study.load("v1").replace(SMOOTH | {"grid.cell": "30 um"})
    result = warpwear.run(study)
    touches = np.pad(result.snapshot(-1).pressure > 0.0, 1)
    sides = sum(int(np.sum(touches & ~np.roll(touches, by, axis))) for by in (1, -1) for axis in (0, 1))
    assert result.summary["contact_sides"] == sides > 0


@pytest.mark.parametrize(
    ("changes", "of_root"),
    [({"contact.law": "local"}, 0.57), ({"disc.synthetic": {"kind": "flat"}}, 1.14)],
)
def test_cells_of_a_local_track_are_those_of_outlines(changes: dict[str, Any], of_root: float) -> None:
    """Of smooth ones they may lie on the cells in a regular way."""
    if "disc.synthetic" in changes:
        changes = changes | {"sliding.track": "full", "sliding.stroke": "0.8 mm"}
    verdict = judged({"track": {"change_by_step": -0.03}}, track("local", **changes))
    parts = {"step": 0.09, "cells": of_root * CELL_AREA * math.sqrt(60.0) / LAST, "balance of the load": 0.0}
    assert verdict.area_parts == pytest.approx(parts, abs=1e-12)
    assert [*verdict.area_parts] == sorted(parts, key=lambda name: -parts[name])  # the largest first
    assert verdict.area_corrected_mm2 is None
    assert verdict.area_relative == pytest.approx(math.hypot(*parts.values()))


def test_a_half_space_on_a_track_is_corrected_where_its_step_is_known() -> None:
    """Both or none: a corrected area whose step is not known would be further off than the counted one."""
    added, study = ADDED * 60 * CELL_AREA / LAST, track("half-space")
    known = judged({"track": {"parts": {"estimated_error_at_most": 0.02}}}, study)
    assert known.area_corrected_mm2 == pytest.approx(1e-3 * (1.0 - added), rel=1e-4)
    cells = 0.5 * added / (1.0 - added)
    assert known.area_parts == pytest.approx(
        {"cells": cells, "step": 0.02, "balance of the load": 0}, rel=1e-4, abs=1e-9
    )
    assert known.area_relative == pytest.approx(math.hypot(cells, 0.02), rel=1e-4)
    assert known.text.startswith(f"area {1e-3 * (1.0 - added):.3g} mm² ± {100 * known.area_relative:.2g} %")
    for parts in (None, {"estimated_error_at_most": 0.0}, {"estimated_error_at_most": None}):
        unknown = judged({"track": {"parts": parts, "change_by_step": 0.01}}, study)
        assert unknown.area_corrected_mm2 is unknown.area_relative is None
        assert unknown.area_parts["cells"] == pytest.approx(1.5 * added, rel=1e-4)
        assert [*unknown.area_parts.items()][-1] == ("step", None)
        assert unknown.text.startswith(
            "area 0.001 mm² ± not known (size of cells 30 %, length of steps not looked at); "
        )
        assert not unknown.trusted


def test_cells_at_rest_are_those_of_outlines_or_the_perimeter() -> None:
    level = 1.14 * CELL_AREA * math.sqrt(60.0) / LAST
    assert judged({}).area_parts["cells"] == pytest.approx(level)
    half_space = Study.load("v3-fine").replace({"contact.law": "half-space"})
    most = max(level, ADDED * 60 * CELL_AREA / LAST)
    assert judged({}, half_space).area_parts["cells"] == pytest.approx(most, rel=1e-4)
    few = judged({"contact_sides": 100}, half_space)
    assert few.area_parts["cells"] == pytest.approx(ADDED * 100 * CELL_AREA / LAST, rel=1e-4)


def test_what_nobody_looked_at_is_not_known() -> None:
    assert judged({"contact_sides": None}).area_parts["cells"] is None
    assert judged({"track": {"change_by_step": None}}, track("local")).area_parts["step"] is None
    explicit = judged({}, rough().replace({"stepping.scheme": "explicit"}))
    assert explicit.area_parts["step"] is None
    assert not explicit.trusted
    two_scale = Study.load("two-scale").replace({"grid.cell": "10 um", "sliding.distance": "3 mm"})
    summary = warpwear.run(two_scale).summary
    assert summary["contact_sides"] is summary["verdict"]["area_parts"]["cells"] is None


def test_a_scar_is_known_to_two_cells_unless_dents_are_kept() -> None:
    assert judged({}, track("local")).scar_error_mm == pytest.approx(0.01)
    assert judged({}, Study.load("two-scale")).scar_error_mm is None
    assert judged({}, track("local", **{"sliding.plastic": "keep"})).scar_error_mm is None
    parts = judged({}, track("half-space"), parts=np.array([8.0, 3.0]))
    assert parts.scar_error_mm == pytest.approx(0.005 * (1 + 3))  # two parts of three cells, one of two


def test_known_errors_add_up_as_squares() -> None:
    static = {"area_static": np.array([0.9 * LAST, math.nan]), "area_contact": np.array([LAST, LAST])}
    also = {
        "load_on_filled_percent": {"largest": 4.0},
        "cycle_jump": {"depth_error": {"counter": 0.06, "disc": 0.01}},
    }
    verdict = judged(also | {"load_residual_N": {"largest": 0.4}, "contact_sides": 4}, **static)
    parts = {"wear within a step": 0.1, "cells": 1.14 * CELL_AREA * 2.0 / LAST, "jumps": 0.06}
    parts |= {"balance of the load": 0.05, "points filled in": 0.04}
    assert verdict.area_parts == pytest.approx(parts)
    assert [*verdict.area_parts] == [*parts]
    assert verdict.area_relative == pytest.approx(math.hypot(*parts.values()))
    assert not verdict.trusted  # more than a tenth
    assert verdict.text.startswith(
        "area 0.001 mm² ± 15 % (wear within a step 10 %, size of cells 6.3 %, cycles not computed 6 %, "
        "load not balanced 5 %, points"
    )


def test_scatter_along_the_track_tells_of_another_piece() -> None:
    """Of both ways, of as many contacts as lie side by side on the track; it is not in the sum."""
    study = track("local")
    steps, rng = study.track.steps_of_pass, np.random.default_rng(2)
    forth = 1.0 + 0.1 * rng.normal(size=steps)
    other = 1.0 + 0.1 * rng.normal(size=steps)
    lap = study.track.stroke
    history = {
        "area_contact": LAST * np.concatenate([other, other, forth, 1.0 + (1.0 - forth[::-1])]),
        "increment": np.full(4 * steps, lap / steps),
        "distance": np.arange(1, 4 * steps + 1) * lap / steps,
    }
    even = judged({"track": {"change_by_step": -0.01}}, study, **history)
    assert even.area_scatter == pytest.approx(0.0, abs=1e-12)
    history["area_contact"][2 * steps :] = LAST * np.concatenate([forth, forth[::-1]])
    verdict = judged({"track": {"change_by_step": -0.01}}, study, **history)
    assert verdict.area_scatter == pytest.approx(forth.std() / forth.mean() / math.sqrt(3.2 / 0.05), rel=1e-9)
    assert f"; another piece of such a surface ± {100 * verdict.area_scatter:.2g} %; " in verdict.text
    assert set(verdict.area_parts) == {"cells", "step", "balance of the load"}
    assert judged({}).area_scatter is None


@pytest.mark.parametrize(
    ("friction", "assumed", "words"),
    [
        ({"coefficient": 0.5}, True, "friction assumed at the end"),
        ({"coefficient": 0.5, "calibrate": "initial"}, False, "friction given at the start"),
        ({"law": "coulomb", "coefficient": 0.5}, False, "friction given"),
        ({"shear_strength": "4 MPa"}, False, "predicted from the area, by a shear strength that is given"),
        ({"shear_strength": "4 MPa"}, True, "predicted from the area, by a shear strength that is assumed"),
    ],
)
def test_whence_friction_is(friction: dict[str, Any], assumed: bool, words: str) -> None:
    keys = ("friction.coefficient", "friction.shear_strength") if assumed else ()
    verdict = judged({"assumptions": dict.fromkeys(keys, "")}, rough(**friction))
    assert verdict.text.endswith(words)
    assert f"; coefficient of friction {verdict.friction}" in verdict.text


def test_what_takes_all_trust_is_said_first() -> None:
    verdict = judged({"warnings": ["areas scatter from step to step and mean nothing.", "a note"]})
    assert verdict.text.startswith("not to be trusted: 1 warning; area")
    assert not verdict.trusted
    unfinished = judged({"finished": False, "cof": {"end": None}})
    assert unfinished.text.startswith("interrupted: numbers of the distance slid so far; area")
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
