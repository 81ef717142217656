"""What a terminal says at the end of a run: of one spot or of a track."""

import pytest
from cases_track import small

import warpwear
from warpwear import InputError, Study
from warpwear.results.summary import summarise, summary_text

STILL = {"grid.cell": "20 um", "sliding.distance": "60 mm", "output.snapshots": []}


def rows_of(study: Study) -> tuple[warpwear.Result, dict[str, str]]:
    """The result of a study, and its rows in the terminal by their names."""
    result = warpwear.run(study)
    lines = summary_text(summarise(result)).splitlines()[1:]
    return result, {line[2:18].strip(): line[18:].strip() for line in lines}


def test_a_disc_at_rest_is_told_with_its_section_on_a_track() -> None:
    """Scar and depths under the counter-body are those of no test in which it moves."""
    result, rows = rows_of(Study.load("v3-fine").replace(STILL | {"sliding.stroke": "5 mm"}))
    found = result.summary["on_a_track"]
    section = result.history["wear_volume_disc"][-1] / 5.0
    assert found == {"length_mm": 5.0, "section_um2": pytest.approx(1e6 * section, rel=1e-12)}
    told = rows["disc at rest"]
    assert told.startswith("scar and depths are those of one spot")
    assert f"on a track of 5 mm: section {1e6 * section:.4g} µm²" in told
    for changes in ({"sliding.stroke": "100 mm"}, {"sliding.distance": "0 mm"}):  # no whole pass
        less, lines = rows_of(Study.load("v3-fine").replace(STILL | changes))
        assert "on_a_track" not in less.summary
        assert ("disc at rest" in lines) == ("sliding.stroke" in changes)


def test_an_assumed_coefficient_of_friction_is_told() -> None:
    study = Study.load("v3-fine").replace(STILL)
    for changes, told in (
        ({"friction.coefficient": 0.4}, "at the end (an input) 0.4"),
        ({"friction.calibrate": "end"}, "at the end (an input, assumed) 0.6"),
    ):
        assert told in rows_of(study.replace(changes))[1]["friction"]


def test_a_groove_is_told_by_its_section() -> None:
    result, rows = rows_of(small("representative", output__snapshots=["3 mm"], grid__cell="10 um"))
    assert "disc at rest" not in rows
    groove = result.summary["track"]["groove"]
    assert groove["mean_depth_um"] < groove["deepest_um"]
    assert rows["groove"] == (
        f"mean section {groove['section_um2']:.4g} µm², {groove['width_mm']:.3g} mm wide, "
        f"mean profile {groove['deepest_um']:.3g} µm deep at most"
    )


def test_what_is_not_known_between_patches_is_left_open() -> None:
    """Profiles through patches that cover a part of the area are too short for Rq."""
    sampled = {"grid.cell": "10 um", "grid.extent": "2.1 mm", "patches.macro_cell": "300 um"}
    study = Study.load("two-scale").replace(sampled | {"patches.width": "100 um", "output.snapshots": []})
    result = warpwear.run(study.replace({"sliding.distance": "60 mm", "disc.synthetic.cut_off": "20 um"}))
    roughness = result.summary["inner_scar"]["disc"]
    assert roughness["sq_um"] > 0.0
    assert roughness["rq_along_um"] is None
    assert "along sliding Rq – µm" in summary_text(summarise(result))


def test_roughness_that_is_the_length_of_a_step_is_not_printed() -> None:
    """A ball that wears as dust is averaged along each step; one that wears in pieces is not."""
    changes = {"grid__cell": "10 um", "output__snapshots": ["3 mm"], "contact__law": "half-space"}
    result, rows = rows_of(small("representative", **changes))
    ball, disc = (result.summary["inner_scar"][body] for body in ("counter", "disc"))
    assert "Rq" not in rows["counter, inner scar"[:16]]
    assert ball["rq_along_um"] is not None
    assert ball["rq_along_of"].startswith("the length of a step")
    assert "along sliding Rq" in rows["disc, inner scar"[:16]]
    assert "rq_along_of" not in disc
    pieces = {"wear__particle": "40 um", "wear__particle_thickness": "0.6 um"}
    result, rows = rows_of(small("representative", **changes, **pieces))
    assert "along sliding Rq" in rows["counter, inner scar"[:16]]
    assert "rq_along_of" not in result.summary["inner_scar"]["counter"]


@pytest.mark.parametrize(("scheme", "times"), [("explicit", 1.1), ("implicit", 10.0)])
def test_the_scheme_of_steps_is_told_with_the_area_that_it_gives(scheme: str, times: float) -> None:
    """A rough contact that yields by wear alone keeps load over hardness, or grows twentyfold."""
    changes = {"grid.cell": "10 um", "stepping.scheme": scheme, "stepping.force": True}
    result, rows = rows_of(Study.load("v3-fine").replace(STILL | changes))
    assert rows["steps"].startswith(f"{scheme}: ")
    assert "0.0136 mm²" in rows["steps"]
    area = result.summary["load_over_hardness_mm2"]
    assert area == pytest.approx(8.0 / 590.0)
    assert (result.summary["area_mm2"]["contact"] > times * area) == (scheme == "implicit")
    springs = Study.load("v3-fine").replace(STILL | {"contact.stiffness": "1e6 N/mm^3"})
    assert "steps" not in rows_of(springs)[1]


def test_pressures_above_the_hardness_are_told() -> None:
    """The preset v3 balances its load to 0.5 N, in cells whose number is whole."""
    short = {"sliding.distance": "30 mm", "output.snapshots": []}
    result, rows = rows_of(Study.load("v3").replace(short))
    most = result.history["pressure_max"].max()
    assert most > 600.0
    assert rows["above hardness"] == f"up to {most:.4g} MPa of 590: the load is balanced to 0.5 N"
    assert result.summary["pressure_above_hardness_percent"] == pytest.approx(100.0 * (most / 590.0 - 1.0))
    assert "above hardness" not in rows_of(Study.load("v3-fine").replace(STILL))[1]


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
    told = [s for s in warpwear.run(study).summary["warnings"] if "yield elastically" in s]
    assert len(told) == 1
    assert ("for two bodies of steel (young or poisson of one is not given)" in told[0]) != known
    soft = warpwear.run(study.replace({"disc.hardness": "0.2 GPa"})).summary["warnings"]
    assert not any("yield elastically" in s for s in soft)
