"""Wear laws beside Archard's: exact in volume at any step, and the running-in of an unresolved roughness."""

import math
import re
from dataclasses import fields
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from thesis import K_COUNTER, K_DISC, F, K, smooth

from warpwear import InputError, Study, run
from warpwear.laws.archard import WEAR_LAWS, WearLaw
from warpwear.laws.bearing_curve import Logistic
from warpwear.study.surface import bearing_curve_of, fit_bearing_curve


@pytest.mark.parametrize("increment", ["0.3 mm", "30 mm"])
def test_exponential_law(increment: str, device: str) -> None:
    """V = K F (1 − e^(−αL))/α (thesis eq 2.4) at every step, whatever its size."""
    alpha = 1e-3  # 1/mm
    study = smooth(
        wear__law="exponential",
        wear__decay="1 1/m",
        stepping__increment=increment,
        sliding__distance="300 mm",
    )
    history = run(study, device=device, plots=False).history
    for name, coefficient in (("counter", K_COUNTER), ("disc", K_DISC)):
        expected = coefficient * F * -np.expm1(-alpha * history["distance"]) / alpha
        assert_allclose(history[f"wear_volume_{name}"], expected, rtol=1e-10)


@pytest.mark.parametrize("increment", ["0.3 mm", "30 mm"])
def test_running_in_law(increment: str, device: str) -> None:
    """K(L) = K + (K0 − K) e^(−L/L0), integrated; a body without a K0 keeps its K."""
    study = smooth(
        wear__law="running-in",
        wear__running_in="50 mm",
        wear__initial_counter="9.4e-3 mm^3/N/m",
        stepping__increment=increment,
        sliding__distance="300 mm",
    )
    history = run(study, device=device, plots=False).history
    distance = history["distance"]
    extra = 9.0 * K_COUNTER * 50.0 * -np.expm1(-distance / 50.0)
    assert_allclose(history["wear_volume_counter"], F * (K_COUNTER * distance + extra), rtol=1e-10)
    assert_allclose(history["wear_volume_disc"], F * K_DISC * distance, rtol=1e-10)


@pytest.mark.parametrize("law", WEAR_LAWS.values(), ids=WEAR_LAWS)
def test_no_law_wears_faster_than_it_says(law: type[WearLaw]) -> None:
    """An inference looks for a field that holds the scar of `fastest`, and refuses a larger one."""
    draw = np.random.default_rng(1)
    for numbers in draw.uniform(0.1, 2.0, (20, len(fields(law)))):
        body = law(*numbers.tolist())
        for start in (0.0, 0.1, 1.0, 10.0, 100.0):
            assert body.wear_per_pressure(start, 0.01) <= 0.01 * body.fastest * (1.0 + 1e-9)


TRANSITION = {
    "wear.law": "transition",
    "wear.severe_counter": "9.4e-3 mm^3/N/m",
    "wear.severe_disc": "12.7e-3 mm^3/N/m",
    "wear.transition_pressure": "8 MPa",
    "wear.transition_width": "4 MPa",
    "grid.extent": "1 mm",
    "grid.cell": "50 um",
    "counter.radius": "inf mm",
    "stepping.increment": "1 mm",
    "sliding.distance": "10 mm",
}
ELASTIC = {
    f"{body}.{key}": value
    for body in ("counter", "disc")
    for key, value in (("young", "210 GPa"), ("poisson", 0.3))
}
HALF_SPACE = ELASTIC | {
    "contact.law": "half-space",
    "contact.boundary": "periodic",
    "contact.hardness": "1 GPa",
}
PATCHES = {"study.model": "two-scale", "patches.macro_cell": "500 um", "patches.bulk": "none"}
PATCHES |= {"contact.hardness": "1 GPa"}
HOSTS = {
    "springs": {"contact.stiffness": "1e5 N/mm^3"},
    "explicit": {"contact.stiffness": "1e2 N/mm^3", "stepping.scheme": "explicit"},
    "wear alone": {},
    "capped": {"contact.hardness": "20 MPa"},
    "half-space": HALF_SPACE,
    "patches": PATCHES,
    "patches on half-spaces": PATCHES | HALF_SPACE,
}


@pytest.mark.parametrize("host", HOSTS)
@pytest.mark.parametrize("load", [3.0, 7.0, 8.0, 9.5, 13.0])
def test_a_flat_wears_by_the_k_of_its_pressure(host: str, load: float, device: str) -> None:
    """On 1 mm² the load is the pressure: below the transition, in it and beyond it V = K(F) F L."""
    study = smooth().replace(TRANSITION | HOSTS[host] | {"contact.load": f"{load} N"})
    history = run(study, device=device, plots=False).history
    severe = min(max((load - 6.0) / 4.0, 0.0), 1.0)
    for name, coefficient in (("counter", K_COUNTER), ("disc", K_DISC)):
        expected = coefficient * (1.0 + 9.0 * severe) * load * history["distance"]
        assert_allclose(history[f"wear_volume_{name}"], expected, rtol=1e-10)
        assert_allclose(history[f"archard_volume_{name}"], expected, rtol=1e-10)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"wear.transition_width": "20 MPa"}, "begins to change at -2 MPa"),
        ({"wear.severe_disc": "1e-4 mm^3/N/m"}, "makes pressures beyond 6 MPa wear less than smaller ones"),
        ({"wear.disc": "0 mm^3/N/m"}, "wears under some pressures alone"),
        ({"wear.transition_width": None}, "needs wear.transition_width"),
        (
            {"wear.distance_factor": "radial", "counter.radius": "3 mm"},
            "does not go with wear.distance_factor",
        ),
        (PATCHES | {"wear.severe_disc": "9e-3 mm^3/N/m"}, "in one proportion"),
        (
            {"stepping.scheme": "explicit", "contact.stiffness": "1e4 N/mm^3"},
            # (p K)' is largest at the end of the transition: 10 + 9/4 × 10 times K of mild wear.
            f"explicit stability limit 2/(k K) = {2.0 / (1e4 * 32.5 * K):.3g} mm",
        ),
    ],
    ids=str,
)
def test_a_transition_that_is_not_followed_is_refused(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=re.escape(words)):
        smooth().replace(TRANSITION | {"stepping.increment": "5 mm"} | changes)


