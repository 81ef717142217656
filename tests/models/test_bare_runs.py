"""What a film that wear breaks leaves bare, step by step and in whole runs; what is refused."""

import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_bare import BARE, FILM, FILMED, STRENGTHS, STUDIES, history_of, needs_transforms
from cases_figures import drawn, faults_of
from numpy.testing import assert_allclose, assert_array_equal

import warpwear
from warpwear import Study
from warpwear.errors import InputError
from warpwear.grid import FloatArray

# What is bare, step by step, against books kept in NumPy.


class Books:
    """The film of one body, as the documentation describes it."""

    def __init__(self, shape: tuple[int, ...], thickness: float, regrowth: float) -> None:
        self.thickness, self.regrowth = thickness, regrowth
        self.whole, self.rubbed, self.wear = np.zeros(shape), np.zeros(shape), np.zeros(shape)

    def lost(self, distance: float) -> FloatArray:
        heals = distance - self.rubbed >= self.regrowth
        self.whole[heals] = self.wear[heals]
        return self.wear - self.whole > self.thickness

    def note(self, wear: FloatArray, distance: float) -> None:
        self.rubbed[wear > self.wear] = distance
        self.wear = wear.copy()


#: Each model heals in each way and has a film on each body, the quickest in all their combinations.
BARED = [
    (law, regrowth, bodies)
    for law in ("track", "track, bearing area", "rest, half-space")
    for n, regrowth in enumerate(("never", "0.5 mm", "4 mm"))
    for m, bodies in enumerate(("both", "counter", "disc"))
    if n == m or law == "track"
]


@pytest.mark.parametrize(("law", "regrowth", "bodies"), BARED)
def test_what_is_bare(law: str, regrowth: str, bodies: str, device: str) -> None:
    study = STUDIES[law]
    needs_transforms(study, device)
    thickness = "200 nm"
    film = FILM | {"friction.film.bodies": bodies, "friction.film.regrowth": regrowth}
    study = study.replace(film | {"friction.film.thickness": thickness})
    after = math.inf if regrowth == "never" else float(regrowth.split()[0])
    books: dict[str, Books] = {}
    done, seen = 0.0, []
    for step in warpwear.steps(study, device=device):
        fields, shot = step.fields, step.snapshot()
        if not books:
            names = ("counter", "disc") if bodies == "both" else (bodies,)
            books = {name: Books(fields[f"wear_{name}"].shape, 2e-4, after) for name in names}
        nx, bare = fields["pressure"].shape[0], np.ones(fields["pressure"].shape, dtype=bool)
        for name, kept in books.items():
            lost = kept.lost(done)
            if name == "disc" and shot.row is not None:
                lost = lost[np.arange(shot.row, shot.row + nx) % lost.shape[0]]
            bare &= lost
        assert_array_equal(fields["bare"] > 0.0, bare)
        pressed = fields["pressure"] > 0.0
        assert step.row["bare_fraction"] == pytest.approx(bare[pressed].mean(), abs=1e-12)
        strength = 40.0 + (172.0 - 40.0) * step.row["bare_fraction"]
        assert step.row["cof"] == pytest.approx(strength * step.row["area_contact"] / 8.0)
        done = step.row["distance"]
        seen.append(step.row["bare_fraction"])
        for name, kept in books.items():
            kept.note(fields[f"wear_{name}"], done)
    if regrowth == "never":
        assert max(seen) > 0.1


# Runs.


def healing(law: str) -> Study:
    """A study whose films form anew, of which three fields a body are kept."""
    film = FILM | {"friction.film.regrowth": "1.5 mm"}
    return STUDIES[law].replace(film)


