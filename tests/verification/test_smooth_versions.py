"""The smooth models of the thesis, V1 and V2: patch, depths, volumes, growth; what unstable steps leave."""

import math
from functools import cache
from typing import Any

import numpy as np
import pytest
import reference
from numpy.testing import assert_allclose
from thesis import K_COUNTER, K_DISC, F, K, L, R, patch_radius

from warpwear import InputError, Result, Study, run
from warpwear.results.track import shape_of_growth


@cache
def smooth_model(device: str, preset: str = "v1", *changes: tuple[str, Any]) -> Result:
    return run(Study.load(preset).replace(dict(changes)), device=device, plots=False)


def test_v1_patch_depths_and_volumes(device: str) -> None:
    """2a = 1.269 mm ± one cell (thesis 1.28), K_b/(K_s + K_d) of a²/2R, K F L to 1e-10."""
    history = smooth_model(device).history
    for extent in ("patch_along", "patch_across"):
        assert history[extent][-1] == pytest.approx(1.269, abs=0.01)
    sag = patch_radius(K, L) ** 2 / (2.0 * R)
    assert history["wear_depth_counter"][-1] == pytest.approx(K_COUNTER / K * sag, rel=0.01)
    assert history["wear_depth_disc"][-1] == pytest.approx(K_DISC / K * sag, rel=0.01)
    assert_allclose(history["wear_volume_counter"], K_COUNTER * F * history["distance"], rtol=1e-10)
    assert_allclose(history["wear_volume_disc"], K_DISC * F * history["distance"], rtol=1e-10)


def test_v1_grows_as_a_square_root(device: str) -> None:
    """A = √(4π R K F L): exponent 1/2, levelling 1/4; the coefficient of friction ends at 0.6."""
    history = smooth_model(device).history
    shape = shape_of_growth(history["distance"], history["area_contact"])
    assert shape["exponent_m"] == pytest.approx(0.50, abs=0.01)
    assert shape["levelling_lambda"] == pytest.approx(0.25, abs=0.01)
    assert history["cof"][-1] == pytest.approx(0.6, abs=0.005)


def test_v1_steps_against_the_reference(device: str, threads: int) -> None:
    """A hundred explicit steps of plain NumPy on the same gap."""
    study = Study.load("v1").replace({"sliding.distance": "30 mm", "output.snapshots": []})
    result = run(study, device=device, threads=threads, plots=False)
    x, y = np.meshgrid(result.x, result.y, indexing="ij")
    r2 = x * x + y * y
    gap = r2 / (R + np.sqrt(R * R - r2))
    compliance = 1.0 / study.pair.stiffness
    for row in range(100):
        contact = reference.foundation(gap, compliance, F, math.inf, study.grid.cell)
        assert result.history["approach"][row] == pytest.approx(contact.approach, rel=1e-11)
        assert result.history["area_contact"][row] == pytest.approx(
            (contact.pressure > 0).sum() * study.grid.cell**2, abs=1e-12
        )
        gap += K * 0.3 * contact.pressure
    assert_allclose(result.snapshot(-1).gap, gap, atol=1e-13)


def test_implicit_results_do_not_depend_on_the_increment(device: str) -> None:
    """0.3 to 30 mm: final area and depth within 1 %."""
    runs = [
        smooth_model(device, "v1", ("stepping.scheme", "implicit"), ("stepping.increment", f"{step} mm"))
        for step in (0.3, 3, 30)
    ]
    explicit = smooth_model(device)
    for name in ("area_contact", "wear_depth_disc", "wear_depth_counter"):
        assert_allclose([r.history[name][-1] for r in runs], explicit.history[name][-1], rtol=0.01)


