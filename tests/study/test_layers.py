"""Layers and gradients of a study: what they become, and what they do not go with."""

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from warpwear import InputError, Study
from warpwear.calibration.bayes.runs import scales
from warpwear.calibration.bayes.unknowns import unknowns_of
from warpwear.history.quantities import columns_of
from warpwear.study import rules_track
from warpwear.study.rules_track import extent_for, worn_widths

COAT: dict[str, Any] = {"name": "dlc", "thickness": "2 um", "wear": "2e-7 mm^3/N/m"}
BOND: dict[str, Any] = {"name": "bond_1", "thickness": "0.5 um", "wear": "4e-4 mm^3/N/m"}
BARE = {"friction.shear_strength": "172 MPa"}


def layered(changes: dict[str, Any] | None = None, *layers: dict[str, Any], preset: str = "track") -> Study:
    """A preset with layers on its disc."""
    return Study.load(preset).replace({"disc.layers": [*(layers or (COAT, BOND))]} | (changes or {}))


def test_layers_become_a_profile_of_the_body() -> None:
    study = layered()
    counter, disc = study.contact_task.profiles or ()
    assert disc.depths == (0.0, 2.0e-3, 2.5e-3)
    assert [m.name for m in disc.materials] == ["dlc", "bond_1", "substrate"]
    assert [m.wear for m in disc.materials] == pytest.approx([2e-10, 4e-7, study.wear_coefficients[1]])
    assert {m.hardness for m in disc.materials} == {590.0}  # contact.hardness is of all cells
    assert counter.materials[0].wear == study.wear_coefficients[0]
    assert Study.load("track").contact_task.profiles is None


def test_a_key_of_a_layer_has_its_number() -> None:
    thicker = layered().replace({"disc.layers.2.thickness": "3 um"})
    assert [layer.thickness for layer in thicker.disc.layers or ()] == [2.0e-3, 3.0e-3]
    (unknown,) = unknowns_of(thicker, {"disc.layers.2.wear": None})
    assert (unknown.unit, float(unknown.values(np.zeros(1))[0])) == ("mm^3/N/m", pytest.approx(4e-4))
    with pytest.raises(InputError, match=r"disc\.layers\.3: the study has 2 layers, numbered from 1"):
        layered().replace({"disc.layers.3.thickness": "3 um"})


def test_a_layered_study_is_written_and_read_without_loss() -> None:
    study = layered(BARE, COAT | {"shear_strength": "60 MPa"}, BOND)
    assert Study(**tomllib.loads(study.to_toml())) == study
    marked = study.to_toml(marked=True)
    assert '[[disc.layers]]\nname = "dlc"\nthickness = "2 um"' in marked
    assert tomllib.loads(marked)["disc"]["layers"][1]["name"] == "bond_1"


@pytest.mark.parametrize(
    ("counter", "disc", "coat", "caps"),
    [
        ("3 GPa", "2 GPa", "20 GPa", (3000.0, 2000.0)),
        ("30 GPa", "2 GPa", "20 GPa", (20000.0, 2000.0)),
        ("1 GPa", "2 GPa", "20 GPa", (1000.0, 1000.0)),
        ("3 GPa", "2 GPa", "1 GPa", (1000.0, 2000.0)),
    ],
)
def test_a_cap_is_that_of_the_softer_material(
    counter: str, disc: str, coat: str, caps: tuple[float, float]
) -> None:
    """Of the unworn surfaces first: those are the numbers of a plain run."""
    given = {"contact.hardness": None, "counter.hardness": counter, "disc.hardness": disc}
    study = layered(given, COAT | {"hardness": coat})
    assert study.pair.cell_caps == pytest.approx(caps)
    assert study.contact_task.hardness == pytest.approx(caps[0])
    assert study.contact_task.least_hardness == pytest.approx(min(caps))
    assert study.hardness == pytest.approx(max(caps))


