"""Parameters of profiles against closed forms, and against surfalize where it is installed."""

import math
from pathlib import Path

import numpy as np
import pytest
from cases_instruments import profile, rough

from warpwear.errors import InputError
from warpwear.surfaces.measured import read_measured
from warpwear.surfaces.preparation import Preparation
from warpwear.surfaces.profiles.profile import material_ratio, mean_width, parameters

SHARED = Path(__file__).parents[4] / "shared" / "surfaces"
STEP = 0.0005
PLACES = STEP * (np.arange(12000) + 0.5)


def test_a_sine() -> None:
    wave = 0.1  # far between λs and λc: the filters pass 2^-(λs/λ)² less 2^-(λc/λ)², all of it but 0.04 %
    p = parameters(profile(1e-3 * np.sin(2 * np.pi * PLACES / wave), STEP), cut_off=0.8, short=0.0025)
    assert p.sections == 6
    expected = {
        "ra": 2e-3 / math.pi,
        "rq": 1e-3 / math.sqrt(2),
        "rz": 2e-3,
        "rp": 1e-3,
        "rt": 2e-3,
        "rsm": wave,
    }
    for name, value in expected.items():
        assert getattr(p, name) == pytest.approx(value, rel=2e-3), name
    assert p.rsk == pytest.approx(0.0, abs=1e-3)
    assert p.rku == pytest.approx(1.5, rel=1e-3)
    assert material_ratio(p.rough, 0.0) == pytest.approx(50.0, abs=0.5)
    assert material_ratio(p.rough, 0.5e-3) == pytest.approx(100.0 / 3.0, abs=0.5)


def test_half_of_a_wave_of_the_cut_off_passes() -> None:
    p = parameters(profile(1e-3 * np.sin(2 * np.pi * PLACES / 0.8), STEP), cut_off=0.8, short=0.0025)
    assert p.rq == pytest.approx(0.5e-3 / math.sqrt(2), rel=5e-3)


@pytest.mark.parametrize(("ra", "cut_off"), [(0.01e-3, 0.08), (0.05e-3, 0.25), (1e-3, 0.8), (5e-3, 2.5)])
def test_the_rule_takes_the_class_of_the_roughness(ra: float, cut_off: float) -> None:
    places = 0.0005 * np.arange(40000)
    p = parameters(profile(0.5 * math.pi * ra * np.sin(2 * np.pi * places / 0.03), 0.0005))
    assert p.cut_off == cut_off
    assert p.ra == pytest.approx(ra, rel=0.1)  # less what λs and λc take of the wave


def test_low_elements_do_not_count() -> None:
    heights = np.sin(2 * np.pi * PLACES / 0.5)
    ripple = heights + 0.15 * np.sin(2 * np.pi * PLACES / 0.011)
    assert mean_width(heights, spacing=STEP, least=0.2) == pytest.approx(0.5, rel=1e-6)
    assert mean_width(ripple, spacing=STEP, least=0.2) == pytest.approx(0.5, rel=2e-3)
    assert mean_width(ripple, spacing=STEP, least=0.0) < 0.3
    assert mean_width(heights[:900], spacing=STEP, least=0.2) is None
    noise = np.convolve(np.random.default_rng(3).normal(size=4000), np.ones(9), "same")
    assert mean_width(noise, spacing=STEP, least=3.0) == mean_width(noise[::-1], spacing=STEP, least=3.0)


def test_missing_points_have_no_weight() -> None:
    heights = 1e-3 * np.sin(2 * np.pi * PLACES / 0.1)
    heights[3000:3100] = np.nan
    p = parameters(profile(heights, STEP), cut_off=0.8, short=0.0025)
    assert p.rq == pytest.approx(1e-3 / math.sqrt(2), rel=0.01)


def test_bad_filters_and_flats_are_refused() -> None:
    with pytest.raises(InputError, match="--lambda-s is 800 µm: allowed is less"):
        parameters(profile(np.sin(PLACES), STEP), cut_off=0.8, short=0.8)
    with pytest.raises(InputError, match="has no roughness"):
        parameters(profile(0.0 * PLACES, STEP))


def lines():
    """Return five profiles: of three measured files where they are there, and two that are made."""
    rng = np.random.default_rng(0)
    random = rough(rng, 8000, STEP, hurst=0.7, roll_off=0.1, rq=1e-3)
    marks = 6e-3 * np.abs((STEP * np.arange(8000) / 0.25) % 1 - 0.5)
    yield "random", random, STEP
    yield "turned", marks + rough(rng, 8000, STEP, hurst=0.7, roll_off=0.1, rq=0.2e-3), STEP
    for name in ("sur-2.sur", "x3p-2.x3p", "al3d-1.al3d"):
        if (SHARED / name).is_file():
            surface = read_measured(SHARED / name, Preparation(level="none"))
            yield name, surface.levelled[:, surface.levelled.shape[1] // 2], surface.pixel[0]


def test_surfalize_finds_the_same() -> None:
    peer = pytest.importorskip("surfalize.profile").Profile
    for name, heights, step in lines():
        p = parameters(profile(heights, step).levelled(1))
        other = peer(1e3 * p.rough, 1e3 * step)
        for ours, theirs in (
            *((getattr(p, key.lower()), getattr(other, key)()) for key in ("Ra", "Rq", "Rt")),
            *(
                (getattr(p, key.lower()), getattr(other, key)(n_sections=p.sections))
                for key in ("Rz", "Rp", "Rv")
            ),
            *((1e-3 * getattr(p, key.lower()), getattr(other, key)()) for key in ("Rsk", "Rku")),
        ):
            assert 1e3 * ours == pytest.approx(theirs, rel=0.01), name
        ratio = other.Rmr(1e3 * 0.5 * p.rq)
        assert material_ratio(p.rough, 0.5 * p.rq) == pytest.approx(ratio, rel=0.01), name
