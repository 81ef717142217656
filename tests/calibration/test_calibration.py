"""Wear coefficients, shear strength and energy against closed forms and numerical integration."""

import math

import numpy as np
import pytest
from scipy import integrate

import warpwear
from warpwear.calibration.coefficient import WearCalibration
from warpwear.calibration.energy import EnergyCalibration
from warpwear.calibration.friction import fit_friction
from warpwear.calibration.measurements import Value
from warpwear.calibration.wear import (
    cap,
    circular_track,
    groove,
    segment,
    volume_given,
)
from warpwear.errors import InputError
from warpwear.laws.friction import friction_energy
from warpwear.results.report import record, scientific


def wear_coefficient(volumes, *, load, distance, **more):
    """K of tests alike."""
    work = {"loads": (Value(load),) * len(volumes), "distances": (Value(distance),) * len(volumes)}
    return WearCalibration(volumes=tuple(volumes), **work, **more)


def k_of(*volumes, **more):
    """K in mm³/(N·m) of the reference test."""
    return 1e3 * wear_coefficient(list(volumes), load=8.0, distance=2400.0, **more).mean


@pytest.mark.parametrize("diameter", [0.01, 0.8, 2.1, 5.0, 6.0])
def test_cap_is_the_volume_beyond_a_plane(diameter):
    found = cap(diameter, radius=3.0)
    plane = math.sqrt(9.0 - 0.25 * diameter**2)
    # of thin shells around the axis: height of the counter-body over the plane
    volume = integrate.quad(
        lambda r: 2 * math.pi * r * (9.0 - r * r - plane**2) / (math.sqrt(9.0 - r * r) + plane),
        0.0,
        diameter / 2,
        epsrel=1e-11,
    )[0]
    assert found.volume == pytest.approx(volume, rel=1e-8)
    assert found.depth == pytest.approx(3.0 - plane, rel=1e-6)
    # as ASTM G99 writes it
    assert found.volume == pytest.approx(
        math.pi * found.depth / 6 * (0.75 * diameter**2 + found.depth**2), rel=1e-12
    )


@pytest.mark.parametrize("width", [0.02, 0.5, 2.4, 5.9])
def test_circular_track_is_the_section_below_a_plane_times_its_circle(width):
    found = circular_track(width, radius=3.0, track_radius=10.0)
    plane = math.sqrt(9.0 - 0.25 * width**2)
    section = integrate.quad(
        lambda y: (0.25 * width**2 - y * y) / (math.sqrt(9.0 - y * y) + plane),
        -width / 2,
        width / 2,
        epsrel=1e-11,
    )[0]
    assert found.volume == pytest.approx(2 * math.pi * 10.0 * section, rel=1e-8)
    assert found.depth == pytest.approx(3.0 - plane, rel=1e-5)


def test_segment_keeps_its_digits_where_it_is_small():
    # 40 digits of φ − sin φ by its series
    for width in (1e-6, 0.01, 0.0599, 0.0601):
        angle = 2 * math.asin(width / 6.0)
        series = math.fsum(
            (-1) ** (n + 1) * angle ** (2 * n + 1) / math.factorial(2 * n + 1) for n in range(1, 8)
        )
        assert segment(width, radius=3.0) == pytest.approx(4.5 * series, rel=1e-11)


def test_the_approximations_are_as_good_as_astm_g99_says():
    """Within 1 % for d/r below 0.3, and within 5 % for 0.7 (pin) and 0.8 (disc)."""
    for ratio, worst in ((0.3, 0.01), (0.7, 0.05)):
        found = cap(3.0 * ratio, radius=3.0)
        assert worst / 5 < 1 - found.approximate / found.volume < worst
    for ratio, worst in ((0.3, 0.01), (0.8, 0.055)):
        found = circular_track(3.0 * ratio, radius=3.0, track_radius=10.0)
        assert worst / 5 < 1 - found.approximate / found.volume < worst


def test_uncertainty_is_the_slope_of_the_volume():
    step = 1e-6
    for make, width in (
        (lambda d, **more: cap(d, radius=3.0, **more), 2.1),
        (lambda d, **more: circular_track(d, radius=3.0, track_radius=10.0, **more), 2.1),
        (lambda d, **more: groove(d, track_length=30.0, **more), 8e-4),
    ):
        slope = (make(width + step).volume - make(width - step).volume) / (2 * step)
        assert make(width, error=0.01).error == pytest.approx(0.01 * slope, rel=1e-6)
    small = cap(0.8, radius=3.0, error=0.01)
    assert small.error / small.volume == pytest.approx(4 * 0.01 / 0.8, rel=0.02)  # the fourth power


