"""Every key of [wear] and [friction] in all that needs the laws.

It changes the result as in the run, or is refused in one sentence.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest

import warpwear
from warpwear import InputError, Result, Study
from warpwear.batches.run_one import RunRow, RunTask, run_one
from warpwear.calibration.bayes.data import Data, MeasuredValue
from warpwear.calibration.bayes.infer import _check_unknowns
from warpwear.calibration.bayes.model import ForwardModel
from warpwear.calibration.bayes.runs import make_runs, needs_runs
from warpwear.calibration.bayes.unknowns import Unknown, unknowns_of
from warpwear.calibration.energy import calibrate_energy
from warpwear.calibration.strength import calibrate_friction
from warpwear.laws import archard
from warpwear.laws.friction import FITTED, KEYS
from warpwear.page.content import words_of
from warpwear.results.track import course
from warpwear.study.keys import declarations, section_in
from warpwear.study.sections.friction import Friction
from warpwear.study.sections.wear import Wear

#: The smooth ball at rest on coarse cells, and a rough one: a run of them takes a moment.
SMOOTH = {
    "stepping.scheme": "implicit",
    "grid.cell": "20 um",
    "sliding.distance": "60 mm",
    "output.snapshots": [],
}
SMOOTH |= {"stepping.increment": "0.5 mm"}
ROUGH = {"grid.cell": "10 um", "sliding.distance": "6 mm", "output.snapshots": []}
EXPONENTIAL = {"wear.law": "exponential", "wear.decay": "0.02 1/mm"}
RUNNING_IN = {
    "wear.law": "running-in",
    "wear.running_in": "20 mm",
    "wear.initial_counter": "4e-3 mm^3/N/m",
    "wear.initial_disc": "4e-3 mm^3/N/m",
}
TRANSITION = {
    "wear.law": "transition",
    "wear.severe_counter": "8e-3 mm^3/N/m",
    "wear.severe_disc": "8e-3 mm^3/N/m",
    "wear.transition_pressure": "150 MPa",
    "wear.transition_width": "40 MPa",
}
PIECES = {"wear.particle": "60 um", "wear.particle_thickness": "0.2 um", "wear.pending_start": "uniform"}
RUNS_IN = {"friction.initial_ratio": 3.0, "friction.running_in": "20 mm"}
FILM = {
    "friction.shear_strength": "172 MPa",
    "friction.film.thickness": "60 nm",
    "friction.film.shear_strength": "40 MPa",
}


COULOMB = {"friction.law": "coulomb", "friction.coefficient": 0.6}
ENERGY = COULOMB | {
    "wear.law": "energy",
    "wear.counter": "1.5e-3 mm^3/J",
    "wear.disc": "2e-3 mm^3/J",
}
STATES = {
    "friction.law": "states",
    "friction.states.film": 0.15,
    "friction.states.slope": 1e-3,
    "friction.states.metal": 1.03,
    "friction.states.cover": 0.47,
    "friction.states.spread": 0.05,
    "friction.states.seed": 0.002,
    "friction.states.cover_rate": 0.1,
    "friction.states.per": "mm",
}
TRACK = {"sliding.kinematics": "swept", "sliding.stroke": "0.9 mm", "sliding.shift": 7, "grid.cell": "20 um"}
TRACK |= {"grid.extent": "0.62 mm", "counter.radius": "1 mm"}


@dataclass(frozen=True)
class Case:
    """A key has another value in a study that uses it.

    base: keys of that study; beside: keys that change too. refused: who refuses it -> part of the sentence.
    """

    value: Any
    base: dict[str, Any] = field(default_factory=dict)
    preset: str = "v1"
    beside: dict[str, Any] = field(default_factory=dict)
    refused: dict[str, str] = field(default_factory=dict)


TWO_STRENGTHS = {"calibrate friction": "which needs friction.shear_strength itself; allowed is"}
NOT_GIVEN = {"inference": "friction.shear_strength is neither given nor unknown"}
OF_ENERGY = {"calibrate friction": "wear.law = 'energy' needs friction.shear_strength, a pressure"}
CASES = {
    "wear.counter": Case("4e-4 mm^3/N/m"),
    "wear.disc": Case("4e-4 mm^3/N/m"),
    "wear.disc, energy": Case("4e-4 mm^3/J", ENERGY, refused=OF_ENERGY),
    "wear.law": Case("exponential", beside={"wear.decay": "0.02 1/mm"}),
    "wear.decay": Case("0.1 1/mm", EXPONENTIAL),
    "wear.running_in": Case("5 mm", RUNNING_IN),
    "wear.initial_counter": Case("1e-4 mm^3/N/m", RUNNING_IN),
    "wear.initial_disc": Case("1e-4 mm^3/N/m", RUNNING_IN),
    "wear.severe_counter": Case("2e-3 mm^3/N/m", TRANSITION),
    "wear.severe_disc": Case("2e-3 mm^3/N/m", TRANSITION),
    "wear.transition_pressure": Case("250 MPa", TRANSITION),
    "wear.transition_width": Case("90 MPa", TRANSITION),
    "wear.distance_factor": Case("radial"),
    "wear.particle": Case("100 um", PIECES, "v3-fine"),
    "wear.particle_thickness": Case("0.5 um", PIECES, "v3-fine"),
    "wear.dust_fraction": Case(0.5, PIECES, "v3-fine"),
    "wear.pending_start": Case("zero", PIECES, "v3-fine"),
    "wear.pending_seed": Case(3, PIECES, "v3-fine"),
    "friction.shear_strength": Case("5 MPa"),
    "friction.coefficient": Case(0.4, {"friction.coefficient": 0.6}, refused=NOT_GIVEN),
    "friction.coefficient, coulomb": Case(0.4, COULOMB, "v3-fine"),
    "friction.coefficient, energy": Case(0.4, ENERGY, refused=OF_ENERGY),
    "friction.law": Case("coulomb", {"friction.coefficient": 0.6}),
    "friction.calibrate": Case("initial", {"friction.coefficient": 0.6}, refused=NOT_GIVEN),
    "friction.ploughing": Case(0.1),
    "friction.initial_ratio": Case(1.5, RUNS_IN),
    "friction.running_in": Case("100 mm", RUNS_IN),
    "friction.area": Case("nominal", preset="v3-fine"),
    "friction.junction_growth": Case(
        9.0, {"friction.shear_strength": "172 MPa"}, "v3-fine", refused=TWO_STRENGTHS
    ),
    "friction.largest_coefficient": Case(
        0.2,
        {"friction.shear_strength": "172 MPa"},
        "v3-fine",
        refused=TWO_STRENGTHS | {"inference": "nor with friction.largest_coefficient"},
    ),
    "friction.film.thickness": Case("200 nm", FILM, "v3-fine", refused=TWO_STRENGTHS),
    "friction.film.shear_strength": Case("80 MPa", FILM, "v3-fine", refused=TWO_STRENGTHS),
    "friction.film.bodies": Case("disc", FILM, "v3-fine", refused=TWO_STRENGTHS),
    "friction.states.film": Case(0.2, STATES),
    "friction.states.slope": Case(0.003, STATES),
    "friction.states.metal": Case(0.9, STATES),
    "friction.states.cover": Case(0.4, STATES),
    "friction.states.spread": Case(0.08, STATES),
    "friction.states.seed": Case(0.004, STATES),
    "friction.states.cover_rate": Case(0.05, STATES),
    "friction.states.per": Case("lap", STATES, beside={"sliding.stroke": "1 mm"}),
    "friction.film.regrowth": Case("0.5 mm", FILM | TRACK, "v3-fine", refused=TWO_STRENGTHS),
}


def keys() -> list[str]:
    """Names of the keys of [wear] and [friction], from the study's model."""
    found = declarations(Wear, "wear.") | declarations(Friction, "friction.")
    return [key for key, declared in found.items() if section_in(declared.field.annotation) is None]