def test_a_gradient_is_read_from_a_file_and_kept_in_the_study(tmp_path: Path) -> None:
    (tmp_path / "case.csv").write_text("depth um,K,H\n0,2e-4,9000\n10,4e-4,7000\n\n40,1.27e-3,1520\n")
    text = layered().replace({"disc.gradient": [[0, 2e-4], [40, 1.27e-3]]}).to_toml()
    at = text.index("gradient = ")
    end = text.index("]\n", text.index("\n]", at) - 1) + 2
    (tmp_path / "study.toml").write_text(text[:at] + 'gradient = "case.csv"\n' + text[end:])
    plain = {"contact.hardness": None, "counter.hardness": "3 GPa", "disc.hardness": "1520 MPa"}
    with pytest.raises(InputError, match=r"disc\.gradient does not go with contact\.hardness"):
        Study.load(tmp_path / "study.toml")
    (tmp_path / "case.csv").write_text("0,2e-4\n10,4e-4\n40,1.27e-3\n")
    study = Study.load(tmp_path / "study.toml").replace(plain)
    (tmp_path / "case.csv").unlink()
    again = Study(**tomllib.loads(study.to_toml()))
    _, profile = again.pair.profiles or ()
    assert profile.graded
    assert profile.depths == pytest.approx((0.0, 1.0e-2, 4.0e-2))
    assert [m.wear for m in profile.materials] == pytest.approx([2e-7, 4e-7, 1.27e-6])
    assert [m.hardness for m in profile.materials] == [1520.0] * 3


REFUSED: list[tuple[dict[str, Any], tuple[dict[str, Any], ...], str]] = [
    ({}, (COAT, COAT), "names must differ"),
    ({}, (COAT | {"name": "substrate"},), "not 'substrate'"),
    ({}, (COAT | {"name": "a b"},), "letters, digits and _"),
    ({}, (COAT | {"wear": "0 mm^3/N/m"},), "must be above 0"),
    ({}, (COAT | {"wear": 1e-4},), "must be above 0, with a unit"),
    ({}, (COAT | {"wear": "1e-4 mm^3/J"},), r"disc\.layers\.1\.wear .* does not go with wear\.law"),
    ({}, (COAT | {"hardness": "20 GPa"},), r"layers\.1\.hardness does not go with contact\.hardness"),
    ({"friction.shear_strength": None}, (COAT | {"coefficient": 0.1},), "needs friction.shear_strength"),
    (BARE, (COAT | {"coefficient": 0.1, "shear_strength": "9 MPa"},), "exclude each other"),
    ({"wear.law": "running-in", "wear.running_in": "9 mm", "wear.initial_disc": "1e-3 mm^3/N/m"}, (COAT,),
     r"\[\[disc.layers\]\] needs wear.law = 'archard', 'exponential' or 'energy', not 'running-in'"),
    ({"stepping.scheme": "explicit"}, (COAT,), "does not go with stepping.scheme = 'explicit'"),
    ({"sliding.plastic": "keep"}, (COAT,), "does not go with sliding.plastic = 'keep'"),
    ({"friction.area": "nominal"}, (COAT,), "does not go with friction.area = 'nominal'"),
    (BARE | {"friction.junction_growth": 9.0}, (COAT,), "does not go with friction.junction_growth"),
    ({"disc.gradient": [[0, 1e-4], [9, 1.27e-3]]}, (COAT,), "disc.gradient exclude each other"),
    ({"disc.layers": None, "disc.gradient": [[0, 1e-4], [9, 1e-3]]}, (), "ends in 0.001: allowed in"),
    ({"disc.layers": None, "disc.gradient": [[1, 1e-4], [9, 1.27e-3]]}, (), "rising from 0"),
    ({"disc.layers": None, "disc.gradient": "nowhere.csv"}, (), "cannot be read"),
    ({"disc.layers": "dlc"}, (), "is no list of layers"),
    ({"disc.layers": []}, (), "one or more"),
    ({}, tuple(COAT | {"name": f"c{n}"} for n in range(8)), "8 are too many; allowed are 7, or a grad"),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "layers", "sentence"), REFUSED, ids=[s for _, _, s in REFUSED])
def test_what_does_not_go_together_is_refused_in_a_sentence(
    changes: dict[str, Any], layers: tuple[dict[str, Any], ...], sentence: str
) -> None:
    with pytest.raises(InputError, match=sentence) as error:
        layered(changes, *layers)
    assert "\n" not in str(error.value)