@pytest.mark.parametrize("law", ["track", "track, half-space", "rest, half-space", "two scales"])
def test_a_killed_run_goes_on_bit_for_bit(law: str, tmp_path: Path) -> None:
    study = healing(law)
    alone = warpwear.run(study, out=tmp_path / "alone", plots=False)
    steps = alone.history["distance"].size

    class Killed(Exception):
        pass

    def kill(step: Any) -> None:
        if step.index == steps // 2:
            raise Killed

    with pytest.raises(Killed):
        warpwear.run(study, out=tmp_path / "killed", plots=False, callback=kill)
    resumed = warpwear.run(study, out=tmp_path / "killed", plots=False, resume=True)
    for name, values in alone.history.items():
        assert_array_equal(resumed.history[name], values, err_msg=name)
    for name, field in alone.snapshot(-1).fields.items():
        assert_array_equal(resumed.snapshot(-1).fields[name], field, err_msg=name)


def test_a_run_does_not_go_on_with_another_film(tmp_path: Path) -> None:
    study = healing("track")

    def stop(step: Any) -> None:
        if step.index == 3:
            raise StopIteration

    with pytest.raises(StopIteration):
        warpwear.run(study, out=tmp_path / "run", plots=False, callback=stop)
    for change in (
        {"friction.film.thickness": "20 nm"},
        {"friction.junction_growth": 10.0},
        {"friction.shear_strength": "150 MPa"},
    ):
        with pytest.raises(InputError, match=f"of another study \\({next(iter(change))}\\)"):
            warpwear.run(study.replace(change), out=tmp_path / "run", plots=False, resume=True)
    warpwear.run(study.replace({"friction.ploughing": 0.1}), out=tmp_path / "run", plots=False, resume=True)


def test_a_run_tells_of_its_film(tmp_path: Path) -> None:
    study = STUDIES["track"].replace(FILM | {"sliding.distance": "60 mm"})
    with warpwear.run(study, out=tmp_path / "run", plots=False) as result:
        summary = json.loads((tmp_path / "run" / "summary.json").read_text())
        figures = {*result.plot.names("essential")}
        for name in ("bare_map", "bare_fraction"):
            assert not faults_of(name, *drawn(result, name))
        bare = result.snapshot(-1).bare
        assert bare is not None
        assert set(np.unique(bare)) <= {0.0, 1.0}
        assert result.units["bare_fraction"] == "1"
        text = str(result)
    assert {"bare_map", "bare_fraction"} <= figures
    assert summary["hardness_MPa"] == pytest.approx(FILMED)
    assert summary["junction_growth"]["hardness_sheared_MPa"] == pytest.approx(BARE)
    assert summary["junction_growth"]["indentation_hardness_MPa"] == 590.0
    fit = summary["film"]["fit"]
    assert 0.0 < fit["plateau"] < 1.1
    assert 0.0 < fit["e_folding_mm"] < 60.0
    first, last = (f"{100.0 * summary['film']['bare_fraction'][when]:.2g} %" for when in ("first", "end"))
    assert f"film worn off {first} of the contact at first, {last} at the end" in text
    with warpwear.run(study.replace({"sliding.distance": "3 mm"})) as short:
        assert re.match(r"the course has \d places", short.summary["film"]["no_fit"])
        assert short.summary["film"]["fit"] is None


def test_a_film_without_growing_junctions_changes_friction_alone(device: str) -> None:
    film = STRENGTHS | {"friction.film.thickness": "10 nm"}
    one = history_of(STUDIES["track"], device=device)
    other = history_of(STUDIES["track"].replace(film), device=device)
    assert other["bare_fraction"].max() > 0.3
    strength = 40.0 + 132.0 * other["bare_fraction"]
    assert_allclose(other["cof"], strength * other["area_contact"] / 8.0, rtol=1e-13)
    for name in one.keys() - {"cof", "friction_energy", "evaluations"}:
        if device == "cpu":
            assert_array_equal(other[name], one[name], err_msg=name)
        else:
            assert_allclose(other[name], one[name], rtol=1e-9, atol=1e-12, err_msg=name)


