"""Conductance and stiffness of a contact, beside dense algebra, closed forms, differences, boxes of heat."""

import math
from typing import Any

import numpy as np
import pytest
from cases_half_space import rough
from scipy import sparse, special
from scipy.sparse import linalg

import warpwear
from warpwear.contact.half_space.influence import BOUNDARIES, free_coefficients, periodic_spectrum
from warpwear.contact.joint.conductance import FINE, TOLERANCE, Conduction, conduction
from warpwear.errors import InputError
from warpwear.grid import FloatArray, Grid
from warpwear.laws.elastic import joint_laws

pytestmark = pytest.mark.transforms

Cells = Any


def disc(cells: int, radius: float) -> Cells:
    x = np.arange(cells) - 0.5 * (cells - 1)
    return np.hypot(x[:, np.newaxis], x) <= radius


def dense(cells: Cells, boundary: str, film: float) -> tuple[float, FloatArray]:
    """The same by a matrix of all cells in contact: length over the cell, flux of mean 1."""
    (nx, ny), places = cells.shape, np.argwhere(cells)
    if boundary == "free":
        table = free_coefficients(1.0, 1.0, nx, ny)
    else:
        unit = np.fft.irfft2(periodic_spectrum(Grid(nx, ny, 1.0), 1.0), s=(nx, ny))
        table = unit[:nx, :ny]
    apart = np.abs(places[:, np.newaxis] - places).T
    matrix = table[apart[0], apart[1]] + film * np.eye(len(places))
    flux = np.linalg.solve(matrix, np.ones(len(places)))
    field = np.zeros(cells.shape)
    field[cells] = flux / flux.sum() * cells.size
    return float(flux.sum()), field


@pytest.mark.parametrize("film", [0.0, 0.7])
@pytest.mark.parametrize("boundary", ["periodic", "free"])
def test_dense_algebra_finds_the_same(boundary: str, film: float, device: str, threads: int) -> None:
    cells = np.random.default_rng(3).random((14, 13)) > 0.6
    options: dict[str, Any] = {"boundary": boundary, "film": 0.25 * film, "tolerance": FINE}
    found = conduction(cells, cell=0.25, **options, device=device, threads=threads)
    length, flux = dense(cells, boundary, film)
    assert found.length == pytest.approx(0.25 * length, rel=1e-9)
    assert np.abs(found.flux - flux).max() < 1e-4 * flux.max()


@pytest.mark.parametrize("boundary", BOUNDARIES)
@pytest.mark.parametrize("level", [1.5, 0.5, -1.0])
def test_a_conductance_lacks_no_more_than_its_tolerance(boundary: str, level: float) -> None:
    cells = rough(Grid(128, 96, 1.0), shortest=8) > level
    rough_one, fine = (
        conduction(cells, cell=1.0, boundary=boundary, tolerance=one) for one in (TOLERANCE, FINE)
    )
    assert 0.0 < 1.0 - rough_one.length / fine.length < TOLERANCE
    assert 0 < rough_one.iterations <= 12


@pytest.mark.parametrize("shape", [(1, 400), (4, 400)], ids=str)
def test_a_strip_under_a_free_boundary_lacks_a_little_more(shape: tuple[int, int]) -> None:
    """The stop test takes the inverse of a surface that repeats, which there is but near."""
    found, fine = (
        conduction(np.ones(shape, dtype=bool), cell=1.0, boundary="free", tolerance=one).length
        for one in (TOLERANCE, FINE)
    )
    assert TOLERANCE < 1.0 - found / fine < 10.0 * TOLERANCE


@pytest.mark.parametrize("boundary", BOUNDARIES)
def test_no_number_depends_on_the_threads(boundary: str, two_threads: int) -> None:
    cells = rough(Grid(96, 64, 1.0), shortest=12) > 0.8
    one, two = (
        conduction(cells, cell=1.0, boundary=boundary, threads=threads) for threads in (1, two_threads)
    )
    assert one.length == two.length
    assert np.array_equal(one.flux, two.flux)


