"""The certificate beside one reckoned apart, on random problems: right pressures, and pressures spoilt.

What is reckoned here shares no code with the product: displacements are sums over transforms of NumPy or over
the closed form of a square, and the least bound is found by trying every level.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from warpwear import ConvergenceError, solve_contact
from warpwear.contact.certificate import Certificate, Certifier
from warpwear.contact.half_space.search import NO_CAP, Search
from warpwear.contact.half_space.solver import BoundedPressure, HalfSpace, HalfSpaceContact
from warpwear.engine.executor import Executor, arguments
from warpwear.engine.program import Program
from warpwear.grid import FloatArray, Grid
from warpwear.kernels.cells import PADDING
from warpwear.kernels.half_space.solve import Fields, SearchRules
from warpwear.laws.patches import Patches
from warpwear.models.patches.half_space import PatchInfluence

#: On a GPU the transforms need their library.
pytestmark = pytest.mark.transforms

MODULUS = 2.5
#: As the product has them; between these factors of what is allowed the digits decide.
LOAD, BAND = 2e-12, (1.0 - 1e-3, 1.0 + 1e-3)
QUICK, ALL = 40, 500


@dataclass
class Problem:
    """A random problem: one grid, or patches with loads of their own."""

    gaps: FloatArray  # (parts, nx, ny)
    cell: float
    boundary: str
    hardness: float
    fractions: FloatArray | None  # of the hardness, shape of the gaps
    own: float
    streak: float
    window: int | None
    asked: FloatArray | None  # mean pressure of each part
    approach: float | None
    tolerance: float

    @property
    def caps(self) -> FloatArray:
        fractions = np.ones_like(self.gaps) if self.fractions is None else self.fractions
        return self.hardness * fractions

    def displaced(self, p: FloatArray) -> FloatArray:
        """Displacement of one part under its pressure."""
        nx, ny = p.shape
        if self.boundary == "periodic":
            kx, ky = (2 * np.pi * np.fft.fftfreq(n, self.cell) for n in (nx, ny))
            q = np.sqrt(kx[:, None] ** 2 + ky**2)
            q[0, 0] = np.inf
            found = np.fft.ifft2(np.fft.fft2(p) * 2.0 / (MODULUS * q)).real
        else:
            x, y = ((np.arange(2 * n) - n) * self.cell for n in (nx, ny))
            a = 0.5 * self.cell
            kernel = np.zeros((2 * nx, 2 * ny))
            for u, signs in ((x[:, None] + a, 1), (x[:, None] - a, -1)):
                for v, sign in ((y + a, signs), (y - a, -signs)):
                    r = np.hypot(u, v)
                    kernel += sign * (u * np.arctanh(v / r) + v * np.arctanh(u / r))
            kernel /= np.pi * MODULUS
            padded = np.zeros_like(kernel)
            padded[:nx, :ny] = p
            spectrum = np.fft.fft2(padded) * np.fft.fft2(np.fft.ifftshift(kernel))
            found = np.fft.ifft2(spectrum).real[:nx, :ny]
        return found + self.own * p + self.streak * self._mean_twice(p)

    def _mean_twice(self, p: FloatArray) -> FloatArray:
        nx = p.shape[0]
        if self.window is None or self.window >= nx:
            return np.broadcast_to(p.mean(axis=0), p.shape)
        half = self.window // 2
        weights = np.full(2 * half + 1, 1.0)
        if self.window % 2 == 0:
            weights[[0, -1]] = 0.5
        weights /= self.window
        room = 2 * half
        wide = np.zeros((nx + 2 * room, p.shape[1]))
        wide[room : room + nx] = p
        mode = "wrap" if self.boundary == "periodic" else "constant"
        if mode == "wrap":
            wide = np.pad(p, ((room, room), (0, 0)), mode="wrap")
        for _ in range(2):
            wide = np.apply_along_axis(np.convolve, 0, wide, weights, mode="same")
        return wide[room : room + nx]


def problem(seed: int) -> Problem:
    """Everything about it is drawn."""
    draw = np.random.default_rng(seed)
    rows = bool(draw.random() < 0.2)
    side = int(draw.integers(4, 10))
    shape = (side, side) if rows else (int(draw.integers(5, 25)), int(draw.integers(4, 22)))
    parts = int(draw.choice([1, 4, 9])) if rows else 1
    gaps = draw.standard_normal((parts, *shape))
    for _ in range(int(draw.integers(0, 3))):  # smoother
        gaps = gaps + np.roll(gaps, 1, axis=1) + np.roll(gaps, 1, axis=2)
    gaps = gaps * 10.0 ** draw.uniform(-3, 1)
    height = gaps.std()
    boundary = str(draw.choice(["periodic", "free"]))
    cell = 10.0 ** draw.uniform(-1, 1)
    if boundary == "free" and draw.random() < 0.5:  # a ball
        i, j = (np.arange(n) - 0.5 * n for n in shape)
        gaps = gaps + height * draw.uniform(0.1, 3.0) * (i[:, None] ** 2 + j**2) / shape[0]
    elastic = MODULUS * height / (cell * max(shape))  # pressure that flattens it, about
    hardness = math.inf if draw.random() < 0.35 else elastic * 10.0 ** draw.uniform(-2, 1.5)
    fractions = None
    if math.isfinite(hardness) and draw.random() < 0.4:
        fractions = np.where(draw.random(gaps.shape) < 0.5, 1.0, draw.uniform(0.3, 1.0))
    worn, slides = draw.random() < 0.4, draw.random() < 0.3 and not rows
    soft = cell / MODULUS * 10.0 ** draw.uniform(-1, 1)
    asked, approach = None, None
    if not rows and draw.random() < 0.2:
        lowest, mean = gaps.min(), gaps.mean()
        approach = float(lowest + draw.uniform(0.1, 0.8) * (mean - lowest))
    else:
        most = 0.95 * hardness * (0.3 if fractions is not None else 1.0)
        asked = np.minimum(
            elastic * 10.0 ** draw.uniform(-2, 0.3, parts), most * draw.uniform(0.1, 1.0, parts)
        )
    return Problem(
        gaps,
        cell,
        boundary,
        hardness,
        fractions,
        soft if worn else 0.0,
        soft if slides else 0.0,
        int(draw.integers(2, 9)) if slides and draw.random() < 0.7 else None,
        asked,
        approach,
        10.0 ** draw.uniform(-9, -3),
    )


def certificate_of(
    solver: BoundedPressure,
    gap: Any,
    contact: HalfSpaceContact,
    load: FloatArray | None,
    scale: Any,
    **cells: Any,
) -> Certificate:
    """The product's word on a pressure as it stands, at the approaches of a contact."""
    solver.operator.respond(solver.pressure_field, solver.displacement())
    fields = {"pressure": solver.pressure_field, "gap": gap, "response": solver.displacement()}
    fields |= {"cap": NO_CAP, **{name: cell for name, cell in cells.items() if cell is not None}}
    proof = Certifier(contact.executor, arguments(Fields, **fields), groups=contact.approaches.size)
    return proof.at(load=load, approach=contact.approaches, scale=scale, allowed=contact.allowed)