def test_every_key_has_a_case() -> None:
    assert {name.split(",")[0] for name in CASES} == {*keys()}
    numbers = {f"friction.{key}" for key in KEYS} | {f"wear.{key}" for key in archard.KEYS}
    assert numbers <= set(CASES), "a number of a law without a key"
    assert {*get_args(Wear.model_fields["law"].annotation)} == {*archard.WEAR_LAWS}, "a law without a value"


@dataclass(frozen=True)
class Pair:
    """A case's runs, before and after: studies, folders, histories and summaries."""

    key: str
    case: Case
    studies: tuple[Study, Study]
    folders: tuple[Path, Path]
    results: tuple[Result, Result]


@pytest.fixture(scope="module")
def run_of(tmp_path_factory: pytest.TempPathFactory) -> Callable[[Study], Path]:
    """Make the run of a study once."""
    folder, made = tmp_path_factory.mktemp("runs"), dict[str, Path]()

    def make(study: Study) -> Path:
        text = study.to_toml()
        if text not in made:
            made[text] = folder / f"run-{len(made)}"
            warpwear.run(study, out=made[text], plots=False, device="cpu").close()
        return made[text]

    return make


@pytest.fixture(params=CASES, scope="module")
def pair(request: pytest.FixtureRequest, run_of: Callable[[Study], Path]) -> Any:
    """The runs of a case, open."""
    key, case = request.param.split(",")[0], CASES[request.param]
    first = Study.load(case.preset).replace((SMOOTH if case.preset == "v1" else ROUGH) | case.base)
    studies = first, first.replace({key: case.value, **case.beside})
    folders = tuple(map(run_of, studies))
    with Result.open(folders[0]) as before, Result.open(folders[1]) as after:
        yield Pair(key, case, studies, folders, (before, after))


