"""What data and priors are made into: repeats, thinned courses, quantiles."""

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from cases_inference import course_like, posterior_of, smooth_study
from click.testing import CliRunner

from warpwear import InputError, Study
from warpwear.batches.batch import LOG
from warpwear.calibration.bayes.command import telling
from warpwear.calibration.bayes.data import Data, MeasuredValue, data_of
from warpwear.calibration.bayes.infer import check_priors
from warpwear.calibration.bayes.unknowns import unknowns_of
from warpwear.cli.main import commands
from warpwear.measured.experiment import Experiment


def test_repeats_that_scatter_widen_their_uncertainty() -> None:
    data = data_of(smooth_study(), [{"volume_disc": f"{v} +- 0.001 mm^3"} for v in (0.020, 0.028)])
    assert [value.error for value in data.values] == pytest.approx([0.001 * 32**0.5] * 2)
    assert "scatter 5.7 times as much" in data.notes[0]


def test_what_a_test_may_give_beside_values(tmp_path: Path) -> None:
    """A profile across the track, as the volume of its length; the mean of two diameters, with its error."""
    place = np.arange(0.0, 3.0, 0.0005)
    rough = 1e-2 * np.random.default_rng(7).normal(size=place.size)
    heights = rough - np.clip(2.0 * (1.0 - ((place - 1.5) / 0.11) ** 2), 0.0, None)
    path = tmp_path / "across.csv"
    table = np.column_stack([place, heights])
    np.savetxt(path, table, delimiter=";", header="x [mm];z [um]", comments="")
    test = {"profile": path, "track_length": "30 mm", "scar": ["0.80 mm", "0.84 mm"], "radius": "3 mm"}
    volume, scar = data_of(smooth_study(), [test | {"load": "8.1 N"}]).values
    assert (volume.kind, scar.kind) == ("volume_disc", "scar")
    assert volume.value == pytest.approx(30.0 * 2.0 / 3.0 * 2e-3 * 0.22, rel=5e-3)
    assert 0.0 < volume.error < 0.02 * volume.value
    assert (scar.value, scar.error) == pytest.approx((0.82, 0.02))


def test_a_course_is_thinned_by_means() -> None:
    distance = np.linspace(1.0, 2400.0, 5000)
    data = data_of(smooth_study(), [{"record": Experiment("long", distance, 0.3 + 1e-4 * distance)}])
    (course,) = data.courses
    assert course.distance.size == 100
    np.testing.assert_allclose(course.cof, 0.3 + 1e-4 * course.distance)


def test_a_record_of_times_is_read_by_the_frequency_of_its_study(tmp_path: Path) -> None:
    """A study says how fast it slides by a speed, or by a frequency of its strokes."""
    path = tmp_path / "times.csv"
    rows = "".join(f"{t},{0.3 + 1e-4 * t}\n" for t in range(400))
    path.write_text("Time [s],COF\n" + rows)
    study = Study.load("track").replace({"sliding.stroke": "30 mm", "sliding.distance": "2400 mm"})
    spoken = (
        study.replace({"sliding.speed": "6 mm/s"}),
        study.replace({"sliding.speed": None, "sliding.frequency": "0.1 Hz"}),
    )
    one, other = (data_of(each, [{"record": path}]).courses[0] for each in spoken)
    np.testing.assert_allclose(one.distance, other.distance)


def test_priors_have_their_quantiles() -> None:
    """z of an unknown is standard normal before the data, and `normal` is its inverse."""
    asked = {
        "wear.counter": "log-normal 9e-4 +- 2e-4 mm^3/N/m",
        "wear.disc": "log-uniform 1e-4 .. 1e-3 mm^3/N/m",
        "friction.ploughing": "normal 0.02 +- 0.02",
        "friction.shear_strength": "uniform 1 .. 5 MPa",
    }
    unknowns = unknowns_of(smooth_study(), asked)
    z = np.random.default_rng(0).standard_normal(200_000)
    first = unknowns[0].values(z)
    assert first.mean() == pytest.approx(9e-4, rel=0.01)
    assert first.std() == pytest.approx(2e-4, rel=0.02)
    cut = unknowns[2]
    assert not cut.is_normal
    assert cut.values(z).min() >= 0.0
    for unknown in unknowns:
        np.testing.assert_allclose(unknown.normal(unknown.values(z[:1000])), z[:1000], atol=1e-6)


