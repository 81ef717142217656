"""Materials by worn depth against closed forms, and against 1/K integrated by quadrature."""

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import quad

from warpwear.laws.depth_profile import DepthProfile, LayerMaterial

#: A hard coat, a soft interlayer and a body [mm, mm²/N].
COAT = DepthProfile(
    (0.0, 2.0e-3, 2.5e-3), (LayerMaterial(1e-10, 2e4), LayerMaterial(3e-8, 4e3), LayerMaterial(2e-9, 8e3))
)
#: A nitrided case, whose K rises, falls and rises.
CASE = DepthProfile(
    (0.0, 1.0e-2, 4.0e-2, 5.0e-2),
    (
        LayerMaterial(1e-9, 1.1e4),
        LayerMaterial(5e-9, 9e3),
        LayerMaterial(2e-9, 6e3),
        LayerMaterial(8e-9, 3e3),
    ),
    graded=True,
)


def by_quadrature(profile: DepthProfile, first: float, last: float) -> float:
    """Return ∫ dδ / K [N/mm] between two depths [mm], piece by piece."""
    ends = [first, *(depth for depth in profile.depths if first < depth < last), last]
    total = 0.0
    for low, high in itertools.pairwise(ends):
        inside = 1.0 if profile.graded else 0.0
        middle = float(profile.coefficient_at(np.array(0.5 * (low + high))))

        def softness(depth: float, middle: float = middle, inside: float = inside) -> float:
            return 1.0 / (float(profile.coefficient_at(np.array(depth))) if inside else middle)

        total += quad(softness, low, high, epsabs=0.0, epsrel=1e-13)[0]
    return total


@pytest.mark.parametrize("profile", [COAT, CASE], ids=["layers", "gradient"])
def test_what_wears_through_goes_on_by_what_is_left(profile: DepthProfile) -> None:
    """Exposures from within one material to beyond all of them, in one step."""
    start = np.array([0.0, 1.0e-3, 2.0e-3, 2.2e-3, 1.5e-2, 0.045, 0.06])
    for exposure in (1.0e-2, 1.0, 1.0e4, 2.0e6, 3.0e7):
        end = profile.worn(start, np.full(start.size, exposure))
        for low, high in zip(start, end, strict=True):
            within = 1e-12 + 2e-17 / (high - low)
            assert by_quadrature(profile, low, high) == pytest.approx(exposure, rel=within)
        assert np.allclose(profile.exposure(end) - profile.exposure(start), exposure, rtol=1e-12, atol=1e-8)


def test_layers_by_their_closed_form() -> None:
    """2 µm at 1e-10, 0.5 µm at 3e-8, then 2e-9 mm²/N."""
    through = 2.0e-3 / 1e-10 + 0.5e-3 / 3e-8
    assert COAT.worn(np.array(0.0), np.array(1.0e7)) == pytest.approx(1.0e-3, rel=1e-14)
    assert COAT.worn(np.array(0.0), np.array(through + 1.0e6)) == pytest.approx(2.5e-3 + 2.0e-3, rel=1e-12)
    assert COAT.exposure(np.array(4.5e-3)) == pytest.approx(through + 1.0e6, rel=1e-14)
    assert COAT.lost_of_each(np.array([1.0e-3, 2.2e-3, 9.0e-3])) == pytest.approx(
        np.array([[1.0e-3, 2.0e-3, 2.0e-3], [0.0, 0.2e-3, 0.5e-3], [0.0, 0.0, 6.5e-3]]), rel=1e-12
    )


def test_a_gradient_by_its_closed_form() -> None:
    """K = K0 + s δ gives δ = K0 (e^(s q) − 1)/s."""
    slope = 4e-9 / 1.0e-2
    exposure = 1.0e6
    assert CASE.worn(np.array(0.0), np.array(exposure)) == pytest.approx(
        1e-9 * math.expm1(slope * exposure) / slope, rel=1e-13
    )
    assert CASE.exposure(np.array(1.0e-2)) == pytest.approx(math.log(5.0) / slope, rel=1e-13)
    assert CASE.hardness_at(np.array([0.0, 5.0e-3, 1.0])) == pytest.approx([1.1e4, 1.0e4, 3e3])


@pytest.mark.parametrize("profile", [COAT, CASE], ids=["layers", "gradient"])
def test_one_step_or_a_thousand(profile: DepthProfile) -> None:
    depth = np.zeros(1)
    for _ in range(1000):
        depth = profile.worn(depth, np.array([3.0e4]))
    assert depth == pytest.approx(profile.worn(np.zeros(1), np.array([3.0e7])), rel=1e-11)


def test_a_material_that_does_not_wear_is_never_worn_through() -> None:
    stops = DepthProfile((0.0, 1.0e-3), (LayerMaterial(1e-9), LayerMaterial(0.0)))
    assert stops.worn(np.array([0.0, 2.0e-3]), np.array([1e9, 1e9])) == pytest.approx([1.0e-3, 2.0e-3])
    falls = DepthProfile((0.0, 1.0e-3), (LayerMaterial(1e-9), LayerMaterial(0.0)), graded=True)
    assert falls.worn(np.array(0.0), np.array(1e12)) == pytest.approx(1.0e-3, rel=1e-12)


def test_what_a_profile_says_of_itself() -> None:
    assert (COAT.fastest, COAT.least_hardness, COAT.first_interface) == (3e-8, 4e3, 2.0e-3)
    assert not COAT.is_uniform
    assert not COAT.scales
    alike = DepthProfile((0.0, 1.0), (LayerMaterial(1e-9, name="coat"), LayerMaterial(1e-9)))
    assert alike.is_uniform
    assert alike.scales
    assert alike.first_interface == math.inf
    assert CASE.first_interface == 0.0
    assert list(COAT.material_at(np.array([0.0, 2.0e-3, 2.4e-3, 9.0]))) == [0, 1, 1, 2]


def test_the_volume_of_a_cap_of_layers() -> None:
    """Σ V_m / K_m of a paraboloid h high, of which h − δ lies below δ: its volume goes as the square."""
    depth = 5.0e-3
    below = [(1.0 - d / depth) ** 2 for d in COAT.depths] + [0.0]
    softness = sum(
        (above - under) / material.wear
        for above, under, material in zip(below, below[1:], COAT.materials, strict=False)
    )
    assert COAT.mean_coefficient(depth, 2.0) == pytest.approx(1.0 / softness, rel=1e-13)
    assert COAT.mean_coefficient(0.0, 2.0) == pytest.approx(1e-10) == COAT.mean_coefficient(1e-3, 2.0)
