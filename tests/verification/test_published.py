"""The thesis's V3 as published: pressure pinned at hardness, a straight CoF from a running sum of areas."""

from functools import cache

import numpy as np
from numpy.testing import assert_allclose
from thesis import K_COUNTER, K_DISC, F, H, L

from warpwear import Result, Study, run


@cache
def published(device: str) -> Result:
    """8000 explicit steps on 10 µm cells."""
    return run(Study.load("v3"), device=device, plots=False)


def test_load_tolerance_and_pinned_pressure(device: str) -> None:
    """|A H − F| < 0.5 N, hence P within 555–630 MPa and A within 6 % of F/H, at every one of 8000 steps."""
    history = published(device).history
    assert history["distance"].size == 8000
    assert np.abs(history["load_residual"]).max() < 0.5
    assert_allclose(history["area_contact"] * H - F, history["load_residual"], atol=1e-10)
    assert_allclose(history["pressure_mean"] * history["area_contact"], F, rtol=1e-12)
    assert history["pressure_mean"].min() >= 555.0
    assert history["pressure_mean"].max() <= 630.0
    assert 15.0 < history["pressure_mean"].std() < 25.0  # the scatter of ± 20 MPa is the tolerance's
    assert history["pressure_std"].max() <= 1e-6 * H  # one pressure on all cells, up to rounding


def test_friction_is_a_straight_line(device: str) -> None:
    """The running sum of areas: R² > 0.999 over the distance, exponent 1, 86 times the area ever touched."""
    history = published(device).history
    assert np.corrcoef(history["distance"], history["cof"])[0, 1] ** 2 > 0.999
    assert_allclose(history["area_cumulative"], np.cumsum(history["area_contact"]), rtol=1e-12)
    shape = published(device).summary["area_shape"]
    assert abs(shape["exponent_m"] - 1.0) < 0.01
    assert abs(shape["levelling_lambda"] - 1.0) < 0.01
    assert abs(history["area_cumulative"][-1] / history["area_touched"][-1] - 86.0) < 4.0


def test_volumes(device: str) -> None:
    """Counter-body K F L, disc the factor-weighted sum near 0.996 K F L (eq 4.22), both to 1e-10."""
    result = published(device)
    history = result.history
    assert_allclose(history["wear_volume_counter"], K_COUNTER * F * history["distance"], rtol=1e-10)
    assert_allclose(history["wear_volume_disc"], history["archard_volume_disc"], rtol=1e-10)
    fields = result.snapshot(-1)
    factor = np.sqrt(1.0 - (result.y[None, :] / 3.0) ** 2)
    weighted = K_DISC / K_COUNTER * (fields.wear_counter * factor).sum() * 0.01**2
    assert_allclose(history["wear_volume_disc"][-1], weighted, rtol=1e-10)
    assert_allclose(fields.wear_disc, K_DISC / K_COUNTER * factor * fields.wear_counter, rtol=1e-10)
    assert abs(history["wear_volume_disc"][-1] / (K_DISC * F * L) - 0.996) < 0.001
