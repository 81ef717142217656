"""A tangential traction within friction's bound is found on a half-space, as a device's program.

It minimises ½ q·Aq − q·(e + D) subject to |q| ≤ c in every cell, under a force Σ q or at a rigid displacement
D. Conjugate gradients follow free cells in both components and tied ones, whose |q| = c and which slip along
q, along their circles (compare Zhao, Vollebregt and Oosterlee 2014, DIAM report 14-02). What holds a tied
cell, the multiplier λ = slip/c, counts as the circle's curvature, and in the preconditioner M as
w M w, w = 1/√(1 + λ m) with m a quarter of the largest of M: without it the search does not end.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import warp as wp

from warpwear import lazy
from warpwear.contact.half_space.filters import filter_of
from warpwear.contact.half_space.influence import (
    BOUNDARIES,
    free_coefficients,
    padded_shape,
    periodic_spectrum,
)
from warpwear.contact.half_space.lines import line_quarter
from warpwear.contact.half_space.transforms import Filter, Grids
from warpwear.engine.executor import Executor, Field, arguments
from warpwear.engine.program import Program
from warpwear.errors import ConvergenceError
from warpwear.grid import FloatArray, Grid
from warpwear.kernels.half_space import shear as kernels
from warpwear.kernels.half_space.shear import ShearFlag
from warpwear.kernels.half_space.solve import CONVERGED

fft = lazy.module("scipy.fft")

#: Part of the largest response of the preconditioner by which multipliers weigh in it.
STRENGTH = 0.25
#: Smaller differences of displacements, relative to the largest, are those of the last digits.
ROUNDING = 64.0 * float(np.finfo(np.float64).eps)
#: Part of its bound below which a traction is inside it.
ON_CIRCLE = 1.0e-13
MAX_ITERATIONS = 1000
Pair = tuple[float, float]


class ShearInfluence:
    """Applies what tangential tractions displace, and an approximate inverse, to fields of vectors.

    modulus: E* [MPa]. excess: B E*, with B = Σ ν/(2G): u_x by q_x is that by a pressure, 1/(π E* r), and
    B x²/(π r³), by q_y B xy/(π r³) (Johnson, Contact Mechanics, 1985, section 3.6). boundary: as of
    `influence.Influence`; "line" of one column alone. axes: 1 to leave q_y and u_y out.
    """

    def __init__(
        self, executor: Executor, *, modulus: float, excess: float, boundary: str, axes: int
    ) -> None:
        grid = executor.grid
        base = periodic_spectrum(grid, modulus, rows=grid.nx // 2 + 1)
        far, far_shape = _tensor(grid, base, excess), padded_shape(grid, BOUNDARIES[boundary])
        base[0, 0] = 3.0 * base.max()  # about that of a uniform traction
        inverse = 1.0 / base
        near = _tensor(grid, inverse, -excess / (1.0 + excess))
        if boundary == "free":
            far = _free_tensor(grid.cell, modulus, excess, far_shape)
        elif boundary == "line":
            far = line_quarter(grid.cell, modulus, far_shape, grid.nx * grid.cell)[np.newaxis]
        #: By which multipliers weigh in the preconditioner [MPa/mm].
        self.strength = STRENGTH * float(inverse.max())
        self._part = slice(0, None if axes == 2 else grid.nx)
        self._lines = [
            wp.zeros(rows // 2 + 1, dtype=wp.float64, device=executor.device)
            for rows in (far_shape[0], grid.nx)
        ]
        grids = Grids.whole(executor, 2) if axes == 2 else None

        def filter_by(tables: FloatArray, shape: tuple[int, int], kind: Any) -> Filter:
            return filter_of(executor, tables if axes == 2 else tables[0], shape, kind, grids=grids)

        self._far, self._near = filter_by(far, far_shape, np.float64), filter_by(near, grid.shape, np.float32)

    def add_response(self, program: Program, field_in: Field, field_out: Field) -> None:
        """Add to a program: displacement [mm] under a traction [MPa]."""
        self._far.add_to(program, field_in[self._part], self._lines[0], field_out[self._part])

    def add_inverse(self, program: Program, field: Field) -> None:
        """Add to a program: about the traction [MPa] of a displacement [mm], in place."""
        self._near.add_to(program, field[self._part], self._lines[1], field[self._part])


def _tensor(grid: Grid, base: FloatArray, excess: float) -> FloatArray:
    """Return base × (1 + excess × what lies across the waves), as xx, xy (0 of the shortest) and yy."""
    q_x = 2.0 * math.pi * np.fft.fftfreq(grid.nx, grid.cell)[: len(base), np.newaxis]
    q_y = 2.0 * math.pi * np.fft.rfftfreq(grid.ny, grid.cell)
    square = q_x**2 + q_y**2
    square[0, 0] = math.inf
    xy = -np.abs(q_x) * q_y * excess / square
    xy[2 * np.arange(len(base)) == grid.nx] = 0.0
    xy[:, 2 * np.arange(q_y.size) == grid.ny] = 0.0
    return np.stack(
        [base * (1.0 + excess * q_y**2 / square), base * xy, base * (1.0 + excess * q_x**2 / square)]
    )


def _free_tensor(cell: float, modulus: float, excess: float, shape: tuple[int, int]) -> FloatArray:
    """Return responses of modes on an even shape [mm/MPa], quarters as xx, xy and yy."""
    rows, columns = shape[0] // 2 + 1, shape[1] // 2 + 1
    even = [
        fft.dctn(free_coefficients(cell, modulus, rows, columns, parts=parts), type=1, overwrite_x=True)
        for parts in ((1.0, 1.0 + excess), (1.0 + excess, 1.0))
    ]
    corners = -np.hypot(*np.ix_(*(cell * (np.arange(1, n) - 0.5) for n in (rows, columns))))
    coefficients = np.diff(np.diff(corners, axis=0), axis=1) * (excess / (math.pi * modulus))
    odd = np.zeros((rows, columns))
    odd[1:-1, 1:-1] = -fft.dstn(coefficients, type=1)
    return np.stack([even[0], odd, even[1]])


@dataclass(frozen=True)
class Sheared:
    """Holds a traction that a search has found, and the slip of the increment: shape (2, nx, ny)."""

    traction: FloatArray  # [MPa]
    slip: FloatArray  # [mm]
    level: Pair  # rigid displacement of the increment [mm]
    violation: float
    allowed: float
    scale: float  # that violations count over [mm]
    iterations: int


class ShearSearch:
    """Looks for tangential tractions under one operator. tolerance: of violations, over the scale."""

    def __init__(self, executor: Executor, operator: ShearInfluence, *, tolerance: float) -> None:
        self._executor, self._operator = executor, operator
        self._allowed = max(tolerance, ROUNDING)
        device, grid = executor.device, executor.grid
        vectors = "traction", "start", "response", "gradient", "change", "trial", "way"
        self._shear = arguments(
            kernels.Shear,
            device,
            **{name: executor.zeros(2 * grid.nx) for name in vectors},
            tie=executor.zeros(),
            bound=executor.zeros(),
            table=(kernels.LINES, executor.slots_of(grid.nx)),
            flags=len(ShearFlag),
        )
        self._program = self._make_program()

    def solve(
        self,
        bound: FloatArray,
        *,
        start: FloatArray,
        last: FloatArray,
        force: Pair | None,
        displacement: Pair,
    ) -> Sheared:
        """Find the traction of an increment.

        bound: c, shape (nx, ny) [MPa]. last: traction before, and start: what else the surfaces were
        displaced by, of shape (2, nx, ny). force: Σ q along both axes [MPa]; None: at a displacement [mm].
        """
        shear, executor = self._shear, self._executor
        for field, values in ((shear.bound, bound), (shear.traction, last), (shear.start, start)):
            executor.fill(field, values.reshape(-1, executor.grid.ny))
        numbers = shear.numbers.numpy()
        numbers[0] = np.zeros((), dtype=numbers.dtype)
        members: dict[str, Any] = {
            "tolerance": self._allowed,
            "most": MAX_ITERATIONS,
            "strength": self._operator.strength,
        }
        members |= {"forced": force is not None, "force": force or (0.0, 0.0), "level": displacement}
        for name, value in members.items():
            numbers[name][0] = value
        shear.numbers.assign(numbers)
        self._program.run()
        numbers = shear.numbers.numpy()[0]
        if numbers["status"] != CONVERGED:
            raise ConvergenceError(
                f"the tangential traction did not converge in {numbers['iteration']} iterations: slip "
                f"conditions are violated by {numbers['violation']:.3g} of what friction's bound displaces "
                f"(allowed {self._allowed:g}), and {numbers['missed']:.3g} of the largest force is missed."
            )
        level = numbers["level"]
        traction, start, response = (
            executor.to_numpy(field).reshape(2, *executor.grid.shape).copy()
            for field in (shear.traction, shear.start, shear.response)
        )
        slip = start - response + np.reshape(level, (2, 1, 1))
        return Sheared(
            traction,
            np.where(bound > 0.0, slip, 0.0),
            (float(level[0]), float(level[1])),
            violation=float(numbers["violation"]),
            allowed=self._allowed,
            scale=float(numbers["scale"]),
            iterations=int(numbers["iteration"]),
        )

    def _make_program(self) -> Program:
        """Make the program: where the search begins, and an iteration, until a decision ends it."""
        program, shear, respond = Program(self._executor), self._shear, self._operator.add_response
        for kernel in (kernels.starts, kernels.scale):
            respond(program, shear.traction, shear.response)
            program.launch(kernel, shear)
        program.decide(kernels.begin, shear)
        self._look(program)
        with program.loop(shear.flags, ShearFlag.SEARCHING):
            with program.branch(shear.flags, ShearFlag.PRECONDITIONS):
                self._operator.add_inverse(program, shear.trial)
            program.launch(kernels.descends, shear)
            program.decide(kernels.aim, shear)
            program.launch(kernels.aims, shear)
            respond(program, shear.way, shear.response)
            program.launch(kernels.curves, shear)
            program.decide(kernels.go, shear)
            program.launch(kernels.goes, shear)
            program.decide(kernels.arrive, shear)
            self._look(program)
        return program

    def _look(self, program: Program) -> None:
        """Shift the traction until it carries the force, and judge what slips under it."""
        shear = self._shear
        with program.loop(shear.flags, ShearFlag.SHIFTING):
            program.launch(kernels.shifts, shear)
            program.decide(kernels.shift, shear)
        self._operator.add_response(program, shear.traction, shear.response)
        program.launch(kernels.levels, shear)
        program.decide(kernels.level, shear)
        program.launch(kernels.slips, shear)
        program.decide(kernels.judge, shear)
