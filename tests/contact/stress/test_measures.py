"""What materials are compared with: of a stress, of a cycle, and what is refused."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import warpwear
from warpwear.contact.array import memory
from warpwear.contact.stress import measures
from warpwear.contact.stress.stresses import Stresses, averaged, deepest
from warpwear.errors import InputError
from warpwear.grid import FloatArray

PRESSURE = np.pad(np.ones((4, 3)), 4)
LIMITS = {"bending": 500.0, "torsion": 310.0}


def state(**components: float) -> FloatArray:
    """One stress of named components, shape (6, 1)."""
    return np.array([[components.get(name, 0.0)] for name in ("xx", "yy", "zz", "xy", "xz", "yz")])


def below(**options: Any) -> Stresses:
    usual = {"contact": PRESSURE, "depths": [0.0, 0.5], "cell": 0.5, "boundary": "free", "poisson": 0.3}
    return warpwear.stresses(**(usual | options))


def test_measures_against_eigenvalues() -> None:
    stress = np.random.default_rng(1).normal(size=(6, 500))
    stress[:, :6] = np.eye(6)
    stress[:, 6] = [2.0, 2.0, 2.0, 0.0, 0.0, 0.0]
    xx, yy, zz, xy, xz, yz = stress
    matrices = np.moveaxis(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), 2, 0)
    low, middle, high = np.linalg.eigvalsh(matrices).T
    largest, shear = measures.principal(stress)
    assert_allclose(largest, high, atol=1e-7)
    assert_allclose(shear, 0.5 * (high - low), atol=1e-7)
    exact = np.sqrt(0.5 * ((high - middle) ** 2 + (middle - low) ** 2 + (low - high) ** 2))
    assert_allclose(measures.mises(stress), exact, atol=1e-12)


@pytest.mark.parametrize("criterion", [measures.crossland, measures.dang_van])
def test_a_criterion_gives_its_two_limits_back(criterion: Any) -> None:
    """Fully reversed bending and torsion at their limits, about no mean, and bending about a mean tension."""
    for stress in (state(xx=LIMITS["bending"]), state(xy=LIMITS["torsion"]), state(yz=LIMITS["torsion"])):
        assert criterion(stress, -stress, **LIMITS) == pytest.approx(LIMITS["torsion"], rel=1e-12)
    mean = state(xx=60.0, yy=60.0, zz=60.0)
    bent = state(xx=LIMITS["bending"])
    assert criterion(bent + mean, mean - bent, **LIMITS) > LIMITS["torsion"] + 1.0
    assert criterion(bent - mean, -mean - bent, **LIMITS) < LIMITS["torsion"] - 1.0


def test_a_cycle_of_a_contact() -> None:
    """Of pressure that stays and traction that turns: the amplitude is the traction's alone."""
    traction = (0.4 * PRESSURE, None)
    there, back = below(traction=traction), below(traction=(-traction[0], None))
    cycle = there.cycle(back, **LIMITS)
    pulled = below(contact=0.0 * PRESSURE, traction=traction)
    amplitude = pulled.mises / math.sqrt(3.0)
    factor = 3.0 * LIMITS["torsion"] / LIMITS["bending"] - math.sqrt(3.0)
    highest = np.maximum(there.tensor[:3].mean(axis=0), back.tensor[:3].mean(axis=0))
    assert_allclose(cycle.crossland, amplitude + factor * highest, atol=1e-12)
    value, (x, y, z) = cycle.largest(cycle.crossland)
    assert value == cycle.crossland.max()
    assert (abs(y), z) == (0.0, 0.0)
    assert abs(x) == pytest.approx(0.75)  # the last cell under the traction
    smooth = there.cycle(back, **LIMITS, length=1.2)
    assert smooth.crossland.max() < value


@pytest.mark.parametrize("boundary", ["free", "periodic", "line"])
@pytest.mark.parametrize("cells", [1.0, 1.7, 2.0, 3.0, 4.5])
def test_an_average_is_over_the_very_square(boundary: str, cells: float) -> None:
    field = np.zeros((9, 11))
    field[4, 5] = 1.0
    mean = averaged(field, cells, boundary)
    line = np.clip(0.5 * (cells + 1.0) - np.abs(np.arange(9) - 4), 0.0, 1.0) / cells
    across = np.clip(0.5 * (cells + 1.0) - np.abs(np.arange(11) - 5), 0.0, 1.0) / cells
    assert_allclose(mean, line[:, np.newaxis] * across, atol=1e-15)
    assert_allclose(averaged(np.ones((9, 11)), cells, boundary), 1.0, rtol=1e-14)


def test_what_yields() -> None:
    depths = np.array([0.0, 1.0, 3.0])
    assert deepest(depths, np.array([1.0, 4.0, 2.0]), 3.0) == pytest.approx(2.0)
    assert deepest(depths, np.array([1.0, 4.0, 2.0]), 5.0) == 0.0
    assert deepest(depths, np.array([1.0, 4.0, 2.0]), 0.5) == 3.0
    stresses = below(depths=[0.0, 0.5, 1.0, 4.0])
    limit = 0.9 * stresses.mises.max()
    yielding = stresses.yielding(limit)
    assert 0.5 <= yielding.depth < 4.0
    assert_allclose(yielding.shares, (stresses.mises > limit).mean(axis=(1, 2)))
    exact = np.trapezoid(yielding.shares, stresses.depths) * PRESSURE.size * 0.25
    assert yielding.volume == pytest.approx(exact)


