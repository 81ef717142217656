"""Stresses below a contact against Hertz, Hamilton, CONTACT and the equations of elasticity."""

import itertools
import math
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy import fft, linalg

import warpwear
from warpwear.contact.stress.responses import COMPONENTS
from warpwear.contact.stress.stresses import Stresses
from warpwear.grid import FloatArray, Grid

#: Below the middle of a ball's contact, of which radius and largest pressure are 1.
DEPTHS = np.array([0.1, 0.25, 0.48, 1.0, 2.0])


def hertz(n: int, width: float) -> tuple[FloatArray, float]:
    """Return a ball's pressure of unit radius and height on n × n cells of a width, and the cells' width."""
    grid = Grid(n, n, width / n)
    return np.sqrt(np.maximum(1.0 - grid.x[:, np.newaxis] ** 2 - grid.y**2, 0.0)), grid.cell


def on_axis(z: FloatArray, poisson: float) -> tuple[FloatArray, FloatArray]:
    """Radial and normal stress on the axis of a ball's contact (Johnson 1985, eq. 3.45)."""
    radial = -(1.0 + poisson) * (1.0 - z * np.arctan(1.0 / z)) + 0.5 / (1.0 + z**2)
    return radial, -1.0 / (1.0 + z**2)


def below(n: int, width: float, depths: Any, friction: float = 0.0, **options: Any) -> Stresses:
    pressure, cell = hertz(n, width)
    traction = (friction * pressure, None) if friction else None
    given = {"poisson": 0.3, "boundary": "free", **options}
    return warpwear.stresses(pressure, depths, cell=cell, traction=traction, **given)


@pytest.mark.parametrize(("n", "bounds"), [(129, (2e-4, 1e-4)), (257, (5e-5, 2.5e-5))])
def test_on_the_axis_of_a_ball(n: int, bounds: tuple[float, float]) -> None:
    stresses, middle = below(n, 3.0, DEPTHS), n // 2
    xx, yy, zz, *shears = stresses.tensor[:, :, middle, middle]
    radial, normal = on_axis(DEPTHS, 0.3)
    for values, exact in ((xx, radial), (yy, radial), (zz, normal)):
        assert_allclose(values, exact, atol=bounds[0])
    assert_allclose(stresses.shear[:, middle, middle], 0.5 * np.abs(normal - radial), atol=bounds[1])
    assert_allclose(shears, 0.0, atol=1e-14)


@pytest.mark.parametrize(
    ("friction", "field", "largest", "deep"), [(0.0, "shear", 0.310, 0.48), (0.25, "mises", 0.6475, 0.44)]
)
def test_the_largest_below_the_surface(friction: float, field: str, largest: float, deep: float) -> None:
    depths = np.arange(0.36, 0.57, 0.02)
    values = getattr(below(129, 3.0, depths, friction), field).max(axis=(1, 2))
    assert values.max() == pytest.approx(largest, abs=0.002)
    assert depths[values.argmax()] == pytest.approx(deep, abs=0.02001)


