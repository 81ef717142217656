"""What the preconditioner extends from free cells to the others, and gathers back."""

import math

import numpy as np
import pytest
from scipy import fft, ndimage

from warpwear.contact.half_space.influence import Influence
from warpwear.contact.half_space.search import Search
from warpwear.contact.half_space.solver import HalfSpace
from warpwear.engine.executor import Executor
from warpwear.engine.program import Program
from warpwear.grid import FloatArray, Grid
from warpwear.kernels.half_space.solve import SearchRules

MODULUS, CAP, LEVEL = 2.0, 1.0, 0.1
#: Less than a tile, over the edges of tiles along both axes, and beyond what eight cells fill.
SHAPES = [(5, 3), (40, 37), (16, 1030), (35, 1029)]


@pytest.fixture(params=[1, 2], ids=["1 thread", "2 threads"])
def threads(request: pytest.FixtureRequest) -> int:
    return int(request.param)


class Drawn:
    """A search on its way: pressures at and between the bounds, some of which want to leave them."""

    def __init__(self, executor: Executor, boundary: str, parted: bool, *, tiled: bool = True) -> None:
        draw, shape = np.random.default_rng(3), executor.grid.shape
        self.caps = CAP * draw.uniform(0.5, 1.0, shape) if parted else np.full(shape, CAP)
        p = np.clip(draw.normal(0.3, 1.0, shape), 0.0, self.caps)
        t = draw.normal(size=shape)
        self.influence = Influence(executor, modulus=MODULUS, boundary=boundary)
        self.influence.set_compliance(0.0, 0.0)
        names = "gap", "pressure", "gradient", "trial", "step", "response"
        self.fields = {name: executor.zeros() for name in names}
        self.search = Search(
            executor,
            self.influence,
            hardness=CAP,
            rules=SearchRules(scattered=0.0, every=1),
            fields=self.fields,
            cap_ratio=executor.field(self.caps / CAP, padding=1.0) if parted else None,
            groups=1,
            tiled=tiled,
        )
        self.search.arguments.groups.numpy()["level"] = LEVEL
        self.program = Program(executor)
        self.search._precondition(self.program)
        executor.to_numpy(self.fields["pressure"])[:] = p
        executor.to_numpy(self.fields["gradient"])[:] = t
        self.free = ((p > 0.0) | (t < LEVEL)) & ((p < self.caps) | (t > LEVEL))
        self.asked = np.where(self.free, t - LEVEL, 0.0)

    def descent(self, executor: Executor) -> FloatArray:
        self.program.run()
        if self.search.arguments.numbers.numpy()["extended"]:
            return np.array(self.search.arguments.fields.gathered.numpy()[:, : executor.grid.ny], dtype=float)
        return np.array(executor.to_numpy(self.fields["trial"]))


def neighbours(influence: Influence) -> FloatArray:
    """Weights from all coefficients of the inverse."""
    nx = influence.near_elastic.shape[0] * 2 - 2
    table = influence.near_elastic[np.minimum(np.arange(nx), nx - np.arange(nx))]
    inverse = np.divide(1.0, table, out=np.zeros_like(table), where=table > 0.0)
    found = fft.irfft2(inverse, s=(nx, 2 * (table.shape[1] - 1)))
    weights = -found[np.ix_([-1, 0, 1], [-1, 0, 1])] / found[0, 0]
    weights[1, 1] = 0.0
    return np.asarray(weights)