def test_a_plane_across_an_axis() -> None:
    stresses = below()
    between = stresses.plane(stresses.mises, "y", at=0.25)
    assert between.shape == (2, 12)
    assert_allclose(between, 0.5 * (stresses.mises[..., 5] + stresses.mises[..., 6]))
    assert stresses.plane(stresses.tensor, "x").shape == (6, 2, 11)


def test_ruiz_ranks_places() -> None:
    slip = np.full(PRESSURE.shape, 0.1)
    stresses = below(traction=(0.3 * PRESSURE, 0.4 * PRESSURE))
    product = stresses.ruiz(slip)
    exact = np.maximum(stresses.principal[0], 0.0) * 0.5 * PRESSURE * 0.1
    assert_allclose(product, exact, atol=1e-15)
    with pytest.raises(InputError, match="they must have a traction"):
        below().ruiz(slip)


MISUSES: dict[str, tuple[dict[str, Any], str]] = {
    "a depth above": ({"depths": [-0.1, 0.2]}, "depths = .* must be lengths from 0, rising"),
    "depths that fall": ({"depths": [0.2, 0.1]}, "must be lengths from 0, rising"),
    "a word": ({"depths": "deep"}, "depths = 'deep' are not possible"),
    "no boundary": ({"boundary": None}, "boundary = None has no stresses"),
    "half a boundary": ({"boundary": "half"}, "boundary = 'half' has no stresses"),
    "rubber and more": ({"poisson": 0.6}, "poisson = 0.6 is not possible; it must be from 0 to 0.5"),
    "one traction": ({"traction": [PRESSURE]}, "traction is not possible; it must be a pair"),
    "a traction of another shape": ({"traction": (None, PRESSURE.T)}, r"traction y of shape \(11, 12\)"),
    "no cell": ({"cell": None}, "cell = None is not possible"),
}


@pytest.mark.parametrize("case", MISUSES)
def test_misuse_is_told_in_a_sentence(case: str) -> None:
    options, words = MISUSES[case]
    with pytest.raises(InputError, match=words) as refused:
        below(**options)
    assert str(refused.value).endswith(".")


def test_misuse_of_what_was_computed() -> None:
    stresses = below()
    with pytest.raises(InputError, match="torsion = 200 is not possible with bending = 500"):
        stresses.cycle(stresses, bending=500.0, torsion=200.0)
    with pytest.raises(InputError, match="length = 100 is not possible"):
        stresses.averaged(100.0)
    with pytest.raises(InputError, match="other, of shape"):
        stresses.cycle(below(depths=[0.0]), **LIMITS)
    with pytest.raises(InputError, match="normal = 'z' is not known"):
        stresses.plane(stresses.mises, "z")
    with pytest.raises(InputError, match="at = 99 is not possible"):
        stresses.plane(stresses.mises, "x", at=99.0)
    with pytest.raises(InputError, match="component 'zy' is not known"):
        stresses.component("zy")


def test_a_solved_contact_brings_its_boundary() -> None:
    heights = np.random.default_rng(0).normal(size=(16, 12))
    contact = warpwear.solve_contact(heights, cell=0.5, mean_pressure=0.1, modulus=1.0)
    assert warpwear.stresses(contact, 0.5, poisson=0.3).boundary == "periodic"
    with pytest.raises(InputError, match=r"cell = 0\.5 is not possible with a solved contact"):
        warpwear.stresses(contact, 0.5, poisson=0.3, cell=0.5)
    springs = warpwear.solve_contact(heights, cell=0.5, mean_pressure=0.1, stiffness=1.0)
    with pytest.raises(InputError, match="boundary = None has no stresses"):
        warpwear.stresses(springs, 0.5, poisson=0.3)


def test_a_sheared_contact_brings_its_traction() -> None:
    contact = warpwear.solve_contact(
        np.zeros((24, 24)), cell=0.1, load=1.0, modulus=1.0, counter={"radius": 10.0}
    )
    sheared = warpwear.solve_tangential(contact, friction=0.5, poisson=0.3, force=0.3)
    tensor = warpwear.stresses(sheared, [0.0, 0.3], poisson=0.3).tensor
    apart = warpwear.stresses(contact, [0.0, 0.3], poisson=0.3, traction=tuple(sheared.traction)).tensor
    assert_allclose(tensor, apart, atol=1e-14)
    assert tensor[4, 0].sum() * 0.01 == pytest.approx(-0.3, rel=1e-6)


def test_memory_is_told_and_refused(
    monkeypatch: pytest.MonkeyPatch,
    host_with: Callable[[float], None],
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(memory, "SAID", 1.0)
    below()
    assert "stresses: 2 depths below a pressure of shape (12, 11) need up to" in capsys.readouterr().err
    host_with(1000)
    with pytest.raises(InputError, match=r"2 depths .* need 0\.0 GiB of memory; the host has"):
        below()