CURVE = Logistic(middle=0.010, scale=0.002)


def closed_form(mean: np.ndarray) -> np.ndarray:
    """Depth z [mm] at which ∫ φ dz is the mean worn depth: z = m + s ln(q + (1 + q)(e^(v/s) − 1))."""
    q = math.exp(-CURVE.middle / CURVE.scale)
    return CURVE.middle + CURVE.scale * np.log(q + (1.0 + q) * np.expm1(mean / CURVE.scale))


def flat_on_flat(**changes: str) -> Study:
    """A rigid flat of 1 mm² on a disc that alone wears: pressure F everywhere."""
    given = {"disc.synthetic.kind": "milled", "disc.synthetic.ra": "3 um"}
    return smooth(
        study__model="macro",
        counter__radius="inf mm",
        contact__bulk_stiffness="1e6 N/mm^3",
        grid__extent="1 mm",
        grid__cell="100 um",
        wear__law="bearing-curve",
        wear__counter="0 mm^3/N/m",
        wear__disc="1e-3 mm^3/N/m",
        sliding__distance="3000 mm",
        stepping__increment="10 mm",
        **{k.replace(".", "__"): v for k, v in (given | changes).items()},
    )


@pytest.fixture
def curve(monkeypatch: pytest.MonkeyPatch) -> None:
    """A disc whose bearing curve is known."""
    monkeypatch.setattr("warpwear.runs.arrangements.bearing_curve_of", lambda study: CURVE)


@pytest.mark.usefixtures("curve")
def test_a_rough_disc_recedes_by_its_bearing_curve(device: str) -> None:
    """Volumes stay K F L, a flat sinks by the closed form and ends deeper by a constant."""
    result = run(flat_on_flat(), device=device, plots=False)
    history = result.history
    assert any("share of the cells that bears" in warning for warning in result.record["warnings"])
    mean = 1e-6 * F * history["distance"]
    assert_allclose(history["wear_volume_disc"], mean, rtol=1e-12)
    # The approach holds the spring and the wear of its step, the latter by the slope at the step's start.
    depth = closed_form(mean)
    late = mean > 2.0 * CURVE.middle
    assert late.sum() > 20
    assert_allclose(history["approach"][late], depth[late] + F / 1e6, rtol=1e-5)
    constant = CURVE.middle + CURVE.scale * math.log1p(math.exp(-CURVE.middle / CURVE.scale))
    assert depth[-1] - mean[-1] == pytest.approx(constant, rel=1e-3)


@pytest.mark.usefixtures("curve")
def test_the_gap_after_a_step_is_the_closed_form(device: str) -> None:
    result = run(flat_on_flat(), device=device, plots=False)
    end = result.snapshot(-1)
    assert_allclose(end.gap, closed_form(end.wear_disc), rtol=1e-12)


def test_the_logistic_is_that_of_logistic_heights() -> None:
    """Heights drawn from a logistic distribution: its own parameters come back."""
    ranks = (np.arange(200_000) + 0.5) / 200_000
    heights = 0.002 * np.log(ranks / (1.0 - ranks))
    found = fit_bearing_curve(heights)
    assert found.scale == pytest.approx(0.002, rel=1e-3)
    assert found.middle == pytest.approx(heights.max(), rel=1e-3)


def test_the_curve_is_the_discs_and_flat_ones_have_none() -> None:
    study = flat_on_flat(disc__synthetic__kind="self-affine")
    curve = bearing_curve_of(study)
    assert 0.5 * 3.75e-3 * math.sqrt(3) / math.pi < curve.scale < 2 * 3.75e-3 * math.sqrt(3) / math.pi
    with pytest.raises(InputError, match="needs a rough disc"):
        bearing_curve_of(flat_on_flat(disc__synthetic__kind="flat"))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"stepping.scheme": "explicit"}, "needs stepping.scheme = 'implicit'"),
        ({"study.model": "micro"}, "needs study.model = 'macro', not 'micro'"),
    ],
)
def test_where_the_bearing_curve_does_not_apply(changes: dict[str, str], message: str) -> None:
    with pytest.raises(InputError, match=message):
        flat_on_flat().replace(changes)


@pytest.mark.usefixtures("curve")
def test_the_area_is_the_share_that_bears(device: str) -> None:
    """φ at the depth before each step, over a square millimetre of cells in contact."""
    history = run(flat_on_flat(), device=device, plots=False).history
    before = closed_form(np.append(0.0, 1e-6 * F * history["distance"][:-1]))
    share = 1.0 / (1.0 + np.exp(-(before - CURVE.middle) / CURVE.scale))
    assert_allclose(history["area_contact"], share, rtol=1e-10)
    assert share[0] < 0.01
    assert_allclose(history["cells_in_contact"], 100)