class Solved:
    """A problem solved by the product."""

    def __init__(self, what: Problem, device: str) -> None:
        self.what = what
        parts, nx, ny = what.gaps.shape
        self._rows = what.asked is not None and (parts > 1 or (nx == ny and what.asked.size > 1))
        law: dict[str, Any] = {"hardness": what.hardness, "tolerance": what.tolerance}
        self.solver: BoundedPressure
        if self._rows:
            across = math.isqrt(parts)
            corners = [nx * c.ravel().astype(np.int32) for c in np.indices((across, across))]
            self.patches = Patches(Grid(nx * across, nx * across, what.cell), nx, nx, *corners)
            self.executor = Executor(self.patches.grid, device=device)
            influence = PatchInfluence(self.executor, self.patches, modulus=MODULUS, boundary=what.boundary)
            self.solver = BoundedPressure(self.executor, influence, **law)
        else:
            self.executor = Executor(Grid(nx, ny, what.cell), device=device)
            self.solver = HalfSpace(self.executor, modulus=MODULUS, boundary=what.boundary, **law)
        self.gap = self._field(what.gaps, PADDING)
        self.fractions = None if what.fractions is None else self._field(what.fractions, 1.0)
        options: dict[str, Any] = {"compliance": what.own}
        if not self._rows:
            options |= {"streak_compliance": what.streak, "streak_window": what.window}
        if what.approach is not None:
            options["approach"] = what.approach
        else:
            assert what.asked is not None
            options["mean_pressure"] = what.asked if self._rows else float(what.asked[0])
        self.contact: HalfSpaceContact = self.solver.solve(self.gap, cap_ratio=self.fractions, **options)
        self.pressure = self._parts_of(self.contact.pressure)

    def _stored(self, values: FloatArray, padding: float) -> FloatArray:
        if not self._rows:
            return values[0]
        parts, n, _ = values.shape
        rows = np.full((parts, n, self.patches.vectors * 8), padding)
        rows[:, :, :n] = values
        return rows.reshape(parts, -1)

    def _field(self, values: FloatArray, padding: float) -> Any:
        return self.executor.field(self._stored(values, padding), padding=padding)

    def _parts_of(self, field: FloatArray) -> FloatArray:
        parts, nx, ny = self.what.gaps.shape
        return field.reshape(parts, nx, -1)[:, :, :ny].copy()

    def certify(self, pressure: FloatArray) -> Certificate:
        """The product's word on a pressure, at the approach that was found."""
        what = self.what
        self.executor.fill(self.solver.pressure_field, self._stored(pressure, 0.0))
        load = None if what.asked is None else what.asked * what.gaps[0].size
        return certificate_of(
            self.solver,
            self.gap,
            self.contact,
            load,
            what.gaps.reshape(len(what.gaps), -1).std(axis=1),
            cap=what.hardness,
            cap_ratio=self.fractions,
        )