def test_a_round_spot_conducts_its_diameter_and_the_error_halves_with_the_cell(device: str) -> None:
    errors = []
    for n in (8, 16, 32):
        spot = disc(3 * n, n)
        length = conduction(spot, cell=1.0, boundary="free", device=device).length
        errors.append(length / (2.0 * math.sqrt(np.count_nonzero(spot) / math.pi)) - 1.0)
    assert -0.02 < errors[1] < 0.0
    assert np.divide(errors[:-1], errors[1:]) == pytest.approx(2.0, rel=0.1)


@pytest.mark.parametrize("columns", [1, 6])
def test_a_strip_conducts_by_the_logarithm_of_the_distance(columns: int, device: str) -> None:
    """As a flat punch in plane strain, whose potential is 0 at the length of the array."""
    cells = np.zeros((256, columns), dtype=bool)
    cells[112:144] = True
    found = conduction(cells, cell=0.5, boundary="line", device=device)
    assert found.length == pytest.approx(0.5 * columns * math.pi / (2.0 * math.log(2.0 * 256 / 16)), rel=0.01)
    assert np.ptp(found.flux, axis=1).max() < 1e-3 * found.flux.max()


@pytest.mark.parametrize("ratio", [2.0, 4.0])
def test_an_elliptic_spot_conducts_by_an_elliptic_integral(ratio: float) -> None:
    """Of the half axes a and b it is π a / K(1 − b²/a²)."""
    b = 8.0 * math.sqrt(2.0)
    x = np.arange(128) - 63.5
    spot = np.hypot(x[:, np.newaxis] / (ratio * b), x / b) <= 1.0
    found = conduction(spot, cell=1.0, boundary="free").length
    assert found == pytest.approx(math.pi * ratio * b / special.ellipk(1.0 - ratio**-2), rel=0.01)


def test_spots_of_a_lattice_conduct_less_than_alone() -> None:
    """Beside a tube round about each, whose constriction is 1 − 1.40978 ε + 0.34406 ε³ of that alone."""
    for radius in (16, 32):
        found = conduction(disc(256, radius), cell=1.0 / 256, boundary="periodic")
        across = math.sqrt(math.pi) * math.sqrt(np.count_nonzero(disc(256, radius)) / math.pi) / 256
        tube = 1.0 - 1.40978 * across + 0.34406 * across**3
        assert 2.0 * across / math.sqrt(math.pi) / found.length == pytest.approx(tube, rel=0.02)


def test_laws_of_joints_are_powers_through_the_models_that_they_are_of() -> None:
    """Gaussian heights of σ 1 and mean slope 1, cut at λ √2; elastic spots have half of the area of the cut.

    A spot of radius a conducts 2a/(1 − ε)^1.5 in its tube, and how many there are follows from the slopes.
    """
    touching = np.geomspace(1e-5, 0.023, 30)
    over = {"slope": math.sqrt(math.pi), "sq": 1.0, "hardness": 1.0, "modulus": math.sqrt(2.0)}
    laws = joint_laws(touching, **over)
    for name, part, allowed in (("plastic", 1.0, 0.016), ("elastic", 0.5, 0.025)):
        depth = special.erfcinv(2.0 * touching / part)
        spots = np.exp(-(depth**2)) * math.sqrt(part / (8.0 * math.pi))
        assert laws[name] == pytest.approx(spots / (1.0 - np.sqrt(touching)) ** 1.5, rel=allowed)
    assert [*joint_laws(touching, **(over | {"hardness": math.inf}))] == ["elastic"]


def test_a_hertzian_spot_conducts_its_diameter(device: str) -> None:
    contact = warpwear.solve_contact(
        np.zeros((96, 96)), cell=0.02, load=0.15, modulus=1.0, counter_radius=1.0, device=device
    )
    radius = (0.75 * 0.15) ** (1.0 / 3.0)
    within = 2.0 * contact.cell / radius
    assert contact.conductance(device=device) == pytest.approx(2.0 * radius, rel=within)
    assert contact.stiffness(device=device) == pytest.approx(2.0 * radius, rel=within)
    flux = contact.flux(device=device)
    assert flux.mean() == pytest.approx(1.0)
    assert flux[contact.pressure == 0.0].max() == 0.0