def test_uncertainty_of_two_diagonals_is_the_standard_error_of_their_mean():
    both = (0.80, 0.82)
    error = np.std(both, ddof=1) / math.sqrt(2)
    found = cap(*both, radius=3.0)
    assert found.error == pytest.approx(cap(np.mean(both), radius=3.0, error=error).error)
    assert found.error_from == "half the difference of the two diameters"
    assert cap(0.8, 0.8, radius=3.0).error is None
    assert cap(0.8, radius=3.0).error_from == "unknown"
    assert cap(*both, radius=3.0, error=0.0).error == 0.0


def test_units_and_replicates():
    found = wear_coefficient(
        [volume_given(v) for v in (0.016, 0.018, 0.023)], load=8.0, distance=2400.0, hardness=590.0
    )
    values = np.array([0.016, 0.018, 0.023]) / 19.2  # mm³/(N·m)
    assert 1e3 * found.mean == pytest.approx(values.mean())
    assert 1e3 * found.deviation == pytest.approx(values.std(ddof=1))
    assert 1e3 * found.uncertainty == pytest.approx(values.std(ddof=1) / math.sqrt(3))
    # SI: V [m³] = K [1/Pa] F [N] L [m]; dimensionless: V = k F L/H
    assert 1e-6 * found.mean * 8.0 * 2.4 == pytest.approx(0.019e-9)
    assert found.dimensionless * 8.0 * 2400.0 / 590.0 == pytest.approx(0.019)
    single = wear_coefficient([volume_given(0.018, error=0.001)], load=8.0, distance=2400.0)
    assert single.deviation is None
    assert 1e3 * single.uncertainty == pytest.approx(0.001 / 19.2)
    assert wear_coefficient([volume_given(0.018)], load=8.0, distance=2400.0).uncertainty is None


def test_profiles_of_one_track_are_one_test():
    """Entries of one name are places: their mean counts once, with the scatter between them."""
    sections = {"a": [160.0, 176.0, 144.0], "b": [200.0]}
    tests = [{"name": n, "section": f"{a} um^2"} for n, areas in sections.items() for a in areas]
    found = warpwear.calibrate_wear(tests, load="8 N", distance="100 m", track_length="30 mm")
    assert found.values == pytest.approx([a * 1e-6 * 30.0 / 8e5 for a in (160.0, 200.0)], rel=1e-12)
    assert found.errors[0] == pytest.approx(16e-6 / math.sqrt(3.0) * 30.0 / 8e5, rel=1e-12)
    assert "standard deviation of 2 tests" in str(found)


def test_a_study_takes_a_calibration_with_its_unit():
    found = warpwear.calibrate_wear([{"volume": "0.019 mm^3"}], load="8 N", distance="2400 mm")
    fine = warpwear.Study.load("v3-fine").replace({"grid.cell": "20 um", "sliding.distance": "0.1 mm"})
    taken = fine.replace({"wear.disc": found})
    assert taken.wear_coefficients[1] == pytest.approx(found.mean, rel=1e-14)
    assert taken == fine.replace(wear={"disc": found}) == fine.replace({"wear.disc": found.in_study})
    bare = fine.replace({"wear.disc": found.mean, "output.snapshots": []})
    with pytest.warns(warpwear.StudyWarning, match="A K has one"):
        text = str(warpwear.run(bare))
    assert f"wear.disc = {found.mean:g}: taken as k of V = k F L / H, not as K" in text


def test_the_numbers_of_the_thesis():
    assert k_of(volume_given(0.01805)) == pytest.approx(9.4e-4, abs=0.05e-4)
    assert k_of(volume_given(0.02438)) == pytest.approx(12.7e-4, abs=0.05e-4)
    assert k_of(groove(812.8e-6, track_length=30.0)) == pytest.approx(12.7e-4, rel=1e-12)
    assert k_of(cap(0.8, radius=3.0)) == pytest.approx(3.5e-4, abs=0.05e-4)


