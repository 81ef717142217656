"""The shortcut of partial slip against its whole history of tractions, cycle by cycle, on a dense matrix."""

import numpy as np
import pytest
from cases_fretting import FRICTION, YOUNG, sheared
from cases_half_space import MODULUS as OF_CASES
from cases_half_space import dense_free
from scipy.optimize import brentq, lsq_linear

import warpwear
from warpwear.grid import FloatArray

FORCE = 7.2  # [N]


def turned(
    elastic: FloatArray, before: FloatArray, caps: FloatArray, force: float
) -> tuple[FloatArray, FloatArray]:
    """Return traction and slip after an increment to a force [MPa]: least ½ q·Aq − q·(A q₀ + D) in bounds."""
    root = np.linalg.cholesky(elastic).T
    rest = elastic @ before

    def traction(rigid: float) -> FloatArray:
        right = np.linalg.solve(root.T, rest + rigid)
        found = lsq_linear(root, right, bounds=(-caps, caps), method="bvls", tol=1e-15, max_iter=2000)
        return np.asarray(found.x)

    reach = 10.0 * float(np.abs(elastic @ caps).max())
    rigid = brentq(lambda d: traction(d).sum() - force, -reach, reach, xtol=1e-16, rtol=1e-13)
    q = traction(rigid)
    return q, rigid + rest - elastic @ q


@pytest.mark.slow
def test_stick_and_slip_of_the_shortcut_are_those_of_the_whole_history() -> None:
    """At ν = 0 and Λ = 4κμ K p0 N up to about 15, tractions locked in as the ring wears change no cycle."""
    study = sheared(
        20,
        counter__poisson=0.0,
        disc__poisson=0.0,
        wear__counter="2e-5 mm^3/N/m",
        wear__disc="2e-5 mm^3/N/m",
        stepping__growth=2.5,
        output__snapshots=[f"{d} mm" for d in (0.01, 0.1, 1, 10, 50, 100)],
    )
    result = warpwear.run(study)
    area = study.cells.cell_area
    elastic = dense_free(study.cells) * OF_CASES / (0.5 * YOUNG)
    q, loaded, seen = np.zeros(study.cells.cells), False, 0
    for snapshot in result.snapshots:
        pressure = snapshot.pressure.ravel()
        assert snapshot.slip is not None
        here = np.flatnonzero(pressure > 0.0)
        block, caps = elastic[np.ix_(here, here)], FRICTION * pressure[here]
        old = q[here]
        # What was sheared where nothing presses any more has gone.
        for force in (FORCE, -FORCE, FORCE) if not loaded else (FORCE,):
            old, _ = turned(block, old, caps, force / area)
        there, forth = turned(block, old, caps, -FORCE / area)
        back, again = turned(block, there, caps, FORCE / area)
        q, loaded = np.zeros_like(pressure), True
        q[here] = back
        slip = np.abs(forth) + np.abs(again)
        slip[(np.abs(there) < caps * (1.0 - 1e-9)) & (np.abs(back) < caps * (1.0 - 1e-9))] = 0.0
        shortcut = snapshot.slip.ravel()[here]
        np.testing.assert_array_equal(slip > 0.0, shortcut > 0.0)
        assert slip @ pressure[here] == pytest.approx(shortcut @ pressure[here], rel=1e-4)
        np.testing.assert_allclose(slip, shortcut, atol=1e-4 * shortcut.max())
        seen += 1
    assert seen >= 6
    assert result.history["energy"][-1] < 0.7 * result.history["energy"].max()  # the ring has lost load