def pressed(heights: FloatArray, mean: float, hardness: float | None) -> warpwear.ArrayContact:
    return warpwear.solve_contact(
        heights,
        cell=1.0 / len(heights),
        mean_pressure=mean,
        modulus=1.0,
        hardness=hardness,
        tolerance=1e-11,
    )


@pytest.fixture(scope="module")
def heights() -> FloatArray:
    """Of rms gradient 0.1, over an area of 1 × 1."""
    made = rough(Grid(256, 256, 1.0 / 256), shortest=16)
    steps = [(np.roll(made, -1, axis) - made) * 256 for axis in (0, 1)]
    return np.asarray(made * 0.1 / math.sqrt(np.mean(np.square(steps)) * 2.0))


@pytest.mark.parametrize("mean", [0.002, 0.01])
@pytest.mark.parametrize("hardness", [None, 0.03])
def test_the_stiffness_is_the_slope_of_load_over_approach(
    heights: FloatArray, mean: float, hardness: float | None
) -> None:
    contact, part = pressed(heights, mean, hardness), 1e-3
    less, more = (pressed(heights, mean * (1.0 + s * part), hardness) for s in (-1.0, 1.0))
    slope = 2.0 * part * mean / (more.approach - less.approach)
    assert contact.stiffness() == pytest.approx(slope, rel=2e-3)
    assert contact.stiffness(unloading=True) == contact.conductance()
    if hardness is None:
        assert contact.stiffness() == contact.conductance()
        return
    at_hardness = contact.pressure >= hardness
    assert np.array_equal(at_hardness, contact.gap < -1e-9)
    flowed = heights + np.where(at_hardness, contact.gap, 0.0)  # carries the same by its springs
    whole, less = (pressed(flowed, mean * by, None) for by in (1.0, 1.0 - part))
    slope = part * mean / (whole.approach - less.approach)
    assert contact.stiffness(unloading=True) == pytest.approx(slope, rel=2e-3)


def heat(cells: Cells, depths: FloatArray) -> float:
    """Length that conducts, of two bodies each a slab of boxes: differences in three directions.

    The contact is at 0, no heat crosses the rest of the surface, and a mean flux of 1 enters far below.
    """
    (nx, ny), nz, side = cells.shape, depths.size, 1.0

    def ring(n: int) -> Any:
        jump = sparse.eye(n) - sparse.csr_matrix((np.ones(n), (np.arange(n), (np.arange(n) + 1) % n)), (n, n))
        return jump.T @ jump

    plane = sparse.kron(ring(nx), sparse.eye(ny)) + sparse.kron(sparse.eye(nx), ring(ny))
    between = 2.0 * side**2 / (depths[1:] + depths[:-1])
    jumps = sparse.diags([1.0, -1.0], [0, 1], shape=(nz - 1, nz))
    matrix = sparse.kron(sparse.diags(depths), plane)
    matrix += sparse.kron(jumps.T @ sparse.diags(between) @ jumps, sparse.eye(nx * ny))
    held = np.zeros((nz, nx * ny))
    held[0, cells.ravel()] = 2.0 * side**2 / depths[0]
    source = np.zeros((nz, nx * ny))
    source[-1] = side**2
    matrix = (matrix + sparse.diags(held.ravel())).tocsr()
    matrix.eliminate_zeros()
    scaling = sparse.diags(1.0 / matrix.diagonal())
    found, failed = linalg.cg(matrix, source.ravel(), rtol=1e-6, M=scaling)
    assert failed == 0
    rise = found.reshape(nz, -1)[-1].mean() - (depths.sum() - 0.5 * depths[-1])
    return float(cells.size * side**2 / (2.0 * rise))


