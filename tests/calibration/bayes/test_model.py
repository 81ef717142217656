"""What an inference computes by: one run and its scaling, areas of whole cells, emulators of many runs."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cases_inference import smooth_study, worn_paraboloid

import warpwear
from warpwear import InputError, Study
from warpwear.batches.run_one import RunRow
from warpwear.calibration.bayes.data import Data
from warpwear.calibration.bayes.emulator import Emulator
from warpwear.calibration.bayes.likelihood import Posterior
from warpwear.calibration.bayes.model import ForwardModel
from warpwear.calibration.bayes.runs import Runs, scales
from warpwear.calibration.bayes.unknowns import unknowns_of
from warpwear.laws.archard import WearLaw
from warpwear.laws.friction import FRICTION_LAWS, FrictionLaw
from warpwear.study.pair import Pair

pytest.importorskip("emcee")


def test_areas_of_whole_cells_carry_their_scatter() -> None:
    """Steps of whole cells are smoothed, and the error that is told is that of a finer grid's area."""
    study = smooth_study()
    exact = worn_paraboloid(study)
    distance = np.linspace(0.3, study.sliding.total, 8000)
    first = exact.rows[0].courses
    area = np.exp(np.interp(np.log(distance), np.log(first["distance"]), np.log(first["area_contact"])))
    x = np.arange(-60, 61) * 0.02
    cells = np.sort(np.add.outer(x**2, x**2).ravel())
    counted = 0.02**2 * np.searchsorted(cells, area / np.pi)
    courses = {"distance": distance, "area_contact": counted, "patch_along": area, "patch_across": area}
    runs = replace(exact, rows=(RunRow("done", courses=courses),))
    places, smooth, scatter = runs.smooth("area_contact")
    late = places > 200.0
    wanted = np.interp(places, distance, area)
    off = np.log(smooth[0] / wanted)[late]
    raw = np.log(np.interp(places, distance, counted) / wanted)[late]
    assert np.sqrt(np.mean(off**2)) < 0.7 * np.sqrt(np.mean(raw**2))
    assert scatter[late].mean() == pytest.approx(np.sqrt(np.mean(raw**2)), rel=0.25)
    asked: dict[str, str | None] = {"friction.shear_strength": "normal 3 +- 0.3 MPa"}
    made = ForwardModel(study, tuple(unknowns_of(study, asked)), runs)
    assert not Posterior(made, (), Data()).linear  # the strength decides how uncertain friction is


@dataclass(frozen=True)
class SilentLaw(WearLaw):
    """Archard's, in a class of its own, which may do more."""


class SilentFriction(FrictionLaw):
    """The shear strength's, likewise."""


@dataclass(frozen=True)
class SilentFilm:
    """Is no class of `Scales` at all."""


def test_a_law_that_says_nothing_does_not_scale(monkeypatch: pytest.MonkeyPatch) -> None:
    study = smooth_study()
    assert scales(study)
    task = study.contact_task
    assert not replace(task, wear=(task.wear[0], SilentLaw(1e-9))).scales
    assert not replace(task, film=SilentFilm()).scales  # type: ignore[arg-type]
    for where, name in ((Pair, "wear_laws"), (Study, "contact_task")):
        with monkeypatch.context() as patch:
            silent: Any = (SilentLaw(1e-9), SilentLaw(1e-9))
            value = silent if name == "wear_laws" else replace(task, wear=silent)
            patch.setattr(where, name, property(lambda _, value=value: value))
            assert not scales(study.model_copy())  # nothing of which is made yet
    monkeypatch.setitem(FRICTION_LAWS, "shear-strength", SilentFriction)
    assert not scales(study)


FLAT = {"disc.synthetic.kind": "flat"}


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"wear.law": "exponential", "wear.decay": "0.01 1/mm"}, True),
        ({"wear.law": "running-in", "wear.running_in": "1 mm", "wear.initial_disc": "3e-3 mm^3/N/m"}, True),
        ({"friction.initial_ratio": 2.0, "friction.running_in": "1 mm"}, True),
        ({"friction.law": "coulomb", "friction.coefficient": 0.3}, True),
        (
            {"wear.law": "bearing-curve", "disc.synthetic.kind": "self-affine", "disc.synthetic.ra": "1 um"},
            False,
        ),
        ({"wear.distance_factor": "radial"}, False),
        ({"friction.area": "cumulative"}, False),
        ({"friction.film.thickness": "20 nm", "friction.film.shear_strength": "1 MPa"}, False),
        ({"stepping.scheme": "explicit", "stepping.force": True}, False),
        ({"study.model": "micro", "sliding.kinematics": "swept", "sliding.stroke": "1 mm"} | FLAT, False),
    ],
)
def test_what_one_run_can_serve(changes: dict[str, Any], expected: bool) -> None:
    assert scales(smooth_study().replace(changes)) is expected