def refusal(pair: Pair, consumer: str, call: Callable[[], Any]) -> bool:
    """Tell whether the case is refused here, as it is declared; with one sentence that names the key."""
    if consumer not in pair.case.refused:
        return False
    with pytest.raises(InputError, match=pair.case.refused[consumer]) as error:
        call()
    assert "\n" not in str(error.value)
    return True


@pytest.fixture(scope="module")
def said_of() -> Callable[[Study, Path, Result], tuple[dict[str, Any], RunRow]]:
    """Tell what a page and LaTeX say of a run, and its row in a sweep; once, for cases begin alike."""
    said: dict[Path, tuple[dict[str, Any], RunRow]] = {}

    def say(study: Study, folder: Path, run: Result) -> tuple[dict[str, Any], RunRow]:
        if folder not in said:
            row = run_one(RunTask(study.to_toml(), str(folder), "cpu"))
            said[folder] = words_of(run), row
        return said[folder]

    return say


def test_a_key_changes_the_run_and_what_is_said_of_it(
    pair: Pair, said_of: Callable[[Study, Path, Result], tuple[dict[str, Any], RunRow]]
) -> None:
    """Run, page, LaTeX, row of a sweep and comparison."""
    before, after = (result.history for result in pair.results)
    same = len(before["cof"]) == len(after["cof"])
    assert not same or any(not np.array_equal(before[name], after[name]) for name in before)
    words, rows = zip(*map(said_of, pair.studies, pair.folders, pair.results), strict=True)
    for part in ("methods", "latex", "summary", "table"):
        if (part, pair.key) == ("table", "friction.law"):  # both end at the coefficient that is given
            continue
        if part != "methods" or pair.key.removeprefix("friction.") in KEYS:
            assert words[0][part] != words[1][part], part
    assert rows[0].ends != rows[1].ends
    for row, study in zip(rows, pair.studies, strict=True):
        strength = row.ends["shear_strength [MPa]"]
        assert math.isfinite(strength) == (study.friction.law == "shear-strength")
    notes = "\n".join(warpwear.compare(*pair.folders).notes)
    assert f"{pair.key} (" in notes.partition("the runs differ in ")[2]


def constant_of(study: Study) -> tuple[Unknown, ...]:
    """The constant of a study's law of friction as the only unknown."""
    return tuple(unknowns_of(study, {f"friction.{study.friction.law_with().constant}": "uniform 0 .. 0.5"}))