def test_a_heat_problem_of_boxes_conducts_as_much() -> None:
    """Both by cells of two sizes, as errors of both fall with the cell: at the edges of spots."""
    spots = np.zeros((32, 32), dtype=bool)
    spots[4:20, 2:14] = spots[15:29, 17:30] = True
    fine = np.kron(spots, np.ones((2, 2))) > 0.0
    ours = [conduction(cells, cell=1.0, boundary="periodic").length for cells in (spots, fine)]
    heats = [heat(cells, 0.5 * 1.15 ** np.arange(n)) for cells, n in ((spots, 18), (fine, 22))]
    assert ours[1] == pytest.approx(heats[1], rel=0.03)
    assert ours[1] - ours[0] == pytest.approx(heats[1] - heats[0], rel=0.01)


def test_gap_and_film_add_what_they_conduct_and_resist() -> None:
    contact = warpwear.solve_contact(
        rough(Grid(64, 64, 0.1)) * 0.01, cell=0.1, mean_pressure=0.01, modulus=1.0
    )
    alone, apart = contact.conductance(2.0), contact.gap[contact.pressure == 0.0]
    filled = contact.conductance(2.0, gap_conductivity=0.5, jump=0.1)
    assert filled - alone == pytest.approx(0.5 * 0.1**2 * np.sum(1.0 / (apart + 0.1)))
    with pytest.raises(InputError, match="jump = None is not possible"):
        contact.conductance(2.0, gap_conductivity=0.5)
    resistance = 1e4  # beside which the constriction is nothing
    filmed = contact.conductance(2.0, film_resistance=resistance)
    assert filmed == pytest.approx(contact.area / resistance, rel=1e-3)
    assert filmed < contact.area / resistance


def test_what_has_no_half_space_needs_a_boundary_and_has_no_stiffness() -> None:
    heights = rough(Grid(64, 64, 1.0), shortest=6)
    contact = warpwear.solve_contact(heights, cell=1.0, mean_pressure=0.2, hardness=1.0)
    with pytest.raises(InputError, match="boundary = None is not possible for a contact without"):
        contact.conductance()
    assert contact.conductance(boundary="periodic") > 0.0
    with pytest.raises(InputError, match="solved with a modulus"):
        contact.stiffness()
    with pytest.raises(InputError, match="conductivity = -1 is not possible"):
        contact.conductance(-1.0)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"film": "thick"}, "film = 'thick' is not possible"),
        ({"film": math.nan}, "film = nan is not possible"),
        ({"film": -1.0}, "film = -1 is not possible"),
        ({"threads": [1]}, r"threads = \[1\] is not possible"),
    ],
)
def test_what_no_flux_has_is_refused_also_where_it_was_found_before(given: Any, message: str) -> None:
    contact = warpwear.solve_contact(
        rough(Grid(64, 64, 0.1)) * 0.01, cell=0.1, mean_pressure=0.01, modulus=1.0
    )
    contact.flux()
    with pytest.raises(InputError, match=message):
        contact.flux(**given)
    with pytest.raises(TypeError, match="film_resistence"):
        contact.flux(film_resistence=1.0)


def test_nothing_conducts_nothing_and_a_whole_surface_without_bound() -> None:
    none, whole = np.zeros((8, 8), dtype=bool), np.ones((8, 8), dtype=bool)
    assert conduction(none, cell=1.0, boundary="free").length == 0.0
    assert conduction(whole, cell=1.0, boundary="periodic").length == math.inf
    film = conduction(whole, cell=1.0, boundary="periodic", film=2.0)
    assert isinstance(film, Conduction)
    assert film.length == pytest.approx(64.0 / 2.0)


def test_spots_of_few_cells_are_told() -> None:
    heights = np.random.default_rng(0).normal(size=(64, 64))
    contact = warpwear.solve_contact(heights, cell=1.0, mean_pressure=0.01, modulus=1.0)
    with pytest.warns(UserWarning, match="half of the spots in contact are of fewer than 3 cells"):
        contact.conductance()