def test_a_course_without_scatter_has_none() -> None:
    """Running sums of zeros behind large numbers leave rounding, of either sign: no number may come of it."""
    distance = np.linspace(1.0, 1000.0, 1000)
    area = np.exp(np.where(distance < 100.0, np.sin(9.0 * distance), 0.0))
    rows = (RunRow("done", courses={"distance": distance, "area_contact": area}),)
    scatter = replace(worn_paraboloid(smooth_study()), rows=rows).smooth("area_contact")[2]
    assert np.all(scatter >= 0.0)
    assert scatter[-1] < 1e-6 < scatter[0]


def test_one_run_serves_all_wear_coefficients(tmp_path: Path) -> None:
    """Area, scar and volumes of a run at other wear coefficients are those of the scaled run."""
    study = smooth_study(**{"sliding.distance": "300 mm"})
    assert scales(study)
    like = [{"scar": "0.72 +- 0.02 mm", "friction": "0.2 +- 0.02"}]
    asked = {
        "wear.counter": "log-uniform 2e-4 .. 9.4e-4 mm^3/N/m",
        "friction.shear_strength": "normal 4 +- 0.4 MPa",
    }
    found = warpwear.infer(study, unknown=asked, tests=like, out=tmp_path / "found")
    model = found.posterior.model
    assert len(model.runs.rows) == 1
    other = study.replace({"wear.counter": "3e-4 mm^3/N/m"})
    with warpwear.run(other, device="cpu") as result:
        one = {"wear.counter": np.array([3e-4]), "friction.shear_strength": np.array([3.83])}
        history = result.history
        some = history["distance"] > 100.0  # before, an area of whole cells of 20 µm is too coarse a stair
        expected = 3.83 * history["area_contact"][some] / 8.0
        np.testing.assert_allclose(model.cof(one, history["distance"][some])[0], expected, rtol=0.05)
        assert model.cof(one, history["distance"][-1:])[0, 0] == pytest.approx(expected[-1], rel=0.03)
        scar = 0.5 * (history["patch_along"][-1] + history["patch_across"][-1])
        assert model.value(one, "scar")[0][0] == pytest.approx(scar, abs=0.02)
        assert model.value(one, "volume_counter")[0][0] == pytest.approx(
            history["wear_volume_counter"][-1], rel=1e-9
        )
    page = (tmp_path / "found" / "inference.html").read_text(encoding="utf-8")
    assert "unknowns after the test" in page
    assert "https://" not in page


def test_an_emulator_interpolates_and_knows_how_well() -> None:
    """A smooth function of two inputs, predicted from 32 places; its errors are as large as it says."""
    random = np.random.default_rng(0)
    places = random.uniform(-1.7, 1.7, (32, 2))
    x = np.linspace(0.1, 1.0, 20)

    def course(at: np.ndarray) -> np.ndarray:
        return np.exp(0.4 * at[:, :1] + 0.2 * np.sin(1.5 * at[:, 1:]) * x) * x

    emulator = Emulator(places, course(places))
    assert emulator.logarithmic
    assert emulator.error < 0.01
    new = random.uniform(-1.5, 1.5, (200, 2))
    weights, variances = emulator.weights(new)
    off = np.log(course(new)) - emulator.mean - weights @ emulator.shapes
    assert np.sqrt(np.mean(off**2)) < 0.01
    sizes = np.sqrt(np.maximum(variances @ emulator.shapes**2, 1e-20))
    assert 0.2 < np.sqrt(np.mean((off / sizes) ** 2)) < 2.0


def test_an_emulator_that_is_off_is_refused() -> None:
    """Values that do not follow from the inputs cannot be predicted from each other."""
    study = smooth_study()
    asked = unknowns_of(study, {"contact.hardness": "uniform 300 .. 900 MPa"})
    random = np.random.default_rng(1)
    distance = np.geomspace(1.0, 2400.0, 50)
    rows = tuple(
        RunRow(
            "done",
            courses={
                "distance": distance,
                "area_contact": np.full(50, float(np.exp(random.standard_normal()))),
            },
        )
        for _ in range(16)
    )
    runs = Runs(study, tuple(asked), random.standard_normal((16, 1)), rows, True)
    with pytest.raises(InputError, match="the emulator of the area is off by"):
        ForwardModel(study, tuple(asked), runs)


def test_what_a_surface_adds_to_two_courses_is_shared() -> None:
    """Of courses that both scatter by 8 % with the surface their sum does, and not by 8 %/√2."""
    at, middle = np.linspace(0.0, 1.0, 30), np.zeros((1, 1))
    found = []
    for seed in range(20):
        places = np.linspace(-1.7, 1.7, 32)[:, None]
        surface = np.random.default_rng(seed).normal(0.0, 0.08, (32, 1))
        rising, falling = 0.2 * places + 0.3 * at + surface, -0.3 * places * at + surface
        errors, total = np.zeros((1, 30)), np.zeros(30)
        for part in Emulator.together(places, [np.exp(rising), np.exp(falling)]):
            weights, variances = part.weights(middle)
            course = np.exp(part.mean + weights[0] @ part.shapes)
            errors = errors + np.sqrt(variances[0])[:, None] * part.shapes * course
            total += course
        found.append(float(np.mean(np.sqrt((errors**2).sum(axis=0)) / total)))
    assert np.mean(found) == pytest.approx(0.08, rel=0.1)