@pytest.mark.parametrize(
    "call",
    [
        lambda: cap(6.1, radius=3.0),
        lambda: cap(math.nan, radius=3.0),
        lambda: cap(6.0, radius=3.0, error=0.1),
        lambda: cap(0.8, radius=math.inf),
        lambda: wear_coefficient([cap(1e-9, radius=3.0)], load=8.0, distance=1.0),
        lambda: circular_track(6.0, radius=3.0, track_radius=10.0),
        lambda: circular_track(1.0, radius=3.0, track_radius=0.4),
        lambda: wear_coefficient([volume_given(1.0)], load=8.0, distance=math.nan),
        lambda: wear_coefficient([volume_given(1e300)], load=1e-300, distance=1e-10),
    ],
)
def test_what_makes_no_wear_coefficient_is_refused(call):
    with pytest.raises(InputError):
        call()


RUN = np.linspace(1.0, 2400.0, 600)
AREA = 0.0256 * np.sqrt(RUN)
WHERE = np.linspace(10.0, 2390.0, 500)


def curve(tau=3.0, ploughing=0.15, noise=0.0, seed=0):
    scatter = noise * np.random.default_rng(seed).standard_normal(WHERE.size)
    return ploughing + tau * np.interp(WHERE, RUN, AREA) / 8.0 + scatter


def fitted(cof, where=WHERE, area=AREA):
    return fit_friction(where, cof, run_distance=RUN, run_area=area, load=8.0)


def test_an_exact_curve_gives_its_parameters_back():
    found = fitted(curve())
    assert found.shear_strength == pytest.approx(3.0, rel=1e-10)
    assert found.ploughing == pytest.approx(0.15, rel=1e-10)
    assert found.rms < 1e-12
    assert found.r_squared == pytest.approx(1.0)
    assert (found.points, found.left_out, found.first, found.last) == (500, 0, 10.0, 2390.0)
    assert found.doubts == ()


def test_a_groove_is_as_long_as_its_circle():
    """A section, and a length of 2πR."""
    test = {"section": "812.8 um^2", "load": "8 N", "distance": "2400 mm"}
    by_radius = warpwear.calibrate_wear([test | {"track_radius": "3 mm"}])
    assert by_radius.volumes[0].volume == pytest.approx(812.8e-6 * 6.0 * math.pi)
    with pytest.raises(InputError, match=r"needs test\.1\.track_length, .* or track_radius"):
        warpwear.calibrate_wear([test])


def test_fit_agrees_with_a_general_least_squares_solver():
    cof = curve(noise=0.02)
    found = fitted(cof)
    design = np.c_[np.interp(WHERE, RUN, AREA) / 8.0, np.ones(WHERE.size)]
    both, rest = np.linalg.lstsq(design, cof, rcond=None)[:2]
    assert (found.shear_strength, found.ploughing) == pytest.approx(tuple(both))
    independent = np.sqrt(np.diag(np.linalg.inv(design.T @ design)) * rest[0] / 498)
    assert (found.shear_strength_error, found.ploughing_error) == pytest.approx(tuple(independent), rel=0.2)
    assert found.condition == pytest.approx(np.linalg.cond(design / np.linalg.norm(design, axis=0)))
    alone = found.without_ploughing
    assert alone.shear_strength == pytest.approx(np.linalg.lstsq(design[:, :1], cof, rcond=None)[0][0])
    assert alone.r_squared < found.r_squared < 1.0


def test_errors_cover_the_truth_for_scatter_that_goes_together():
    """A moving mean of 20 points leaves some 25 independent ones; errors of 500 would be four times small."""
    within = 0
    for seed in range(20):
        white = np.random.default_rng(seed).standard_normal(WHERE.size + 19)
        together = np.convolve(white, np.full(20, 1 / 20), mode="valid")
        found = fitted(curve() + 0.05 * together)
        within += abs(found.shear_strength - 3.0) < 2.0 * found.shear_strength_error
    assert within >= 17
    white = [fitted(curve(noise=0.02, seed=seed)).effective_points for seed in range(9)]
    assert np.median(white) > 300


@pytest.mark.slow
@pytest.mark.parametrize("length", [150.0, 600.0])
def test_a_standard_error_holds_two_thirds_where_noise_goes_together(length: float) -> None:
    """Noise of first order over 150 and 600 mm of 2400: within one error lie 68 of 100, as is told."""
    where, random = np.linspace(40.0, 2400.0, 60), np.random.default_rng(1)
    root = np.linalg.cholesky(np.exp(-np.abs(where[:, None] - where) / length))
    area = 0.3 * np.sqrt(where)
    noise = 0.02 * root @ random.standard_normal((where.size, 400))
    cases = [
        fit_friction(where, 0.1 + 3.0 * area / 8.0 + one, run_distance=where, run_area=area, load=8.0)
        for one in noise.T
    ]
    strengths = [abs(case.shear_strength - 3.0) < case.shear_strength_error for case in cases]
    ploughing = [abs(case.ploughing - 0.1) < case.ploughing_error for case in cases]
    assert np.mean(strengths) == pytest.approx(0.68, abs=0.05)
    assert np.mean(ploughing) == pytest.approx(0.68, abs=0.05)


