"""A half-space under a ball that slides, its study and its dense twin, for the tests of its steps."""

from dataclasses import dataclass
from typing import Any

import cases_half_space
import numpy as np
import reference

from warpwear import Study
from warpwear.engine.executor import Executor
from warpwear.grid import FloatArray, Grid
from warpwear.models.track.half_space import SlidingHalfSpace

CELL, ROWS = 0.02, 24
GRID = Grid(16, 9, CELL)
SHARE = 0.2
KEEPS = {"sliding.plastic": "keep"}
FLAT = {"counter.radius": "inf mm", "contact.hardness": "200 MPa"}
#: Almost to the last digit, so that it is not the search which differs.
TIGHT = 1.0e-11


def study_of(**changes: Any) -> Study:
    base = {"contact.law": "half-space", "contact.load": "2 N", "contact.hardness": "600 MPa"}
    dotted = {name.replace("__", "."): value for name, value in changes.items()}
    return Study.load("v3-fine").replace(base | {"grid.cell": "20 um"} | dotted)


def heights(rows: int = ROWS) -> FloatArray:
    return np.random.default_rng(5).normal(0.0, 4e-4, (rows, GRID.ny))


def contact_of(study: Study, disc: FloatArray, executor: Executor, **options: Any) -> SlidingHalfSpace:
    contact = SlidingHalfSpace(study.contact_task, disc.copy(), executor, **options)
    contact._half_space.tolerance, contact.on_the_way = TIGHT, None
    return contact


def fields_of(contact: Any, executor: Executor) -> dict[str, FloatArray]:
    return {name: executor.to_numpy(v).copy() for name, v in contact.state.fields.items()}


@dataclass
class Dense:
    """The same contact by a dense matrix and active sets; its bodies are worn in NumPy."""

    study: Study
    disc: FloatArray

    def __post_init__(self) -> None:
        self.boundary = self.study.boundary
        modulus = self.study.pair.effective_modulus
        assert modulus is not None
        of_unit = {"free": cases_half_space.dense_free, "periodic": cases_half_space.dense_periodic}
        self.elastic = of_unit[self.boundary](GRID) * cases_half_space.MODULUS / modulus
        self.counter = reference.counter_gap(GRID.x, GRID.y, self.study.counter.radius or np.inf)
        self.wear_counter, self.wear_disc = np.zeros(GRID.shape), np.zeros_like(self.disc)
        self.plastic_disc = np.zeros_like(self.disc)

    def step(self, shift: int, increment: float, approach: float) -> FloatArray:
        """Pressure at an approach, and the wear by it."""
        beneath = (np.arange(GRID.nx) + shift) % ROWS
        of_counter, of_disc = 9.4e-7 * increment, SHARE * 12.7e-7 * increment
        window = round(SHARE * increment / CELL) if self.boundary == "free" else None
        matrix = self.elastic + of_disc * np.eye(GRID.cells)
        matrix += of_counter * cases_half_space.dense_streak(GRID, self.boundary, window)
        hardness = self.study.hardness
        met = self.wear_counter if window is None else averaged(self.wear_counter, window)
        gap = self.counter + met - self.disc[beneath]
        p = cases_half_space.bounded(matrix, gap, approach, hardness)
        below = approach - gap - (matrix @ p.ravel()).reshape(GRID.shape)
        at_cap = p >= hardness * (1.0 - 1e-12)  # the active sets leave it by a digit
        beyond = np.where(at_cap, np.maximum(below, 0.0), 0.0)
        passing = np.broadcast_to(p.mean(axis=0), p.shape) if window is None else averaged(p, window)
        self.wear_counter += of_counter * passing
        self.disc[beneath] -= of_disc * p + beyond
        self.wear_disc[beneath] += of_disc * p
        self.plastic_disc[beneath] += beyond
        return p


def passing(p: FloatArray, window: int) -> FloatArray:
    """Mean of what passes a cell: over a window, or over the line."""
    return averaged(p, window) if window < GRID.nx else np.broadcast_to(p.mean(axis=0), p.shape)


def averaged(p: FloatArray, window: int) -> FloatArray:
    """Mean over the places of a window that moves by as many cells, at midpoints of its cells or between."""
    half = window // 2
    padded = np.pad(p, ((half + 1, half + 1), (0, 0)), mode="symmetric")
    cumulative = np.cumsum(np.vstack([np.zeros((1, p.shape[1])), padded]), axis=0)

    def integral(edge: FloatArray) -> FloatArray:
        low = np.floor(edge).astype(int)
        return np.asarray(cumulative[low] + (edge - low)[:, None] * (cumulative[low + 1] - cumulative[low]))

    middle = np.arange(p.shape[0]) + half + 1.5
    return (integral(middle + 0.5 * window) - integral(middle - 0.5 * window)) / window