def test_v2_wears_the_disc_less_and_presses_its_sides_more(device: str) -> None:
    """Disc volume 0.37 ± 0.05 % below V1, counter the same, about 1.3 % more pressure at the edge across."""
    one, two = smooth_model(device), smooth_model(device, "v2")
    volumes = [r.history["wear_volume_disc"][-1] for r in (one, two)]
    assert 100.0 * (1.0 - volumes[1] / volumes[0]) == pytest.approx(0.37, abs=0.05)
    assert two.history["wear_volume_counter"][-1] == pytest.approx(K_COUNTER * F * L, rel=1e-10)
    pressure = two.snapshot(-1).pressure
    middle = pressure.shape[0] // 2
    across, along = pressure[middle], pressure[:, middle]
    inside = np.flatnonzero(across > 0)[2:-2]  # cells at the very edge have just come into contact
    assert across[inside].max() / across[middle] - 1.0 == pytest.approx(0.013, abs=0.004)
    assert np.ptp(along[np.flatnonzero(along > 0)[2:-2]]) < 0.002 * along[middle]


def test_unstable_steps_are_refused_and_if_forced_keep_all_volumes(device: str) -> None:
    """C_W = 16/(3π) at 0.3 mm: volumes and depths are perfect, the area is chaos."""
    unstable = {"contact.bulk_stiffness": "area"}
    with pytest.raises(InputError, match=r"beyond the explicit stability limit 2/\(k K\) = 0\.274 mm.*force"):
        Study.load("v1").replace(unstable)
    forced = smooth_model(device, "v1", ("contact.bulk_stiffness", "area"), ("stepping.force", True)).history
    stable = smooth_model(device).history
    for name in ("wear_volume_counter", "wear_volume_disc", "wear_depth_disc", "patch_along"):
        assert_allclose(forced[name][-1], stable[name][-1], rtol=1e-3)
    late = stable["distance"] > 0.5 * L
    missing = 1.0 - forced["area_contact"][late] / stable["area_contact"][late]
    assert missing.mean() > 0.2
    assert missing.max() > 0.4


def test_a_foundation_that_follows_the_patch(device: str) -> None:
    """K_N = C_W E*/a of the area in contact: starts as Hertz's, ends as that of the final patch."""
    study = Study.load("v1").replace(
        {"contact.bulk_update": "updated", "stepping.scheme": "implicit", "stepping.increment": "3 mm"}
    )
    result = run(study, device=device, plots=False)
    assert study.hertz is not None
    history = result.history
    a = math.sqrt(history["area_contact"][-2] / math.pi)
    stiffness = 3.0 / math.pi * study.hertz.modulus / a
    assert study.contact_task.bulk_stiffness_at(a) == pytest.approx(stiffness, rel=1e-12)
    # p = K_N (δ − g) before the step's own wear: with p, g and δ of the last step K_N can be read off.
    last = result.snapshot(-1)
    where = np.unravel_index(last.pressure.argmax(), last.pressure.shape)
    overlap = history["approach"][-1] - last.gap[where]
    assert last.pressure[where] / overlap == pytest.approx(stiffness, rel=1e-6)
    assert stiffness < 0.1 * study.pair.stiffness


@pytest.mark.parametrize(
    "law",
    [
        {
            "wear.law": "running-in",
            "wear.running_in": "100 mm",
            "wear.initial_counter": "9.400000001e-4 mm^3/N/m",
        },
        {"wear.distance_factor": "radial"},
    ],
    ids=["running-in", "radial"],
)
def test_a_foundation_follows_the_patch_whatever_the_law(law: dict[str, str], device: str) -> None:
    """Laws of cell by cell are stepped apart from the others: K_N follows the area in contact there too."""
    study = Study.load("v1").replace(
        {
            "contact.bulk_update": "updated",
            "stepping.scheme": "implicit",
            "stepping.increment": "10 mm",
            "sliding.distance": "300 mm",
        }
    )
    uniform, other, fixed = (
        run(each, device=device, plots=False).history["approach"]
        for each in (study, study.replace(law), study.replace({"contact.bulk_update": "initial", **law}))
    )
    if "wear.law" in law:  # all but the same law
        np.testing.assert_allclose(other, uniform, rtol=1e-6)
    stiff = (uniform if "wear.law" in law else other)[-1]
    assert abs(fixed[-1] / stiff - 1.0) > 5e-4