def test_only_distances_of_the_run_are_used():
    where = np.r_[0.0, WHERE, 3000.0, 4000.0]
    found = fitted(np.r_[9.0, curve(), 9.0, 9.0], where=where)
    assert found.left_out == 3
    assert found.shear_strength == pytest.approx(3.0)


def test_doubtful_fits_say_so():
    negative = fitted(curve(ploughing=-0.05))
    assert negative.ploughing == pytest.approx(-0.05)
    assert any("μ_p is negative" in doubt for doubt in negative.doubts)
    assert negative.without_ploughing.shear_strength < 3.0
    falling = fitted(curve(tau=-1.0, ploughing=0.8))
    assert any("τ0 is negative" in doubt for doubt in falling.doubts)
    assert not any("two standard errors" in doubt for doubt in falling.doubts)
    unsure = fitted(curve(tau=-0.12, ploughing=0.5, noise=0.05, seed=1))
    assert unsure.shear_strength < 0.0
    assert any("τ0 is negative (within two standard errors of 0)" in doubt for doubt in unsure.doubts)
    narrow = fitted(curve(noise=0.01), area=1.0 + 0.01 * AREA)
    assert narrow.condition > 30
    assert any("poorly told apart" in doubt for doubt in narrow.doubts)
    other = fitted(0.4 + 0.1 * np.sin(WHERE / 400.0))
    assert any("another shape" in doubt for doubt in other.doubts)
    assert fitted(np.full(500, 0.4)).r_squared is None


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"run_area": np.full(600, 0.01356)}, "cannot be told apart"),
        ({"run_area": 1.0 + 1e-6 * AREA}, "cannot be told apart"),
        ({"distance": WHERE + 1e4}, "0 measured points lie within"),
    ],
)
def test_what_cannot_be_fitted_is_refused(change, words):
    given = {"distance": WHERE, "cof": curve(), "run_distance": RUN, "run_area": AREA, "load": 8.0} | change
    with pytest.raises(InputError, match=words):
        fit_friction(given.pop("distance"), given.pop("cof"), **given)


def test_friction_energy():
    uneven = np.cumsum(np.geomspace(0.003, 3.0, 400))
    assert friction_energy(uneven, np.full(400, 0.6), np.full(400, 8.0))[-1] == pytest.approx(
        4.8e-3 * uneven[-1]
    )
    # straight from the end of the first step: exact but for the first step, which has no other row
    work = friction_energy(uneven, uneven, np.full(uneven.size, 2.0))[-1]
    assert work == pytest.approx(1e-3 * (uneven[-1] ** 2 + uneven[0] ** 2), rel=1e-12)
    assert friction_energy(np.array([3.0]), np.array([0.5]), np.array([4.0]))[-1] == pytest.approx(6e-3)


def test_speed_changes_power_and_pv_and_not_the_energy():
    found = EnergyCalibration(
        energy=11.52, distance=2400.0, load=8.0, cof_end=0.7, pressures={"contact": 6.0}
    )
    assert found.cof == pytest.approx(0.6)
    slow, fast = record(found.at(1 / 6)), record(found.at(5 / 3))
    assert slow["time_s"] == pytest.approx(240 * 60)
    assert slow["power_mean_W"] * slow["time_s"] == pytest.approx(11.52)
    assert fast["power_mean_W"] * fast["time_s"] == pytest.approx(11.52)
    assert fast["power_end_W"] == pytest.approx(0.7 * 8.0 * 5 / 3 * 1e-3)
    assert fast["pv_MPa_m_per_s"]["contact"] == pytest.approx(0.01)


def test_scientific():
    assert scientific(3.6912e-4) == "3.691e-4"
    assert scientific(9.99996e-4) == "1.000e-3"
    assert scientific(3.6912e-4, 1.8e-5) == "(3.69 ± 0.18)e-4"
    assert scientific(3.6912e-4, 5e-4) == "(3.7 ± 5.0)e-4"
    assert scientific(3.6912e-4, 1e-12) == "(3.691 ± 1e-08)e-4"
    assert scientific(12.0, 20.0) == "(1.2 ± 2.0)e1"
