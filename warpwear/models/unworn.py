"""Bodies before any wear: where the rows of a field lie, and the gap of a counter-body over a disc."""

import numpy as np
import warp as wp

from warpwear.engine.executor import Arguments, Executor, Field, arguments
from warpwear.engine.program import launch_once
from warpwear.grid import FloatArray
from warpwear.kernels import contact
from warpwear.kernels.cells import Layout
from warpwear.kernels.half_space import passes
from warpwear.laws.form import Form
from warpwear.laws.patches import Patches


def layout_of(executor: Executor, patches: Patches | None = None) -> Arguments:
    """Return where the rows of an executor's fields lie: those of its grid, or patches of a domain."""
    places, vectors = np.stack([np.arange(executor.grid.nx), np.zeros(executor.grid.nx)]), executor.vectors
    if patches is not None:
        places, vectors = np.stack([patches.first_row, patches.first_column]), patches.vectors
    rows: Field = wp.array(places[0].astype(np.int32), device=executor.device)
    columns: Field = wp.array(places[1].astype(np.int32), device=executor.device)
    return arguments(Layout, vectors=vectors, first_row=rows, first_column=columns)


def gap_over(form: Form, heights: FloatArray, executor: Executor, patches: Patches | None = None) -> Field:
    """Return the gap of an unworn counter-body over heights of a disc [mm].

    heights: over the mean plane [mm], shape of the executor's grid; of patches, which are on a grid of their
    own, that of their domain.
    """
    grid, columns = (executor.grid, executor.grid.ny) if patches is None else (patches.domain, patches.side)
    x, y = grid.x, grid.y
    ball = arguments(
        contact.Indenter, cell=grid.cell, x_first=float(x[0]), y_first=float(y[0]), curvature=form.curvature
    )
    beneath = form.beneath(heights, x, y)
    roughness = executor.field(beneath if patches is None else patches.stored(beneath))
    gap, kernel = executor.zeros(), contact.gap
    if executor.expects(passes.unworn_gap):
        kernel = passes.unworn_gap
    launch_once(executor, kernel, columns, ball, layout_of(executor, patches), roughness, gap)
    return gap
