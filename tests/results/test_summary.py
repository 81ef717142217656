"""What a terminal says at the end of a run: of one spot or of a track."""

import pytest
from cases_track import small

import warpwear
from warpwear import InputError, Study
from warpwear.drafts.draft import outlook
from warpwear.laws.elastic import asperities
from warpwear.results.summary import UNTOLD, summarise, summary_text

STILL = {"grid.cell": "20 um", "sliding.distance": "60 mm", "output.snapshots": []}


def rows_of(study: Study) -> tuple[warpwear.Result, dict[str, str]]:
    """The result of a study, and its rows in the terminal by their names."""
    result = warpwear.run(study)
    lines = str(result).splitlines()
    assert len(lines) <= 9  # and one for the page
    return result, {line[2:18].strip(): line[18:].strip() for line in lines[1:]}


def test_a_disc_at_rest_is_told_with_its_section_on_a_track() -> None:
    """Scar and depths under the counter-body are those of no test in which it moves."""
    result, rows = rows_of(Study.load("v3-fine").replace(STILL | {"sliding.stroke": "5 mm"}))
    found = result.summary["on_a_track"]
    section = result.history["wear_volume_disc"][-1] / 5.0
    assert found == {"length_mm": 5.0, "section_um2": pytest.approx(1e6 * section, rel=1e-12)}
    assert rows["deepest wear"].endswith("; the same spot of the disc stays under the load")
    for changes in ({"sliding.stroke": "100 mm"}, {"sliding.distance": "0 mm"}):  # no whole pass
        less, lines = rows_of(Study.load("v3-fine").replace(STILL | changes))
        assert "on_a_track" not in less.summary
        assert ("deepest wear" in lines) == ("sliding.stroke" in changes)


def test_an_assumed_coefficient_of_friction_is_told() -> None:
    study = Study.load("v3-fine").replace(STILL)
    for changes, told in (
        ({"friction.coefficient": 0.4}, "0.400 at the end (given); "),
        ({"friction.calibrate": "end"}, "0.600 at the end (assumed); "),
    ):
        assert told in rows_of(study.replace(changes))[1]["friction"]


def test_a_groove_is_told_by_its_section() -> None:
    result, rows = rows_of(small("representative", output__snapshots=["3 mm"], grid__cell="10 um"))
    assert "same spot" not in rows["deepest wear"]
    groove = result.summary["track"]["groove"]
    assert groove["mean_depth_um"] < groove["deepest_um"]
    deepest = result.summary["depth_um"]["disc"]
    section = f"(mean section of its groove {groove['deepest_um']:.3g} µm)"
    assert rows["deepest wear"].startswith(f"disc {deepest:.3g} µm {section}; ball ")


def test_details_have_every_number_of_the_summary() -> None:
    """Each under its name of summary.json, but what is not known."""
    result = warpwear.run(small("representative", output__snapshots=["3 mm"], grid__cell="10 um"))
    told = summary_text(summarise(result))

    def look(content: dict[str, object]) -> None:
        for key, value in content.items():
            if isinstance(value, dict):
                look(value)
            elif isinstance(value, float | int):
                assert f"{key} {value:.4g}" in told or f"{key} {value}" in told

    look({key: value for key, value in result.summary.items() if key not in UNTOLD})


def test_the_area_is_told_as_the_verdict_has_it() -> None:
    """What makes it uncertain, the largest first, and what nobody looked at."""
    for changes in ({}, {"contact.law": "half-space"}, {"checks.step_probe": False}):
        result, rows = rows_of(small("representative", output__snapshots=["3 mm"]).replace(changes))
        verdict = result.summary["verdict"]
        area = verdict["area_corrected_mm2"] or result.summary["area_mm2"]["contact"]
        assert rows["area in contact"].startswith(f"{area:.4g} mm² {verdict['area']}")


def test_what_to_do_next_is_told() -> None:
    """Of a part of the error that nobody looked at, or of the largest, the key that shows more of it."""
    study = small("representative", output__snapshots=[])
    result, rows = rows_of(study)
    largest = next(iter(result.summary["verdict"]["area_parts"]))
    key = {"cells": "grid.cell", "step": "sliding.shift"}[largest]
    assert f"may be off by over 10 %; next: run again with half of {key}" in rows["trust"]
    unknown = rows_of(study.replace({"checks.step_probe": False}))[1]["trust"]
    assert "the area's error is not known; next: run again with half of sliding.shift" in unknown
    still = Study.load("v1").replace({"grid.cell": "20 um", "sliding.distance": "30 mm"})
    assert "run again with half of stepping.increment" in rows_of(still)[1]["trust"]


