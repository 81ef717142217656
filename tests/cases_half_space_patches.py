"""Patches on the half-space: a layout, gaps, a solver and a model to be advanced, shared by tests."""

from typing import Any

import numpy as np
from cases_half_space import MODULUS, dense_free, dense_periodic, rough

from warpwear import Study
from warpwear.contact.half_space.solver import BoundedPressure, HalfSpaceContact
from warpwear.engine.executor import Executor
from warpwear.grid import FloatArray, Grid
from warpwear.kernels.cells import PADDING
from warpwear.laws.patches import Patches
from warpwear.models.patches.half_space import HalfSpacePatches, PatchInfluence
from warpwear.study.surface import surface_in

SIDE, ACROSS = 5, 2  # neither a multiple of the lanes of a vector
ONE = Grid(SIDE, SIDE, 0.5)
DOMAIN = Grid(SIDE * ACROSS, SIDE * ACROSS, 0.5)
CORNERS = [SIDE * c.ravel().astype(np.int32) for c in np.indices((ACROSS, ACROSS))]
PATCHES = Patches(DOMAIN, SIDE, SIDE, CORNERS[0], CORNERS[1])
#: Gaps of all patches, shape (patches, SIDE, SIDE); the mean planes differ by as much as the roughness.
GAPS = np.array([1.2 * k + rough(ONE, seed=k, shortest=2) for k in range(PATCHES.count)])
BOUNDARIES = {"periodic": dense_periodic(ONE), "free": dense_free(ONE)}


class Solved:
    """The solver on the patches above."""

    def __init__(self, boundary: str, bulk: float, hardness: float, *, device: str = "cpu") -> None:
        self.executor = Executor(PATCHES.grid, device=device)
        self.influence = PatchInfluence(self.executor, PATCHES, modulus=MODULUS, boundary=boundary)
        self.influence.set_bulk(bulk)
        self.solver = BoundedPressure(self.executor, self.influence, hardness=hardness, tolerance=1e-11)
        rows = np.full((PATCHES.count, SIDE, 8), PADDING)
        rows[:, :, :SIDE] = GAPS
        self.gap = self.executor.field(rows.reshape(PATCHES.count, -1))

    def at(self, **asked: float) -> tuple[HalfSpaceContact, FloatArray]:
        """The contact, and its pressures of shape (patches, SIDE²)."""
        contact = self.solver.solve(self.gap, **asked)
        rows = contact.pressure.reshape(PATCHES.count, SIDE, -1)
        assert not rows[:, :, SIDE:].any()
        return contact, rows[:, :, :SIDE].reshape(PATCHES.count, -1).copy()


QUICK = {
    "contact.law": "half-space",
    "grid.cell": "10 um",
    "grid.extent": "1 mm",
    "disc.synthetic.cut_off": "20 um",  # what such cells resolve
    "sliding.distance": "10 mm",
    "output.snapshots": [],
}
KINDS: dict[str, dict[str, Any]] = {
    "bulk": {},
    "no bulk": {"patches.bulk": "none"},
    "free": {"patches.bulk": "none", "contact.boundary": "free"},
    "bulk that follows, no cap": {
        "contact.bulk_update": "updated",
        "contact.hardness": "inf MPa",
    },
    "some of the area": {"grid.extent": "1.8 mm", "patches.macro_cell": "300 um", "patches.width": "100 um"},
    "loads": {"patches.coupling": "load"},
    "loads of free patches": {"patches.coupling": "load", "contact.boundary": "free"},
    "loads of some of the area, by a foundation that follows": {
        "patches.coupling": "load",
        "contact.bulk_update": "updated",
        "grid.extent": "1.8 mm",
        "patches.macro_cell": "300 um",
        "patches.width": "100 um",
    },
}


def quick(**changes: Any) -> Study:
    """The preset two-scale with QUICK and with these changes, keys with __ for the dot."""
    return Study.load("two-scale").replace(QUICK | {k.replace("__", "."): v for k, v in changes.items()})


class Stepped:
    """A model, to be advanced step by step."""

    def __init__(self, study: Study, *, device: str = "cpu", threads: int | None = None) -> None:
        self.executor = Executor(study.patch_layout.grid, device=device, threads=threads)
        heights = surface_in(study).heights(study.cells.x, study.cells.y)
        self.model = HalfSpacePatches(study.contact_task, study.patch_layout, heights, self.executor)

    def gap(self) -> FloatArray:
        """Of every patch as the model has them, shape (patches, side, side)."""
        patches = self.model.patches
        rows = self.executor.to_numpy(self.model.gap)
        return rows.reshape(patches.count, patches.side, -1)[:, :, : patches.side].copy()