def test_a_shear_beyond_what_the_softer_body_bears_is_told() -> None:
    growing = {"friction.shear_strength": "150 MPa", "friction.junction_growth": 9.0}
    harder = STUDIES["track"].replace({"disc.hardness": "400 MPa", "contact.hardness": "590 MPa"} | growing)
    with pytest.warns(warpwear.StudyWarning, match=r"150 MPa is more than .* bears, H/√α = 133 MPa"):
        warpwear.run(harder)
    with pytest.warns(warpwear.StudyWarning, match=r"150 MPa is more than .* bears, H/\(3√3\) = 77 MPa"):
        warpwear.run(harder.replace({"friction.junction_growth": 0.0}))


BAD: list[tuple[dict[str, Any], str]] = [
    ({"friction.film.thickness": "10 nm"}, r"friction\.film\.shear_strength"),
    (
        {"friction.film": {"thickness": "10 nm", "shear_strength": "40 MPa"}, "friction.coefficient": 0.5},
        r"friction\.coefficient = 0\.5 does not go with \[friction\.film\]",
    ),
    (
        {"friction.film": {"thickness": "10 nm", "shear_strength": "40 MPa"}, "friction.calibrate": "end"},
        r"friction\.calibrate = 'end' does not go with \[friction\.film\]",
    ),
    (
        FILM | {"friction.initial_ratio": 2.0, "friction.running_in": "3 mm"},
        r"friction\.initial_ratio = 2 does not go with \[friction\.film\]",
    ),
    (FILM | {"friction.area": "touched"}, r"friction\.area = 'touched' does not go with \[friction\.film\]"),
    (
        {"friction.shear_strength": "172 MPa", "friction.junction_growth": 9.0, "friction.area": "nominal"},
        r"friction\.area = 'nominal' does not go with friction\.junction_growth = 9",
    ),
    ({"friction.film.regrowth": "soon"} | FILM, r"friction\.film\.regrowth = 'soon'"),
    ({"friction.film.bodies": "ball"} | FILM, r"friction\.film\.bodies = 'ball'"),
    (
        FILM | {"friction.shear_strength": "200 MPa"},
        r"friction\.shear_strength = 200 MPa with friction\.junction_growth = 9 leaves cells of 590 MPa "
        r"hardness no pressure to bear: allowed are less than H/√α = 196\.7 MPa",
    ),
    (FILM | {"friction.film.shear_strength": "197 MPa"}, r"friction\.film\.shear_strength = 197 MPa with"),
    (FILM | {"contact.hardness": "inf MPa"}, r"needs a finite contact\.hardness"),
    (
        FILM | {"contact.load": "111 N"},
        r"\(109\.971 N, as friction\.junction_growth = 9 leaves 286\.1 MPa of it",
    ),
]


@pytest.mark.parametrize(("change", "sentence"), BAD)
def test_what_cannot_be_is_refused_in_a_sentence(change: dict[str, Any], sentence: str) -> None:
    study = STUDIES["track"]
    if "friction.coefficient" in change or "friction.calibrate" in change:
        given = study.model_dump(exclude_unset=True)
        given["friction"] = {name.split(".")[1]: value for name, value in change.items()}
        with pytest.raises(InputError, match=sentence):
            Study(**given)
        return
    with pytest.raises(InputError, match=sentence) as refused:
        study.replace(change)
    assert str(refused.value).count(". ") == 0


def test_what_only_some_models_cannot_be_is_refused() -> None:
    bearing = {"wear.law": "bearing-curve", "friction.shear_strength": "3 MPa"}
    bearing |= {"disc.synthetic": {"kind": "milled", "ra": "0.3 um"}, "stepping.scheme": "implicit"}
    with pytest.raises(InputError, match=r"does not go with wear\.law = 'bearing-curve'"):
        Study.load("v1").replace(bearing | {"friction.junction_growth": 9.0, "contact.hardness": "590 MPa"})
    with pytest.raises(InputError, match=r"patches\.coupling = 'load' does not go with \[friction\.film\]"):
        STUDIES["two scales"].replace(FILM | {"patches.coupling": "load"})
    unworn = STUDIES["track"].replace(FILM | {"wear.counter": "0 mm^3/N/m"})
    assert any("wear.counter = 0: the counter-body keeps its film" in notice for notice in unworn.notices())