def test_a_host_that_does_not_follow_layers_refuses_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rules_track, "FOLLOWED", (("swept", "local"),))
    layered()
    with pytest.raises(InputError, match=r"contact\.law = 'half-space', swept, do not follow them"):
        layered({"contact.law": "half-space"})
    with pytest.raises(InputError, match=r"'local', patches, do not follow them"):
        layered(preset="two-scale")


def test_loads_of_patches_that_are_prescribed_refuse_layers() -> None:
    assert layered(preset="two-scale").pair.profiles
    with pytest.raises(InputError, match=r"does not go with patches\.coupling = 'load', which prescribes"):
        layered({"patches.coupling": "load"}, preset="two-scale")


def test_a_film_lies_on_layers_but_not_on_patches() -> None:
    film = BARE | {"friction.film.thickness": "9 nm", "friction.film.shear_strength": "9 MPa"}
    assert layered(film).contact_task.film is not None
    with pytest.raises(
        InputError, match=r"disc.layers\]\] does not go with \[friction.film\], which patches"
    ):
        layered(film, preset="two-scale")


def test_extents_know_the_layers() -> None:
    """A coat that lasts leaves a scar as narrow as its K makes it; one worn through is all but not there."""
    plain = Study.load("track")
    coat_alone = plain.replace({"wear.disc": COAT["wear"]})
    lasting = layered({}, COAT | {"thickness": "100 um"})
    gone = layered({}, COAT | {"thickness": "1 nm"})
    assert worn_widths(lasting) == worn_widths(coat_alone)
    assert worn_widths(gone) == pytest.approx(worn_widths(plain), rel=1e-2)
    between = layered({}, COAT | {"thickness": "1 um"}).volumes(2400.0)[1]
    assert coat_alone.volumes(2400.0)[1] < between < plain.volumes(2400.0)[1]
    assert extent_for(lasting, 100.0) == extent_for(coat_alone, 100.0)


def test_a_layered_run_does_not_scale() -> None:
    still = {"stepping.scheme": "implicit"}
    assert scales(Study.load("v1").replace(still))
    assert not scales(layered(still, COAT, preset="v1"))
    assert scales(layered(still | {"wear.disc": COAT["wear"]}, COAT, preset="v1"))


def test_a_thick_layer_is_said_to_yield_as_the_body() -> None:
    assert not [text for text in layered().notices() if "elastic constants" in text]
    (said,) = [t for t in layered({}, COAT | {"thickness": "20 um"}).notices() if "elastic constants" in t]
    half = layered().hertz.semi_axes[0]  # type: ignore[union-attr]
    assert f"disc.layers are 20 µm thick, {20e-3 / half:.2g} of the contact's half width" in said
    assert math.isfinite(half)


def test_the_preset_of_a_coat_is_worn_through_within_its_run() -> None:
    """By its estimate: the coat bears first, is thin, and the crater is deeper at the end."""
    study = Study.load("coat")
    coat = (study.disc.layers or ())[0]
    assert (coat.name, study.contact_task.hardness) == ("dlc", study.counter.hardness)
    lost = study.volumes(study.sliding.total)[1]
    assert study.counter.form.deepest(lost, study.grid.sides)[0] > 1.2 * coat.thickness
    assert not [text for text in study.notices() if "elastic constants" in text]


def test_a_layer_as_strong_as_the_body_has_no_column_of_its_own() -> None:
    """What a run of the study books, and what its history has, is by the same rule."""
    alike = layered(BARE, COAT | {"shear_strength": BARE["friction.shear_strength"]})
    for study, unalike in ((alike, False), (layered(BARE, COAT | {"coefficient": 0.1}), True)):
        assert study.contact_task.shears_unalike == unalike
        assert ("area_sheared" in {column.name for column in columns_of(study)}) == unalike


def test_a_shear_strength_says_which_cells_have_another() -> None:
    study = Study.load("coat")
    assert study.pair.other_shear == ", layers by their own"
    bound = study.replace({"friction.largest_coefficient": 0.3})
    assert bound.pair.other_shear == ", layers by their own, at most 0.3 of the pressure of a cell"
    film = {"thickness": "10 nm", "shear_strength": "40 MPa"}
    plain = Study.load("v3-fine").replace({"friction.shear_strength": "172 MPa"})
    assert plain.pair.other_shear == ""
    assert plain.replace({"friction.film": film}).pair.other_shear == ", film 40 MPa"