@pytest.mark.parametrize("tiled", [True, False])
@pytest.mark.parametrize("parted", [False, True])
@pytest.mark.parametrize("boundary", ["periodic", "free"])
@pytest.mark.parametrize("shape", SHAPES)
def test_the_descent_is_that_of_a_slow_formula(
    shape: tuple[int, int], boundary: str, parted: bool, tiled: bool, threads: int
) -> None:
    with Executor(Grid(*shape, 0.5), threads=threads) as executor:
        drawn = Drawn(executor, boundary, parted, tiled=tiled)
        along, across, corner = drawn.influence.neighbours.numpy()
        weights = np.array([[corner, along, corner], [across, 0.0, across], [corner, along, corner]])
        mode = "wrap" if boundary == "periodic" else "constant"

        def around(values: FloatArray) -> FloatArray:
            return np.asarray(ndimage.convolve(values, weights, mode=mode))

        bound = ~drawn.free
        extended = drawn.asked + bound * around(drawn.asked)
        extended = drawn.asked + bound * around(extended)
        inverse = executor.field(extended)
        program = Program(executor)
        drawn.influence.add_inverse(program, inverse, inverse)
        program.run()
        made = np.array(executor.to_numpy(inverse))
        given = bound * made
        given = given + bound * around(given)
        expected = made + around(given)
        found = drawn.descent(executor)
    scale = np.abs(expected[drawn.free]).max()
    np.testing.assert_allclose(found[drawn.free], expected[drawn.free], atol=3e-6 * scale)


@pytest.mark.parametrize("boundary", ["periodic", "free"])
def test_the_preconditioner_is_symmetric_and_positive(boundary: str) -> None:
    draw, products, values = np.random.default_rng(4), [], []
    with Executor(Grid(24, 20, 0.5)) as executor:
        drawn = Drawn(executor, boundary, False)
        for _ in range(2):
            t = LEVEL + draw.normal(size=drawn.free.shape)
            # cells at a bound that are free stay so
            t = np.where(drawn.free, np.where(drawn.asked < 0.0, -1.0, 1.0) * np.abs(t - LEVEL) + LEVEL, t)
            gradient = executor.to_numpy(drawn.fields["gradient"])
            gradient[:] = np.where(drawn.free, t, gradient)
            values.append(np.where(drawn.free, t - LEVEL, 0.0))
            products.append(np.where(drawn.free, drawn.descent(executor), 0.0))
    own = [float((v * p).sum()) for v, p in zip(values, products, strict=True)]
    assert min(own) > 0.0
    mixed = [float((values[n] * products[1 - n]).sum()) for n in (0, 1)]
    assert mixed[0] == pytest.approx(mixed[1], abs=1e-6 * math.sqrt(own[0] * own[1]))


@pytest.mark.parametrize("boundary", ["periodic", "free"])
@pytest.mark.parametrize("shape", [(64, 64), (150, 98)])
def test_weights_by_few_modes_are_those_of_all(shape: tuple[int, int], boundary: str) -> None:
    with Executor(Grid(*shape, 0.5)) as executor:
        influence = Influence(executor, modulus=MODULUS, boundary=boundary)
        expected = neighbours(influence)
        found = influence.neighbours.numpy().copy()
        influence.set_compliance(10.0, 0.0)
        compliant = influence.neighbours.numpy()
    np.testing.assert_allclose(list(found), [expected[0, 1], expected[1, 0], expected[0, 0]], atol=2e-3)
    assert max(compliant) < 0.2 * max(found), "springs do not feel each other"


@pytest.mark.parametrize("hardness", [math.inf, 0.1])
def test_extended_values_save_iterations(hardness: float) -> None:
    grid = Grid(96, 96, 1.0 / 96)
    spectrum = fft.rfft2(np.random.default_rng(5).normal(size=grid.shape))
    q = np.hypot(fft.fftfreq(grid.nx)[:, np.newaxis], fft.rfftfreq(grid.ny))
    gap = fft.irfft2(np.where(q > 0.0, spectrum * np.maximum(q, 0.02) ** -1.8, 0.0), s=grid.shape)
    gap *= 0.1 / 30.0 / gap.std()  # an rms slope of 0.1

    def iterations(rules: SearchRules) -> int:
        with Executor(grid) as executor:
            solver = HalfSpace(executor, modulus=1.0, hardness=hardness, tolerance=1e-8, rules=rules)
            return solver.solve(executor.field(gap), mean_pressure=0.05).iterations

    assert iterations(SearchRules()) <= 0.8 * iterations(SearchRules(scattered=math.inf))
