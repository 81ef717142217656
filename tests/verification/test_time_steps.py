"""Stability and accuracy of explicit and implicit Archard steps."""

import math
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from thesis import K_COUNTER, K_DISC, F, H, K, L, cap, observed_order, smooth

from warpwear import InputError, run
from warpwear.grid import FloatArray
from warpwear.results.file import Snapshot

#: K_N = C_W E*/a_H with C_W = 16/(3π), which matches Hertz's area.
STIFFNESS = 16.0 / (3.0 * math.pi) * 1.072e5 / 55.2e-3
LIMIT = 2.0 / (STIFFNESS * K)  # 2c/K [mm]
History = dict[str, FloatArray]


def area_of_cap(distance: FloatArray) -> FloatArray:
    return np.array([math.pi * cap(K * F * d)[1] ** 2 for d in distance])


@cache
def springs(device: str, scheme: str, increment: float, distance: float) -> History:
    """A smooth ball on Winkler springs, 10 µm cells."""
    study = smooth(
        contact__stiffness=f"{STIFFNESS} N/mm^3",
        sliding__distance=f"{distance} mm",
        stepping__scheme=scheme,
        stepping__increment=f"{increment} mm",
        stepping__force=True,
    )
    return run(study, device=device, plots=False).history


def late_area(history: History) -> float:
    """Contact area over that of the worn cap, averaged over the last eighth of the steps."""
    part = slice(-history["distance"].size // 8, None)
    return float((history["area_contact"][part] / area_of_cap(history["distance"][part])).mean())


def test_limit_is_the_published_one() -> None:
    """0.27 mm for C_W = 16/(3π): the thesis's increment of 0.3 mm lies beyond it."""
    assert pytest.approx(0.27, abs=0.005) == LIMIT
    assert LIMIT < 0.3


def test_refused_beyond_the_limit() -> None:
    """ΔL ≥ 2c/K is bad input, and the message names the limit; force = true, or smaller steps, go on."""
    study = smooth(contact__stiffness=f"{STIFFNESS} N/mm^3")
    explicit = {"stepping.scheme": "explicit", "stepping.increment": f"{1.001 * LIMIT} mm"}
    with pytest.raises(InputError, match="stability limit"):
        study.replace(explicit)
    study.replace(explicit | {"stepping.increment": f"{0.999 * LIMIT} mm"})
    study.replace(explicit | {"stepping.force": True})


@pytest.mark.parametrize("increment", [0.2, 0.27])
def test_stable_below_the_limit(increment: float, device: str) -> None:
    """Every cell of the worn cap stays in contact at about F/A."""
    history = springs(device, "explicit", increment, 300.0)
    assert late_area(history) == pytest.approx(1.0, abs=0.01)
    assert history["pressure_std"][-1] < 0.1 * history["pressure_mean"][-1]


def test_unstable_above_the_limit_with_perfect_volumes(device: str) -> None:
    """At the thesis's 0.3 mm cells let go from step to step; volumes, depth and diameter do not show it."""
    history = springs(device, "explicit", 0.3, L)
    assert late_area(history) < 0.85
    assert (history["pressure_std"] / history["pressure_mean"])[-1000:].max() > 0.5
    assert np.abs(np.diff(history["area_contact"][-1000:])).max() > 0.1
    height, radius = cap(K * F * L)
    assert_allclose(history["wear_volume_counter"], K_COUNTER * F * history["distance"], rtol=1e-10)
    assert_allclose(history["wear_volume_disc"], K_DISC * F * history["distance"], rtol=1e-10)
    assert history["wear_depth_disc"][-1] == pytest.approx(K_DISC / K * height, rel=0.01)
    assert history["patch_along"][-1] == pytest.approx(2.0 * radius, abs=0.01)
    assert history["area_touched"][-1] == pytest.approx(math.pi * radius**2, rel=0.01)


def test_implicit_is_stable_there(device: str) -> None:
    """The same increment, implicit: the worn cap's area within half a per cent, and an even pressure."""
    history = springs(device, "implicit", 0.3, L)
    late = history["distance"] > 0.5 * L
    assert_allclose(history["area_contact"][late], area_of_cap(history["distance"][late]), rtol=5e-3)
    assert history["pressure_std"][-1] < 1e-3 * history["pressure_mean"][-1]


INCREMENTS = [0.6, 0.3, 0.15, 0.075]


def rough(device: str, **changes: Any) -> tuple[History, Snapshot]:
    """6 mm of a rough contact on 5 µm cells, Ra 1 µm, capped at H."""
    synthetic = {
        "kind": "self-affine",
        "ra": "1 um",
        "roll_off": "60 um",
        "cut_off": "20 um",
        "period": "1 mm",
        "seed": 3,
    }
    study = smooth(
        disc__synthetic=synthetic,
        contact__hardness=f"{H} MPa",
        grid__cell="5 um",
        grid__extent="0.5 mm",
        sliding__distance="6 mm",
        **changes,
    )
    result = run(study, device=device, plots=False)
    return result.history, result.snapshot(-1)


def test_explicit_cell_wear_is_first_order(device: str) -> None:
    """c = 0: cells hop by K H ΔL, so gaps and the touched area near the implicit ones in proportion to ΔL."""
    implicit, exact = rough(device, stepping__increment="0.3 mm")
    depth, area = [], []
    for increment in INCREMENTS:
        history, fields = rough(device, stepping__scheme="explicit", stepping__increment=f"{increment} mm")
        error = np.abs(fields.gap - exact.gap)
        assert error.max() < K * H * increment
        depth.append(float(error.mean()))
        area.append(float(history["area_touched"][-1] - implicit["area_touched"][-1]))
        assert_allclose(history["pressure_mean"], H, rtol=0.01)
    assert observed_order(INCREMENTS, depth) == pytest.approx(1.0, abs=0.1)
    assert observed_order(INCREMENTS, area) == pytest.approx(1.0, abs=0.25)


def test_explicit_springs_are_first_order(device: str) -> None:
    """k = 2e5 N/mm³, far below the limit; implicit steps of any size give the same approach and area."""
    k = {"contact__stiffness": "2e5 N/mm^3"}
    implicit, _ = rough(device, stepping__increment="0.3 mm", **k)
    finer, exact = rough(device, stepping__increment="0.003 mm", **k)
    assert_allclose(implicit["approach"][-1], finer["approach"][-1], rtol=1e-12)
    assert implicit["area_contact"][-1] == finer["area_contact"][-1]
    approach, area, pressure = [], [], []
    for increment in INCREMENTS:
        history, fields = rough(
            device, stepping__scheme="explicit", stepping__increment=f"{increment} mm", **k
        )
        approach.append(float(history["approach"][-1] - finer["approach"][-1]))
        area.append(float(history["area_contact"][-1] - finer["area_contact"][-1]))
        pressure.append(float(np.abs(fields.pressure - exact.pressure).sum()))
    assert observed_order(INCREMENTS, approach) == pytest.approx(1.0, abs=0.1)
    assert observed_order(INCREMENTS, area) == pytest.approx(1.0, abs=0.25)
    assert observed_order(INCREMENTS, pressure) == pytest.approx(1.0, abs=0.25)