def test_priors_that_exclude_the_data_are_refused() -> None:
    data = Data(values=(MeasuredValue("volume_counter", 0.18, 0.01),))
    posterior = posterior_of(smooth_study(), {"wear.counter": "uniform 8e-4 .. 1e-3 mm^3/N/m"}, data)
    with pytest.raises(
        InputError,
        match=r"the priors exclude the data: .* 0\.0154 to 0\.0192 mm³, and measured is worn volume",
    ):
        check_priors(posterior, seed=0)
    course = Data((replace(course_like(smooth_study()), cof=np.full(40, 1.8)),))
    posterior = posterior_of(smooth_study(), {"friction.shear_strength": "uniform 2 .. 3 MPa"}, course)
    with pytest.raises(InputError, match="the priors exclude the data"):
        check_priors(posterior, seed=0)


def test_a_shear_strength_of_a_coefficient_has_a_prior_by_itself() -> None:
    """From what all of the field would need to five times that of the hardness."""
    study = smooth_study().replace(
        {"friction.coefficient": 0.6, "friction.shear_strength": None, "contact.hardness": "590 MPa"}
    )
    assert study.friction.shear_strength is None
    (unknown,) = unknowns_of(study, {"friction.shear_strength": None})
    assert unknown.assumed
    assert unknown.prior.first == pytest.approx(0.6 * 8.0 / math.prod(study.grid.sides), rel=0.01)
    assert unknown.prior.second == pytest.approx(5.0 * 590.0 / 27.0**0.5, rel=0.01)


def test_an_inference_says_how_far_it_is_and_goes_on(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted() -> None:
        with telling(tmp_path):
            LOG.info("1 of 32 runs, the last done; 2 s gone, about 62 s left")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert capsys.readouterr().err.splitlines() == [
        "1 of 32 runs, the last done; 2 s gone, about 62 s left",
        "the same command goes on from here",
    ]


def test_a_section_of_a_rotating_disc_goes_around_its_circle() -> None:
    study = Study.load("track").replace({"sliding.stroke": None, "sliding.track_radius": "3 mm"})
    (value,) = data_of(study, [{"section": "812 +- 30 um^2"}]).values
    assert (value.kind, value.value) == ("section", pytest.approx(812e-6))


def test_a_coefficient_without_a_unit_has_a_prior_about_its_k() -> None:
    study = smooth_study(**{"wear.counter": 9.4e-4, "contact.hardness": "590 MPa"})
    (unknown,) = unknowns_of(study, {"wear.counter": None})
    middle = float(unknown.values(np.zeros(1))[0])
    assert middle == pytest.approx(1e3 * 9.4e-4 / 590.0)


@pytest.mark.parametrize(
    ("unknown", "many"), [("wear.disc", "1 run"), ("contact.load=normal 8 +- 0.5 N", "16 runs")]
)
def test_a_dry_run_says_what_an_inference_costs(unknown: str, many: str, tmp_path: Path) -> None:
    """Nothing is written, and no more than the first run is made."""
    coarse = ["--set", "stepping.scheme=implicit", "--set", "grid.cell=100 um"]
    measured = ["--unknown", unknown, "--volume-disc", "0.0244 +- 0.002 mm^3", "--out", str(tmp_path / "out")]
    done = CliRunner().invoke(commands, ["calibrate", "bayes", "v1", *coarse, *measured, "--dry-run"])
    assert done.exit_code == 0, done.exception
    assert re.match(rf"{many}: about [\d.]+ (s|min) on \d+ workers?", done.output), done.output
    assert not list(tmp_path.iterdir())