@dataclass
class Verdict:
    """The word of this file on a pressure."""

    violation: float  # over what is allowed
    load: float
    inside: bool
    gap: float
    energy: float
    noise: float  # rounding of the gap

    @property
    def passes(self) -> bool:
        return self.inside and self.load <= LOAD and self.violation <= 1.0

    @property
    def is_close(self) -> bool:
        return BAND[0] < self.violation < BAND[1] or BAND[0] < self.load / LOAD < 4.0


def judged(what: Problem, pressure: FloatArray, levels: FloatArray) -> Verdict:
    violation = load = gap = energy = noise = 0.0
    for n, (p, g, cap) in enumerate(zip(pressure, what.gaps, what.caps, strict=True)):
        t = what.displaced(p) + g
        off = t - levels[n]
        wrong = np.where(p > 0.0, np.where(p < cap, np.abs(off), off), -off).max()
        violation = max(violation, float(wrong) / (what.tolerance * g.std())) if wrong == wrong else math.nan
        if what.asked is not None:
            load = max(load, abs(math.fsum(p.ravel()) / (what.asked[n] * p.size) - 1.0))
        tries = t.ravel() if math.isfinite(what.hardness) else [t.min()]
        room = cap - p if math.isfinite(what.hardness) else np.zeros_like(p)
        gap += min(
            (float((p * np.maximum(t - x, 0)).sum() + (room * np.maximum(x - t, 0)).sum()) for x in tries),
            default=0.0,
        )
        energy += float((0.5 * p * (t - g) + p * g).sum())
        noise += 1e-13 * float((np.abs(p) * np.abs(t)).sum() + np.abs(room).max() * np.abs(t).sum())
        if what.boundary == "free":  # two formulas of the coefficients: corners that cancel are rounded
            noise += 1e-14 * float(np.abs(p).sum() * np.abs(t - g).max())
    area = what.cell**2
    inside = bool((pressure >= 0.0).all() and (pressure <= what.caps).all())
    return Verdict(violation, load, inside, gap * area, energy * area, noise * area)