@pytest.fixture(scope="module")
def model_of(tmp_path_factory: pytest.TempPathFactory) -> Callable[[Study], ForwardModel]:
    """Make the model of a study once, for many cases begin with the same."""
    models: dict[str, ForwardModel] = {}

    def make(study: Study) -> ForwardModel:
        text = study.to_toml()
        if text not in models:
            out, unknowns = tmp_path_factory.mktemp("model"), constant_of(study)
            runs = make_runs(study, unknowns, samples=None, seed=0, out=out, device="cpu")
            models[text] = ForwardModel(study, unknowns, runs)
        return models[text]

    return make


def test_a_key_changes_an_inference_as_it_changes_the_run(
    pair: Pair, model_of: Callable[[Study], ForwardModel]
) -> None:
    """A model of the changed study computes what its run came to."""
    study, history = pair.studies[1], pair.results[1].history
    distance, cof = course(pair.results[1], "cof")  # along a track the means of its passes
    like = Data(points=(MeasuredValue("friction", 0.6, 0.02, study.sliding.total),))
    asked = constant_of(study)
    if refusal(pair, "inference", lambda: _check_unknowns(study, asked, like)):
        return
    places = np.linspace(0, distance.size - 1, 5).astype(int)[1:]
    computed = []
    for one in pair.studies:
        model, constant = model_of(one), one.friction.law_with().constant
        values = {f"friction.{constant}": np.array([one.friction.law_with().values[constant]])}
        volumes = [model.value(values, f"volume_{body}")[0][0] for body in ("counter", "disc")]
        computed.append(np.array([*model.cof(values, distance[places])[0], *volumes]))
    volumes = [history[f"wear_volume_{body}"][-1] for body in ("counter", "disc")]
    np.testing.assert_allclose(computed[1], [*cof[places], *volumes], rtol=0.06)
    assert not np.array_equal(*computed)


def test_a_key_is_no_unknown_that_nothing_follows_from(pair: Pair, tmp_path: Path) -> None:
    """It needs runs of its own, or moves what is computed, or is refused."""
    study = pair.studies[0]
    sentence = ""
    try:
        unknown = unknowns_of(study, {pair.key: None})[0]
        _check_unknowns(study, [unknown], Data())
    except InputError as error:
        sentence = str(error)
    if sentence:
        assert pair.key in sentence
        return
    if needs_runs(study, pair.key, scaled=True):
        assert pair.key.removeprefix("friction.") not in FITTED or study.friction.law == "coulomb"
        return
    runs = make_runs(study, (unknown,), samples=8, seed=0, out=tmp_path, device="cpu")
    model = ForwardModel(study, (unknown,), runs)
    values = {pair.key: unknown.values(np.array([-1.0, 1.0]))}
    cof = model.cof(values | {"friction.shear_strength": np.array([4.0, 4.0])} | values, np.array([3.0, 5.0]))
    if study.friction.law == "coulomb" and pair.key.startswith("wear."):
        cof = model.value(values, "volume_disc")[0]
    assert np.abs(cof[1] - cof[0]).min() > 1e-6


def test_a_key_changes_a_calibration_as_it_changes_the_run(pair: Pair) -> None:
    """The strength that is told makes the run's friction what was measured; energies follow the run."""
    study, history, laps = pair.studies[1], pair.results[1].history, pair.studies[1].laps
    energies = [calibrate_energy(result=f).energy for f in pair.folders]
    of_distance = study.friction.law != "shear-strength"  # the energy says nothing of wear
    same = of_distance and pair.key.startswith("wear.")
    assert (energies[0] == energies[1]) == same
    how = {"result": pair.folders[1], "cof": 0.7}
    if refusal(pair, "calibrate friction", lambda: calibrate_friction(**how)):
        return
    area = study.friction.area
    told = calibrate_friction(**how).numbers["areas"][area]
    for when, place in (("initial", 0), ("end", -1)):
        strength = f"{told[f'shear_strength_{when}_MPa']!r} MPa"
        keys = {"friction.law": "shear-strength", "friction.shear_strength": strength}
        law = study.replace(keys).friction.law_with()
        cof = law.coefficient(history, load=study.contact.load, finished=True, laps=laps)
        assert math.isclose(cof[place], 0.7, rel_tol=1e-5), when