def test_what_is_not_known_between_patches_is_left_open() -> None:
    """Profiles through patches that cover a part of the area are too short for Rq."""
    sampled = {"grid.cell": "10 um", "grid.extent": "2.1 mm", "patches.macro_cell": "300 um"}
    study = Study.load("two-scale").replace(sampled | {"patches.width": "100 um", "output.snapshots": []})
    result = warpwear.run(study.replace({"sliding.distance": "60 mm", "disc.synthetic.cut_off": "20 um"}))
    roughness = result.summary["inner_scar"]["disc"]
    assert roughness["sq_um"] > 0.0
    assert roughness["rq_along_um"] is None


def test_roughness_that_is_the_length_of_a_step_is_called_so() -> None:
    """A ball that wears as dust is averaged along each step; one that wears in pieces is not."""
    changes = {"grid__cell": "10 um", "output__snapshots": ["3 mm"], "contact__law": "half-space"}
    result = warpwear.run(small("representative", **changes))
    ball, disc = (result.summary["inner_scar"][body] for body in ("counter", "disc"))
    assert ball["rq_along_um"] is not None
    assert ball["rq_along_of"].startswith("the length of a step")
    assert "rq_along_of" not in disc
    pieces = {"wear__particle": "40 um", "wear__particle_thickness": "0.6 um"}
    result = warpwear.run(small("representative", **changes, **pieces))
    assert "rq_along_of" not in result.summary["inner_scar"]["counter"]


def test_pressures_above_the_hardness_are_told() -> None:
    """The preset v3 balances its load to 0.5 N, in cells whose number is whole."""
    short = {"sliding.distance": "30 mm", "output.snapshots": []}
    result = warpwear.run(Study.load("v3").replace(short))
    most = result.history["pressure_max"].max()
    assert most > 600.0
    assert result.summary["pressure_above_hardness_percent"] == pytest.approx(100.0 * (most / 590.0 - 1.0))
    capped = warpwear.run(Study.load("v3-fine").replace(STILL)).summary
    assert "pressure_above_hardness_percent" not in capped


def test_a_table_of_patches_is_no_column() -> None:
    history = warpwear.run(Study.load("v3-fine").replace(STILL)).history
    with pytest.raises(
        InputError, match=r"'load_share': it is one of every patch of a two-scale run: result\.load_share"
    ):
        history["load_share"]
    with pytest.raises(InputError, match="did you mean 'cof'"):
        history["coff"]


@pytest.mark.parametrize("known", [True, False])
def test_asperities_that_yield_elastically_are_told_of(known: bool) -> None:
    """Also where E* is not known: bodies are judged as if they were of steel."""
    elastic = {"disc.young": "210 GPa", "disc.poisson": 0.3} if known else {}
    text = """
        contact.load = "5 N"
        counter = {radius = "3 mm", young = "210 GPa", poisson = 0.3}
        sliding.distance = "0 mm"
        wear = {counter = "0 mm^3/N/m", disc = "0 mm^3/N/m"}
        friction.coefficient = 0.6
        grid = {cell = "4 um", extent = "0.4 mm"}
        [disc]
        hardness = "4 GPa"
        synthetic = {kind = "self-affine", ra = "0.2 um"}
    """
    study = Study.stored(text).replace(elastic)
    told = [s for s in warpwear.run(study).summary["warnings"] if "H/(E*·rms slope)" in s]
    assert len(told) == 1
    assert ("for two bodies of steel (young or poisson of one is not given)" in told[0]) != known
    soft = warpwear.run(study.replace({"disc.hardness": "0.2 GPa"})).summary["warnings"]
    assert not any("H/(E*·rms slope)" in s for s in soft)


def test_a_run_and_its_draft_say_alike_how_asperities_yield() -> None:
    """By one function: H/(E*·rms slope) of a soft, a hard and a smooth disc."""
    for hardness, kind in (("0.1 GPa", "plastic"), ("12 GPa", "partly plastic"), ("90 GPa", "elastic")):
        study = small("representative", grid__cell="10 um", contact__hardness=hardness)
        told = warpwear.run(study).summary["asperities"]
        assert told["kind"] == kind
        assert f"; asperities {kind}, H/(E*·rms slope) = " in outlook(study)
    assert asperities(500.0, 100e3, 0.01) == (0.5, "partly plastic")
    assert asperities(500.0, 100e3, 0.0)[1] == "elastic"