def spoilt(pressure: FloatArray, caps: FloatArray, draw: np.random.Generator) -> FloatArray:
    """A pressure that someone or something has changed, by little or much."""
    p, size = pressure.copy(), 10.0 ** draw.uniform(-13, 0)
    flat, mean = p.reshape(-1), pressure.mean()
    some = np.flatnonzero(flat > 0.0)
    match draw.integers(0, 8):
        case 0:
            p *= 1.0 + size
        case 1:  # from one cell to another
            one, other = draw.choice(some), draw.integers(0, flat.size)
            moved = size * flat[one]
            flat[one] -= moved
            flat[other] += moved
        case 2:
            flat[draw.integers(0, flat.size)] = -size * mean
        case 3:
            flat[draw.choice(some)] = min(caps.max() * (1.0 + size), 1e3 * mean)
        case 4:
            p = np.roll(p, 1, axis=1)
        case 5:
            p = np.clip(p * (1.0 + size * draw.standard_normal(p.shape)), 0.0, caps)
            p *= pressure.sum() / p.sum()
        case 6:
            flat[draw.integers(0, flat.size)] = math.nan
        case _:
            p[:] = mean
    return p


def check(seed: int, device: str) -> tuple[int, int]:
    """Solve a problem; the product and this file agree on it. How many spoilt ones passed, and failed."""
    what, draw = problem(seed), np.random.default_rng(10**6 + seed)
    solved = Solved(what, device)
    contact, given = solved.contact, solved.contact.certificate
    assert given is not None
    own = judged(what, solved.pressure, contact.approaches)
    assert not given.fault
    assert own.inside
    assert own.load <= LOAD
    assert own.violation <= 1.0 + 1e-6, "none passes that should not"
    assert given.energy_gap == pytest.approx(own.gap, rel=1e-6, abs=own.noise)
    if what.approach is None:
        # The bound holds: a pressure that is nearer to the solution has no less energy than it says.
        what.tolerance *= 1e-3
        nearer = judged(what, Solved(what, device).pressure, contact.approaches)
        what.tolerance *= 1e3
        assert own.energy - nearer.energy <= own.gap + own.noise
    passed = failed = 0
    for _ in range(12):
        pressure = spoilt(solved.pressure, what.caps, draw)
        found, expected = solved.certify(pressure), judged(what, pressure, contact.approaches)
        if not expected.is_close:
            assert (found.fault == "") == expected.passes, (seed, found, expected)
            passed, failed = passed + expected.passes, failed + (not expected.passes)
        if np.isfinite(pressure).all() and expected.inside:
            assert found.energy_gap == pytest.approx(expected.gap, rel=1e-6, abs=expected.noise)
    return passed, failed


@pytest.mark.parametrize("share", range(4))
def test_random_problems(share: int, device: str) -> None:
    found = np.array([check(seed, device) for seed in range(share, QUICK, 4)])
    assert found[:, 0].sum() > 0
    assert found[:, 1].sum() > 50


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(QUICK, ALL))
def test_more_random_problems(seed: int, device: str) -> None:
    check(seed, device)