def test_much_friction_brings_the_largest_to_the_surface() -> None:
    """Inside at 0.52 a behind the middle; the edge behind has 0.957, which cells resolve slowly."""
    stresses, x = below(257, 2.4, [0.0, 0.1, 0.3, 0.45], friction=0.5), Grid(257, 257, 2.4 / 257).x
    inside = np.hypot(x[:, np.newaxis], x) < 0.9
    values = np.where(inside, stresses.mises, 0.0).max(axis=(1, 2))
    assert values.argmax() == 0
    assert values[0] == pytest.approx(0.917, abs=0.003)
    assert x[np.where(inside, stresses.mises[0], 0.0).argmax() // 257] == pytest.approx(-0.52, abs=0.02)


def test_tension_behind_the_contact_is_found_with_the_root_of_the_cell() -> None:
    """σxx = p₀ ((1 − 2ν)/3 + (4 + ν) π µ/8) at the edge behind (Hamilton 1983, Proc. IMechE 197C, 53)."""
    exact = 0.4 / 3.0 + 4.3 * math.pi * 0.3 / 8.0
    missing = [exact - below(n, 2.4, 0.0, friction=0.3).component("xx").max() for n in (64, 256, 1024)]
    assert missing[0] / exact < 0.3
    for coarse, fine in itertools.pairwise(missing):
        assert coarse / fine == pytest.approx(2.0, abs=0.4)


@pytest.mark.parametrize(("n", "bound"), [(129, 5e-3), (257, 2.5e-3)])
def test_at_the_surface_of_a_sliding_ball(n: int, bound: float) -> None:
    """Hertz (Johnson 1985, eq. 3.43) and shear, linear in x (Hamilton 1983, Proc. IMechE 197C, 53)."""
    friction, poisson, width = 0.3, 0.3, 2.4
    tensor = below(n, width, 0.0, friction).tensor[:, 0]
    grid = Grid(n, n, width / n)
    x, y = np.meshgrid(grid.x, grid.y, indexing="ij")
    r2 = np.where(x**2 + y**2 > 0.0, x**2 + y**2, 1.0)
    inside = x**2 + y**2 < 0.8**2
    root = np.sqrt(np.maximum(1.0 - r2, 0.0))
    part = np.where(x**2 + y**2 > 0.0, (1.0 - 2.0 * poisson) / 3.0 * (1.0 - root**3) / r2, 0.2)
    radial, hoop = part - root, -part - 2.0 * poisson * root
    middle = ~(x**2 + y**2 > 0.0)
    radial[middle] = hoop[middle] = -0.5 - poisson
    cos2 = np.where(middle, 0.5, x**2 / r2)
    slope = -math.pi * friction * x / 8.0
    xx = radial * cos2 + hoop * (1.0 - cos2) + slope * (4.0 + poisson)
    yy = radial * (1.0 - cos2) + hoop * cos2 + slope * 3.0 * poisson
    for values, exact in zip(tensor, (xx, yy), strict=False):
        assert_allclose(values[inside], exact[inside], atol=bound)
    assert_allclose(tensor[2], -hertz(n, width)[0], atol=1e-12)
    assert_allclose(tensor[4], -friction * hertz(n, width)[0], atol=1e-12)


@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_equilibrium(boundary: str) -> None:
    pressure, cell = hertz(129, 3.0)
    loads = {"contact": pressure, "traction": (0.3 * pressure, -0.2 * pressure)}
    depths = 0.5 + np.array([-cell, 0.0, cell])
    stresses = warpwear.stresses(**loads, depths=depths, cell=cell, boundary=boundary, poisson=0.3)
    inner, last = (slice(1, -1), slice(1, -1)), len(depths) // 2
    for axis in "xyz":
        total = np.zeros((127, 127))
        for number, other in enumerate("xyz"):
            name = "".join(sorted(axis + other))
            field = stresses.component(name)
            slopes = np.gradient(field, cell, axis=(number + 1) % 3)
            total += slopes[last][inner]
        assert np.abs(total).max() < 1e-3


#: What CONTACT's example `subsurf` prints of its first case, normal load, and its second, tangential besides
#: (E.A.H. Vollebregt, Vtech CMCC, revision 2707, Apache-2.0): field, place x, y, z, value.
CONTACT = {
    "normal": [
        ("hydrostatic", (0.0, 0.0, 0.0), -0.853),
        ("mises", (0.0, 0.0, 0.4), 0.665),
        ("shear", (0.0, 0.0, 0.4), 0.665),
        ("principal", (0.0, 0.0, 1.25), 0.008),
        ("xx", (0.0, 0.0, 0.0), -0.780),
        ("zz", (0.0, 0.0, 0.0), -1.000),
        ("hydrostatic", (-0.4, -0.4, 0.0), -0.853),
        ("shear", (0.0, -0.4, 0.2), 0.696),
        ("principal", (-0.4, 0.6, 0.0), 0.152),
        ("xx", (-0.4, 0.0, 0.0), -0.823),
        ("yy", (0.0, -0.4, 0.0), -0.823),
    ],
    "tangential": [
        ("hydrostatic", (0.0, 0.0, 0.0), -0.853),
        ("mises", (0.0, 0.0, 0.0), 1.744),
        ("shear", (0.0, 0.0, 0.0), 2.010),
        ("principal", (0.0, 0.0, 0.0), 0.115),
        ("hydrostatic", (0.4, 0.0, 0.0), -1.337),
        ("mises", (-0.4, -0.4, 0.0), 2.179),
        ("shear", (-0.4, -0.4, 0.0), 2.494),
        ("principal", (-0.6, 0.0, 0.0), 1.424),
        ("xx", (0.4, 0.0, 0.0), -2.044),
        ("yy", (0.4, 0.0, 0.0), -0.966),
        ("zz", (0.4, 0.0, 0.1), -1.058),
    ],
}
#: Where CONTACT says that a field is largest of all its points, 15 depths each.
LARGEST = {"normal": ("mises", 0.665, 0.4), "tangential": ("mises", 2.179, 0.0)}


@pytest.mark.parametrize("case", CONTACT)
def test_contact_below_a_square(case: str) -> None:
    """A unit square of 25 × 25 cells: its sum of cells is the square, so that all points must agree."""
    depths = np.array([*np.arange(0.0, 1.01, 0.1), 1.25, 1.667, 2.5, 5.0])
    n, cell = 75, 0.04
    pressure = np.zeros((n, n))
    pressure[25:50, 25:50] = 1.0
    traction = (0.999 * pressure, None) if case == "tangential" else None
    stresses = warpwear.stresses(
        pressure, depths, cell=cell, boundary="free", poisson=0.28, traction=traction
    )
    fields = {name: stresses.component(name) for name in COMPONENTS}
    fields |= {"hydrostatic": stresses.tensor[:3].mean(axis=0), "mises": stresses.mises}
    fields |= {"principal": stresses.principal, "shear": 2.0 * stresses.shear}
    for name, (x, y, z), value in CONTACT[case]:
        at = int(np.abs(depths - z).argmin()), *(round(place / cell) + n // 2 for place in (x, y))
        # CONTACT prints three digits, and its square lies off the middle by 1e-4 and 2e-4.
        assert fields[name][at] == pytest.approx(value, rel=0.01, abs=6e-4), (name, x, y, z)
    name, value, deep = LARGEST[case]
    points = np.array([-1.0, -0.8, -0.6, -0.4, -0.2, 0.0, 0.2, 0.4, 0.6, 0.8, 1.0])
    rows = np.round(points / cell).astype(int) + n // 2
    of_depths = fields[name][:, rows[:, np.newaxis], rows].max(axis=(1, 2))
    assert depths[of_depths.argmax()] == deep
    assert of_depths.max() == pytest.approx(value, rel=0.01)


def of_elasticity(kx: float, ky: float, z: float, poisson: float, load: str) -> Any:
    """Stress amplitudes under exp(i (kx x + ky y)) by the differential equations along z, E = 1.

    The state (u, v, w, xz, yz, zz) has a matrix whose decaying space carries what is far from the surface.
    """
    shear = 0.5 / (1.0 + poisson)
    lame = poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
    long, ix, iy = lame + 2.0 * shear, 1j * kx, 1j * ky
    m = np.zeros((6, 6), complex)
    m[0, 2], m[0, 3] = -ix, 1.0 / shear
    m[1, 2], m[1, 4] = -iy, 1.0 / shear
    m[2, 0], m[2, 1], m[2, 5] = -lame / long * ix, -lame / long * iy, 1.0 / long
    plane = long - lame**2 / long  # xx = plane·∂u/∂x + side·∂v/∂y + (λ/long)·zz
    side = lame - lame**2 / long
    m[3, 0], m[3, 1] = -(plane * ix**2 + shear * iy**2), -(side + shear) * ix * iy
    m[4, 0], m[4, 1] = -(side + shear) * ix * iy, -(plane * iy**2 + shear * ix**2)
    m[3, 5], m[4, 5] = -lame / long * ix, -lame / long * iy
    m[5, 3], m[5, 4] = -ix, -iy
    upper, basis, count = linalg.schur(m, output="complex", sort="lhp")
    assert count == 3
    surface = np.zeros(3, complex)  # xz, yz, zz of what is pressed, or pulled along x or y
    surface["xyp".index(load)] = -1.0
    amplitudes = np.linalg.solve(basis[3:, :3], surface)
    u, v, _, xz, yz, zz = basis[:, :3] @ linalg.expm(upper[:3, :3] * z) @ amplitudes
    xx = plane * ix * u + side * iy * v + lame / long * zz
    yy = side * ix * u + plane * iy * v + lame / long * zz
    return np.array([xx, yy, zz, shear * (iy * u + ix * v), xz, yz])


@pytest.mark.parametrize("load", ["p", "x", "y"])
@pytest.mark.parametrize(
    ("nx", "ny", "i", "j"), [(12, 9, 1, 2), (9, 12, 3, 0), (16, 16, 0, 5), (8, 10, 2, 4)]
)
def test_a_wave_against_the_equations(load: str, nx: int, ny: int, i: int, j: int) -> None:
    cell, poisson, depths = 0.3, 0.3, np.array([0.0, 0.1, 0.7])
    kx, ky = 2.0 * math.pi * i / (nx * cell), 2.0 * math.pi * j / (ny * cell)
    phase = kx * cell * np.arange(nx)[:, np.newaxis] + ky * cell * np.arange(ny)
    wave, zeros = np.cos(phase + 0.3), np.zeros((nx, ny))
    traction = (wave if load == "x" else zeros, wave if load == "y" else None)
    stresses = warpwear.stresses(
        wave if load == "p" else zeros,
        depths,
        cell=cell,
        boundary="periodic",
        poisson=poisson,
        traction=traction,
    )
    for number, z in enumerate(depths):
        amplitudes = of_elasticity(kx, ky, z, poisson, load)
        exact = (amplitudes[:, np.newaxis, np.newaxis] * np.exp(1j * (phase + 0.3))).real
        assert_allclose(stresses.tensor[:, number], exact, atol=1e-12)


def test_the_mean_of_a_repeating_surface() -> None:
    ones = np.ones((6, 5))
    stresses = warpwear.stresses(
        2.0 * ones, 0.4, cell=1.0, boundary="periodic", poisson=0.25, traction=(0.3 * ones, 0.7 * ones)
    )
    held = -2.0 * 0.25 / 0.75
    assert_allclose(stresses.tensor[:, 0, 2, 3], [held, held, -2.0, 0.0, -0.3, -0.7], atol=1e-14)


def test_free_against_periodic() -> None:
    """Loads whose effect dies away fast: Δ² of a bump, as cells and as waves, which differ by sin(x)/x."""
    nx, ny, cell, depths = 120, 108, 1.0, np.array([3.0, 4.0, 8.0])
    grid = Grid(nx, ny, cell)
    bump = np.exp(-(grid.x[:, np.newaxis] ** 2 + grid.y**2) / (2.0 * 4.0**2))
    kx, ky = 2.0 * math.pi * fft.fftfreq(nx)[:, np.newaxis], 2.0 * math.pi * fft.fftfreq(ny)
    spectrum = fft.fft2(bump) * (kx**2 + ky**2) ** 2
    cells = np.sinc(kx / (2.0 * math.pi)) * np.sinc(ky / (2.0 * math.pi))
    load, load_of_waves = fft.ifft2(spectrum).real, fft.ifft2(spectrum * cells).real
    unit = load.max()
    free, periodic = (
        warpwear.stresses(
            p / unit,
            depths,
            cell=cell,
            boundary=boundary,
            poisson=0.3,
            traction=(0.7 * np.roll(p, 3, axis=0) / unit, -0.4 * p / unit),
        ).tensor
        for p, boundary in ((load, "free"), (load_of_waves, "periodic"))
    )
    assert_allclose(free, periodic, atol=2e-6)


def test_a_wide_repeating_domain_is_a_free_one() -> None:
    pressure, cell = hertz(48, 3.0)
    loads = (pressure, 0.3 * pressure)
    tensors = []
    exact = warpwear.stresses(
        loads[0], 0.3, cell=cell, boundary="free", poisson=0.3, traction=(loads[1], None)
    )
    for times in (4, 8):
        wide = [np.pad(values, (times - 1) * 24) for values in loads]
        stresses = warpwear.stresses(
            wide[0], 0.3, cell=cell, boundary="periodic", poisson=0.3, traction=(wide[1], None)
        )
        inner = slice((times - 1) * 24, (times - 1) * 24 + 48)
        tensors.append(stresses.tensor[..., inner, inner] - exact.tensor)
    errors = [np.abs(difference).max() for difference in tensors]
    assert errors[0] < 0.02
    assert errors[1] < 0.3 * errors[0]


@pytest.mark.parametrize("ny", [1, 4, 7])
def test_below_a_line_contact(ny: int) -> None:
    """Plane strain below a cylinder of half-width and largest pressure 1 (Johnson 1985, eq. 4.45)."""
    n, width, depths = 401, 3.0, np.array([0.1, 0.4, 0.786, 1.5])
    line = np.sqrt(np.maximum(0.0, 1.0 - Grid(n, 1, width / n).x ** 2))
    pressure = np.repeat(line[:, np.newaxis], ny, axis=1)
    stresses = warpwear.stresses(
        pressure, depths, cell=width / n, boundary="line", poisson=0.3, traction=(0.2 * pressure, None)
    )
    xx, yy, zz, xy, _, yz = stresses.tensor[:, :, n // 2, 0]
    root = np.sqrt(1.0 + depths**2)
    assert_allclose(xx, -((1.0 + 2.0 * depths**2) / root - 2.0 * depths), atol=1e-5)
    assert_allclose(zz, -1.0 / root, atol=1e-5)
    assert_allclose(yy, 0.3 * (xx + zz), atol=1e-5)
    assert_allclose([xy, yz], 0.0, atol=1e-14)


def test_a_line_contact_is_one_of_many_images() -> None:
    """Images beyond those that are added here count for little, as the loads have no mean across."""
    nx, ny, count = 20, 6, 41
    fields = np.random.default_rng(5).random((3, nx, ny))
    fields -= fields.mean(axis=2, keepdims=True)
    options: dict[str, Any] = {"depths": [0.0, 0.5, 3.0], "cell": 1.0, "poisson": 0.3}
    tensors = []
    for boundary, times in (("line", 1), ("free", count)):
        pressure, *traction = np.tile(fields, times)
        tensors.append(warpwear.stresses(pressure, boundary=boundary, traction=traction, **options).tensor)
    middle = slice(count // 2 * ny, (count // 2 + 1) * ny)
    assert_allclose(tensors[0], tensors[1][..., middle], atol=2e-5)


@pytest.mark.parametrize("boundary", ["free", "periodic", "line"])
def test_threads_change_no_bit(boundary: str) -> None:
    random = np.random.default_rng(3)
    pressure, *traction = random.random((3, 61, 87))
    one, two = (
        warpwear.stresses(
            pressure, [0.0, 0.4], cell=0.1, boundary=boundary, poisson=0.3, traction=traction, threads=threads
        ).tensor
        for threads in (1, 2)
    )
    assert_array_equal(one, two)


def test_turned_loads_turn_stresses() -> None:
    random = np.random.default_rng(4)
    pressure, qx, qy = random.random((3, 14, 23))
    options: dict[str, Any] = {"cell": 0.2, "boundary": "free", "poisson": 0.2}
    tensor = warpwear.stresses(pressure, [0.0, 0.3], traction=(qx, qy), **options).tensor
    turned = warpwear.stresses(pressure.T, [0.0, 0.3], traction=(qy.T, qx.T), **options).tensor
    assert_allclose(turned[[1, 0, 2, 3, 5, 4]].swapaxes(2, 3), tensor, atol=1e-12)
