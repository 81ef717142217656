"""The transition law on the half-space under a disc that moves: each cell wears by K of what it sees."""

from typing import Any

import cases_half_space
import numpy as np
import pytest
from cases_sliding_half_space import (
    CELL,
    FLAT,
    GRID,
    ROWS,
    SHARE,
    Dense,
    contact_of,
    fields_of,
    heights,
    passing,
    study_of,
)
from numpy.testing import assert_allclose

from warpwear.engine.executor import Executor

#: On a GPU the transforms need their library.
pytestmark = pytest.mark.transforms

TRANSITION = {
    "wear.law": "transition",
    "wear.severe_counter": "9.4e-3 mm^3/N/m",
    "wear.severe_disc": "12.7e-3 mm^3/N/m",
    "wear.transition_width": "20 MPa",
}


@pytest.mark.parametrize("changes", [{"wear.transition_pressure": "300 MPa"}, FLAT], ids=["counter", "flat"])
def test_cells_wear_by_the_k_of_the_pressure_that_they_see(changes: dict[str, Any], device: str) -> None:
    """Each step is the contact of the dense matrix whose compliances are K of the pressures that it finds."""
    study = study_of().replace(TRANSITION | {"wear.transition_pressure": "40 MPa"} | changes)
    disc, pieces = heights(), []
    dense = Dense(study, disc.copy())
    with Executor(GRID, device=device) as executor:
        contact = contact_of(study, disc, executor, periodic=True, track_fraction=SHARE)
        for shift, window in ((3, 3), (7, 4), (9, 1), (22, 2), (4, 5)):
            increment, before = window * CELL / SHARE, fields_of(contact, executor)
            step = contact.step(shift, increment, with_pressure=True)
            p, after = step.pressure, fields_of(contact, executor)
            assert p is not None
            seen = GRID.nx if "counter.radius" in changes else window
            mean = np.array([passing(one.reshape(GRID.shape), seen).ravel() for one in np.eye(GRID.cells)])
            pressures = (mean @ p.ravel()).reshape(GRID.shape), p
            lends = [
                share * increment * np.interp(q, *law.over_pressure)
                for share, q, law in zip((1.0, SHARE), pressures, study.wear_laws, strict=True)
            ]
            beneath = (np.arange(GRID.nx) + shift) % ROWS
            gap = dense.counter + passing(before["wear_counter"], seen) - before["disc"][beneath]
            matrix = dense.elastic + np.diag(lends[1].ravel()) + mean.T @ np.diag(lends[0].ravel()) @ mean
            other = cases_half_space.bounded(matrix, gap, step.row["approach"], study.hardness)
            assert_allclose(p, other, atol=1e-8 * study.hardness)
            for body, rows, lent, q in zip(
                ("counter", "disc"), (..., beneath), lends, pressures, strict=True
            ):
                worn = (after[f"wear_{body}"] - before[f"wear_{body}"])[rows]
                assert_allclose(worn, lent * q, rtol=1e-10, atol=1e-16)
            ends = study.wear_laws[0].over_pressure[0]
            pieces.append([np.histogram(q, [1e-9, *ends, np.inf])[0] for q in pressures])
    assert np.max(pieces, axis=(0, 1)).min() > 0  # mild, between and severe
    assert np.max(pieces, axis=0)[:, 1].min() > 0  # K of both bodies changes with the pressure


@pytest.mark.parametrize("load", ["4 N", "12 N"])
def test_volumes_of_a_flat_are_those_of_k_of_its_pressure(load: str) -> None:
    """V = K(p) F L, with p of load over area."""
    study = study_of(contact__load=load).replace(
        TRANSITION | FLAT | {"wear.transition_pressure": "40 MPa", "contact.hardness": "900 MPa"}
    )
    with Executor(GRID) as executor:
        contact = contact_of(study, np.zeros((ROWS, GRID.ny)), executor, periodic=True, track_fraction=SHARE)
        steps = [contact.step(3, increment) for increment in (0.1, 1.0, 0.3)]
    for body, law in zip(("counter", "disc"), study.wear_laws, strict=True):
        k = np.interp(study.contact.load / GRID.area, *law.over_pressure)
        expected = k * study.contact.load * 1.4
        assert steps[-1].row[f"wear_volume_{body}"] == pytest.approx(expected, rel=1e-10)