@pytest.mark.parametrize("law", [{"modulus": 2.0}, {"stiffness": 3.0}, {}])
@pytest.mark.parametrize("hardness", [0.4, None])
def test_every_array_contact_is_certified_in_the_units_of_the_caller(
    law: dict[str, float], hardness: float | None
) -> None:
    if not law and hardness is None:
        pytest.skip("the bearing area needs a hardness")
    heights = np.random.default_rng(3).standard_normal((12, 9))
    one = solve_contact(heights, cell=0.5, mean_pressure=0.05, hardness=hardness, **law)
    scaled = {name: 1e6 * value / (1e3 if name == "stiffness" else 1.0) for name, value in law.items()}
    other = solve_contact(
        1e3 * heights,
        cell=500.0,
        mean_pressure=0.05e6,
        hardness=None if hardness is None else 1e6 * hardness,
        **scaled,
    )
    for contact, energy in ((one, 1.0), (other, 1e15)):
        p, t = contact.pressure, contact.gap
        levels = t.ravel() if hardness else [t.min()]
        room = np.zeros_like(p) if hardness is None else contact.hardness - p
        least = min((p * np.maximum(t - x, 0) + room * np.maximum(x - t, 0)).sum() for x in levels)
        assert contact.certificate.energy_gap == pytest.approx(
            least * contact.cell**2, rel=1e-3, abs=1e-14 * energy
        )
        assert contact.residual == contact.certificate.violation <= 1e-6


def around_searches(
    monkeypatch: pytest.MonkeyPatch, before: Callable[[], object], after: Callable[[], object]
) -> None:
    """Do something before and after every search from here on."""
    search_alone = Search._search

    def search(self: Search, program: Program) -> None:
        program.call(before)
        search_alone(self, program)
        program.call(after)

    monkeypatch.setattr(Search, "_search", search)


def test_what_a_search_wrongly_believes_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its gradients shall be off by a millionth of the rms height from the first step on."""
    grid = Grid(16, 12, 0.5)
    gap = np.random.default_rng(1).standard_normal(grid.shape)
    with Executor(grid) as executor:
        solver = HalfSpace(executor, modulus=MODULUS, tolerance=1e-8)
        field = executor.field(gap)

        def move(by: float) -> None:
            executor.to_numpy(field)[0, :] += by

        around_searches(monkeypatch, lambda: move(1e-6), lambda: move(-1e-6))
        with pytest.raises(
            ConvergenceError, match=r"cannot be certified: complementarity .* 1\.\de-06 of the rms"
        ):
            solver.solve(field, mean_pressure=0.3)
        assert not solver.started


@pytest.mark.parametrize("boundary", ["periodic", "free"])
def test_responses_in_single_precision_do_not_reach_the_result(boundary: str) -> None:
    """A search knows its gradient to a part of what is allowed; left alone, rounding would mislead it."""
    grid = Grid(128, 128, 0.5)
    gap = np.random.default_rng(1).standard_normal(grid.shape)
    off = []
    for drift in (SearchRules.drift, math.inf):
        with Executor(grid) as executor:
            solver = HalfSpace(
                executor,
                modulus=MODULUS,
                boundary=boundary,
                tolerance=1e-8,
                max_iterations=99,
                rules=SearchRules(drift=drift),
            )
            asked, field = np.full(1, 0.3 * grid.cells), executor.field(gap)
            contact = solver.solve(field, mean_pressure=0.3, certified=False)
            certificate = certificate_of(solver, field, contact, asked, gap.std())
        off.append(abs(certificate.violation - contact.violation))
    assert off[0] <= 0.2e-8
    assert off[1] > 0.2e-8


def test_a_search_that_has_drifted_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    grid = Grid(16, 12, 0.5)
    gap = np.random.default_rng(1).standard_normal(grid.shape)
    with Executor(grid) as executor:
        solver = HalfSpace(executor, modulus=MODULUS, tolerance=1e-8)
        field, times = executor.field(gap), iter(range(9))

        def move() -> None:
            executor.to_numpy(field)[0, :] += 0.0 if next(times) else 1e-6

        around_searches(monkeypatch, move, lambda: executor.fill(field, gap))
        contact = solver.solve(field, mean_pressure=0.3)
        assert next(times) == 2
        assert contact.certificate is not None
        assert contact.certificate.violation <= 1e-8
