"""Wear in pieces: against a plain serial reference, its own books, and Archard's law."""

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import warp as wp
from numpy.testing import assert_allclose, assert_array_equal

import warpwear
from warpwear import InputError, Study
from warpwear.contact.half_space.solver import HalfSpace
from warpwear.engine.executor import Executor, arguments
from warpwear.engine.numbers import Numbers
from warpwear.engine.program import Program
from warpwear.grid import FloatArray, Grid, IntArray
from warpwear.kernels.cells import PADDING
from warpwear.kernels.sliding import Slide
from warpwear.kernels.sliding_steps import Steps
from warpwear.laws.archard import WearLaw
from warpwear.laws.junctions import critical_junction
from warpwear.laws.pieces import Pieces
from warpwear.laws.task import ContactTask
from warpwear.models.attachment import Place
from warpwear.models.track import pieces as track_pieces
from warpwear.models.track.bodies import SlidingBodies
from warpwear.models.track.pieces import OF_BODY, SlidingPieces
from warpwear.results.summary import summarise, summary_text
from warpwear.study.surface import surface_in
from warpwear.surfaces.form import Ball

CELL = 0.005
GRID = Grid(40, 37, CELL)
PIECES = {
    "20 um": Pieces(0.020, 0.0006),
    "33 um": Pieces(0.033, 0.001),
    "one cell": Pieces(CELL, 0.0002),
    "dusty": Pieces(0.020, 0.0006, dust=0.3),
}


class Reference:
    """One body as the algorithm is written down, cell by cell: depth z, pending π [mm], both of this body."""

    def __init__(self, z: FloatArray, pieces: Pieces, *, periodic: bool) -> None:
        self.z, self.pending, self.periodic = z.copy(), np.zeros_like(z), periodic
        self.d, self.t = pieces.diameter, pieces.thickness
        half = 0.5 * self.d / CELL
        reach = int(np.ceil(half))
        self.footprint = {
            (i, j): self.bowl(i, j)
            for i in range(-reach, reach + 1)
            for j in range(-reach, reach + 1)
            if np.hypot(i, j) < half * (1.0 - 1e-9)
        }
        self.piece = CELL**2 * sum(self.footprint.values())  # V*
        self.beside, self.apart = int(half + 1 + 1e-9), int(2.0 * self.d / CELL + 2 + 1e-9)
        self.left: list[tuple[int, int, float]] = []  # row, column, volume of each piece

    def bowl(self, i: int, j: int) -> float:
        return self.t * (1.0 - (2.0 * np.hypot(i, j) * CELL / self.d) ** 2)

    def inside(self, row: int, column: int) -> tuple[int, int] | None:
        rows, columns = self.z.shape
        if self.periodic:
            row %= rows
        return (row, column) if 0 <= row < rows and 0 <= column < columns else None

    def around(self, row: int, column: int) -> list[tuple[tuple[int, int], float]]:
        """Cells of the footprint that there are, each with the depth of the bowl."""
        cells = ((self.inside(row + i, column + j), bowl) for (i, j), bowl in self.footprint.items())
        return [(cell, bowl) for cell, bowl in cells if cell is not None]

    def square(self, row: int, column: int, half: int) -> list[tuple[int, int]]:
        span = range(-half, half + 1)
        cells = (self.inside(row + i, column + j) for i in span for j in span)
        return [cell for cell in cells if cell is not None]

    def shed(self) -> None:
        """In rounds until no piece is due, 60 at most."""
        for _ in range(60):
            sums = CELL**2 * self.sums()
            due = np.argwhere(sums >= self.piece)
            peaks = [cell for number, cell in enumerate(due) if self.is_peak(number, due, sums[tuple(due.T)])]
            for i, j in peaks:
                self.cut(*max(self.square(i, j, self.beside), key=lambda c: (self.pending[c], c)))
            if not peaks:
                return

    def is_peak(self, number: int, due: IntArray, sums: FloatArray) -> bool:
        """Whether no cell that is due in the square about one has a larger sum, nor as large a one later."""
        away = np.abs(due - due[number])
        if self.periodic:
            away[:, 0] = np.minimum(away[:, 0], len(self.z) - away[:, 0])
        later = np.arange(len(due)) > number
        larger = (sums > sums[number]) | ((sums == sums[number]) & later)
        return not ((away <= self.apart).all(axis=1) & larger).any()

    def sums(self) -> FloatArray:
        reach, (rows, columns) = max(i for i, _ in self.footprint), self.z.shape
        along = {"mode": "wrap"} if self.periodic else {"mode": "constant"}
        wide = np.pad(np.pad(self.pending, ((reach, reach), (0, 0)), **along), ((0, 0), (reach, reach)))
        found = np.zeros_like(self.z)
        for i, j in self.footprint:
            found += wide[reach + i : reach + i + rows, reach + j : reach + j + columns]
        return found

    def cut(self, row: int, column: int) -> None:
        cells = self.around(row, column)
        held = CELL**2 * sum(self.pending[c] for c, _ in cells)
        volume = min(self.piece, held)
        lowest = sorted(self.z[c] - bowl for c, bowl in cells)
        for n in range(1, len(lowest) + 1):
            level = (volume / CELL**2 + sum(lowest[:n])) / n
            if n == len(lowest) or level <= lowest[n]:
                break
        for c, bowl in cells:
            self.z[c] = max(self.z[c], level + bowl)
            self.pending[c] *= 1.0 - volume / held
        self.left.append((row, column, volume))


def bodies_of(executor: Executor, disc: FloatArray, pieces: Pieces) -> SlidingBodies:
    wears = WearLaw(9.4e-7), WearLaw(12.7e-7)
    task = ContactTask(
        load=1.0, hardness=600.0, form=Ball(1 / 3.0, 1 / 3.0), wear=wears, compliance=0.0, pieces=pieces
    )
    return SlidingBodies.of(task, executor, disc)


def pressure_of(step: int) -> FloatArray:
    """Spots at the hardness, other ones each step, in the middle and over the edges of rows and columns."""
    rng = np.random.default_rng(step)
    smooth = rng.normal(size=GRID.shape)
    for axis in (0, 1):
        smooth = sum(np.roll(smooth, n, axis) for n in (-1, 0, 1))
    return np.where(smooth > 2.0, 600.0, 0.0) * (0.5 + 0.5 * rng.random(GRID.shape))


ROWS, FRACTION, REMOVALS = 53, 0.5, (9.4e-7 * 0.8, 12.7e-7 * 1.1)
DISC = np.random.default_rng(1).normal(0.0, 2e-4, (ROWS, GRID.ny))


def shifts_of(pieces: Pieces, *, periodic: bool) -> list[int]:
    """Rows of the track under the counter-body's first, step by step."""
    steps = range(2 if pieces.diameter == CELL else 6)
    return [(7 * step) % ROWS if periodic else 2 * step for step in steps]


@cache
def expected_of(
    name: str, counter: bytes, *, periodic: bool
) -> tuple[tuple[Reference, Reference], list[tuple[float, float, float]]]:
    """Both references after the last step; worn, pending and deepest of each after every step. It is slow."""
    pieces, z = PIECES[name], np.frombuffer(counter).reshape(GRID.shape)
    references = Reference(z, pieces, periodic=False), Reference(-DISC, pieces, periodic=periodic)
    begun, sums = [reference.z.copy() for reference in references], []
    for step, shift in enumerate(shifts_of(pieces, periodic=periodic)):
        p, share = pressure_of(step), 1.0 - pieces.dust
        references[0].pending += share * REMOVALS[0] * p
        references[1].pending[(np.arange(GRID.nx) + shift) % ROWS] += share * FRACTION * REMOVALS[1] * p
        for reference, before in zip(references, begun, strict=True):
            reference.shed()
            worn = reference.z - before
            sums.append((worn.sum(), reference.pending.sum(), worn.max()))
    return references, sums


class Shedding:
    """Steps of two bodies, each by a pressure of its own, as a program."""

    def __init__(self, executor: Executor, pieces: Pieces, *, periodic: bool) -> None:
        self.bodies = bodies_of(executor, DISC, pieces)
        self.pieces = SlidingPieces(pieces, executor, self.bodies, periodic=periodic)
        self.share, self._executor, self._pressure = 1.0 - pieces.dust, executor, executor.zeros()
        self._slides = Numbers(Slide, executor.device, rows=GRID.nx)
        goes = wp.zeros(1, dtype=wp.int32, device=executor.device)
        self._rows = wp.zeros((1, 2 * len(OF_BODY)), dtype=wp.float64, device=executor.device)
        self._program = Program(executor)
        with self.pieces.at_beginning(self._program):
            self.pieces.before_search(self._program, Place(self._slides.array))
            self.pieces.add_take(self._program, self._slides.array, self._pressure)
        steps = arguments(Steps, stepping=goes, history=self._rows)
        self.pieces.between(self._program, Place(self._slides.array, steps))

    def step(self, number: int, shift: int) -> list[list[float]]:
        """Numbers of `OF_BODY` of both bodies after a step."""
        counter, disc = self.share * REMOVALS[0], self.share * FRACTION * REMOVALS[1]
        self._slides.set(shift=shift, pending_counter=counter, pending_disc=disc)
        self._executor.fill(self._pressure, pressure_of(number))
        self._program.run()
        while self.pieces.drain():
            self._program.run()
        self.pieces.book.end_steps()
        return self._rows.numpy().reshape(2, -1).tolist()  # type: ignore[no-any-return]


@pytest.mark.parametrize("periodic", [True, False], ids=["periodic", "with ends"])
@pytest.mark.parametrize("name", PIECES)
def test_the_same_pieces_as_by_a_serial_reference(
    device: str, threads: int, name: str, periodic: bool
) -> None:
    pieces = PIECES[name]
    with Executor(GRID, device=device, threads=threads) as executor:
        shed = Shedding(executor, pieces, periodic=periodic)
        bodies = shed.bodies
        counter = executor.to_numpy(bodies.counter).tobytes()
        references, sums = expected_of(name, counter, periodic=periodic)
        expected = iter(sums)
        for step, shift in enumerate(shifts_of(pieces, periodic=periodic)):
            for _, *found in shed.step(step, shift):
                assert_allclose(found, next(expected), rtol=1e-12)
        depth, height = executor.to_numpy(bodies.counter), executor.to_numpy(bodies.disc)
        pending = [executor.to_numpy(body.pending) for body in shed.pieces.both]
    table = shed.pieces.book.table
    for number, (reference, values) in enumerate(zip(references, (depth, -height), strict=True)):
        there = reference.z < 0.5 * PADDING
        assert_allclose(values[there], reference.z[there], rtol=0.0, atol=1e-15)
        assert_allclose(pending[number], reference.pending, rtol=0.0, atol=1e-15)
        mine = table[table[:, 1] == number]
        assert len(mine) == len(reference.left) > 10
        assert_array_equal(mine[:, 2:4], [piece[:2] for piece in reference.left])
        assert_allclose(mine[:, 4], [piece[2] for piece in reference.left], rtol=1e-9)


def test_pieces_do_not_depend_on_how_many_a_table_holds(device: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where it is full in the midst of a step, the host empties it and the program goes on."""
    tables = []
    for room in (track_pieces.ROOM, 0):  # of a round at least
        monkeypatch.setattr(track_pieces, "ROOM", room)
        with Executor(GRID, device=device) as executor:
            shed = Shedding(executor, PIECES["20 um"], periodic=True)
            rows = [shed.step(step, 7 * step) for step in range(4)]
        tables.append((shed.pieces.book.table, rows))
    assert len(tables[0][0]) > 10
    assert_array_equal(tables[1][0], tables[0][0])
    assert tables[1][1] == tables[0][1]


#: A small test on the half-space at 5 µm cells; a pass of 3 mm is a lap of 0.4 mm.
SMALL: dict[str, Any] = {
    "counter.radius": "3 mm",
    "disc.synthetic.ra": "0.3 um",
    "disc.synthetic.roll_off": "80 um",
    "disc.synthetic.cut_off": "12 um",
    "disc.synthetic.period": "0.4 mm",
    "contact.load": "1 N",
    "contact.law": "half-space",
    "grid.cell": "5 um",
    "grid.extent": "0.3 mm",
    "wear.particle": "20 um",
    "wear.particle_thickness": "0.6 um",
    "sliding.distance": "6 mm",
    "sliding.stroke": "3 mm",
    "sliding.track": "0.4 mm",
    "sliding.shift": 4,
    "output.snapshots": [],
}
ARRANGEMENTS: dict[str, dict[str, Any]] = {
    "track": {"sliding.kinematics": "swept"},
    "dusty track": {"sliding.kinematics": "swept", "wear.dust_fraction": 0.2},
    "uniform start": {
        "sliding.kinematics": "swept",
        "wear.pending_start": "uniform",
        "sliding.distance": "3 mm",
    },
    "whole stroke": {
        "sliding.kinematics": "swept",
        "sliding.track": "full",
        "sliding.stroke": "0.5 mm",
        "sliding.distance": "2 mm",
        "wear.particle_thickness": "0.1 um",
    },
    "kept dents": {"sliding.kinematics": "swept", "sliding.plastic": "keep"},
    "at rest": {"stepping.increment": "0.1 mm"},
    "bearing area": {"contact.law": "local", "stepping.increment": "0.1 mm"},
    "springs": {
        "sliding.kinematics": "swept",
        "contact.law": "local",
        "contact.stiffness": "2e6 N/mm^3",
    },
}


def study_of(arrangement: str, **changes: Any) -> Study:
    dotted = {name.replace("__", "."): value for name, value in changes.items()}
    return Study.load("v3-fine").replace(SMALL | ARRANGEMENTS[arrangement] | dotted)


@pytest.mark.parametrize("arrangement", ARRANGEMENTS)
def test_what_is_worn_and_what_is_pending_are_archards_volume_at_every_step(
    device: str, arrangement: str
) -> None:
    if device != "cpu" and "law" not in str(ARRANGEMENTS[arrangement]):
        pytest.importorskip("cupy")
    study = study_of(arrangement)
    result = warpwear.run(study, device=device)
    history, pieces = result.history, result.pieces
    share = study.track.track_fraction if study.is_swept else 1.0
    for number, (body, of_stroke) in enumerate((("counter", 1.0), ("disc", share))):
        worn, asked = history[f"wear_volume_{body}"], history[f"archard_volume_{body}"]
        assert_allclose(worn + history[f"pending_volume_{body}"], asked, rtol=1e-10)
        left = pieces["volume"][pieces["body"] == number]
        assert left.size == pytest.approx(history[f"pieces_{body}"].sum() * of_stroke, abs=1e-6)
        dust = study.wear.dust_fraction * asked[-1]
        assert worn[-1] == pytest.approx(dust + left.sum() / of_stroke, rel=1e-9)
        assert np.all(left <= study.pieces.volume(study.grid.cell) * (1.0 + 1e-9))
    assert history["pieces_counter"].sum() > 20
    assert np.all(np.diff(pieces["step"]) >= 0.0)
    assert np.all((pieces["diameter"] > 0.0) & (pieces["diameter"] <= 20e-3 * (1.0 + 1e-9)))


@pytest.mark.parametrize("shift", [1, 2, 4, 8])
@pytest.mark.parametrize("law", ["half-space", "local"])
def test_dust_alone_is_archards_wear_at_every_shift(shift: int, law: str) -> None:
    """Nothing is pending then: the dust is averaged along a step, and the step divided, as without pieces."""
    changes = {"sliding__shift": shift, "sliding__distance": "6 mm", "contact__law": law}
    dust = warpwear.run(study_of("track", wear__dust_fraction=1.0, **changes)).history
    names = ("particle", "particle_thickness", "dust_fraction", "pending_start")
    plain = {name: value for name, value in SMALL.items() if name.removeprefix("wear.") not in names}
    study = Study.load("v3-fine").replace(plain | ARRANGEMENTS["track"])
    archard = warpwear.run(study.replace({k.replace("__", "."): v for k, v in changes.items()})).history
    for name in ("area_contact", "cof", "wear_volume_counter", "wear_volume_disc", "wear_depth_disc"):
        assert_allclose(dust[name], archard[name], rtol=1e-9, err_msg=name)


def test_no_pit_is_much_deeper_than_a_piece() -> None:
    """Cuts go down to a crack surface: pits do not run away, as those of subtracted bowls do."""
    with warpwear.run(study_of("track", sliding__distance="18 mm")) as result:
        last = result.snapshots[-1]
        for wear in (last.wear_counter, last.wear_beneath):
            wide = np.lib.stride_tricks.sliding_window_view(wear, (9, 9))  # 45 µm: twice a piece
            around = np.median(wide.reshape(*wide.shape[:2], -1), axis=2)
            assert np.all(wear[4:-4, 4:-4] - around < 3.0 * 0.6e-3)
        assert last.wear_counter.max() > 2.0 * 0.6e-3  # or there is nothing to see


def test_pieces_of_a_cell_are_archards_dust() -> None:
    """Explicit Archard in the same steps, on the half-space, where a piece is less than a cell's wear."""
    increment, wear = 0.02, 10.0e-7
    study = study_of(
        "at rest",
        disc__synthetic__ra="3 um",
        wear__counter="10e-4 mm^3/N/m",
        wear__disc="10e-4 mm^3/N/m",
        wear__particle="5 um",
        wear__particle_thickness=f"{0.5 * 590.0 * wear * increment} mm",
        stepping__increment=f"{increment} mm",
        sliding__distance="0.6 mm",
        contact__hardness="590 MPa",
    )
    # stable, as explicit steps must be: 1.12 h/E* (at 5 µm cells)
    assert study.effective_modulus is not None
    assert 2.0 * wear * increment <= 1.12 * study.grid.cell / study.effective_modulus
    found = warpwear.run(study).history["area_contact"]
    grid = study.cells
    with Executor(grid) as executor:
        bodies = SlidingBodies.of(study.contact_task, executor, surface_in(study).heights(grid.x, grid.y))
        gap = executor.to_numpy(bodies.counter) - executor.to_numpy(bodies.disc)
        half_space = HalfSpace(executor, modulus=study.effective_modulus, boundary="free", hardness=590.0)
        expected = []
        for _ in found:
            contact = half_space.solve(executor.field(gap), mean_pressure=study.contact.load / grid.area)
            expected.append(contact.cells_in_contact * grid.cell_area)
            gap = gap + 2.0 * wear * increment * contact.pressure
    late = slice(len(expected) // 2, None)
    assert found[late].mean() == pytest.approx(np.mean(expected[late]), rel=0.01)
    assert np.mean(expected[late]) > 1.1 * expected[0]  # there is wear to agree on


def test_a_start_that_is_drawn_has_pieces_at_every_stage() -> None:
    law = Pieces(0.020, 0.0006, seed=3)
    drawn = law.start((200, 100), CELL, body=0)
    full = law.volume(CELL) / (len(law.footprint(CELL)[0]) * CELL**2)
    assert drawn.min() >= 0.0
    assert drawn.max() <= full
    assert drawn.mean() == pytest.approx(0.5 * full, rel=0.05)
    assert_array_equal(drawn, law.start((200, 100), CELL, body=0))
    assert not np.array_equal(drawn, law.start((200, 100), CELL, body=1))
    assert not Pieces(0.020, 0.0006).start((200, 100), CELL, body=0).any()


def test_a_piece_has_the_volume_of_its_bowl() -> None:
    """(π/8) d*² t on fine cells, and as the coarse ones of a run cut it."""
    exact = np.pi / 8.0 * 0.02**2 * 0.0006
    assert Pieces(0.020, 0.0006).volume(0.02 / 200) == pytest.approx(exact, rel=1e-3)
    assert 1e9 * Pieces(0.020, 0.0006).volume(CELL) == pytest.approx(90.0, rel=1e-12)


def test_the_area_without_wear_in_the_step() -> None:
    """It is that of the same gap solved alone, changes nothing, and lies below the step's own."""
    changes = {"wear__particle_thickness": None, "wear__particle": None, "sliding__distance": "0.6 mm"}
    plain = warpwear.run(study_of("track", **changes)).history
    for every in (1, 4):
        asked = warpwear.run(study_of("track", **changes, output__static_area_every=every)).history
        assert "area_static" not in plain
        for name in plain:
            assert_array_equal(asked[name], plain[name])
        solved = np.isfinite(asked["area_static"])
        assert_array_equal(np.flatnonzero(solved), np.arange(0, solved.size, every))
        assert np.all(asked["area_static"][solved] < plain["area_contact"][solved])
        # At the hardness nearly everywhere, where nothing but the bodies yields.
        assert_allclose(asked["area_static"][solved], 1.0 / 590.0, rtol=0.35)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"wear.particle_thickness": None}, "wear.particle_thickness, such as '0.6 um'"),
        ({"wear.particle": "critical", "junctions.surface_energy": None}, "junctions.surface_energy"),
        ({"wear.particle": "2 um", "wear.particle_thickness": "1 um"}, "smaller than a cell"),
        ({"wear.particle": "0.2 mm"}, "a quarter of grid.extent"),
        ({"wear.particle_thickness": "30 um"}, "a piece is a flake"),
        ({"wear.distance_factor": "across"}, "allowed is 'none'"),
        (
            {"study.model": "two-scale"},
            "needs study.model = 'micro', not 'two-scale': patches would cut pieces",
        ),
        (
            {"study.model": "macro", "contact.law": "local"},
            "not 'macro': patches would cut pieces, and smooth bodies have none",
        ),
        ({"wear.dust_fraction": 1.5}, "must be at most 1"),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence(changes: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        study_of("at rest").replace(changes)


def test_steps_and_cells_that_are_too_long_are_told_with_what_would_do() -> None:
    def told(arrangement: str, **changes: Any) -> str:
        return " ".join(study_of(arrangement, **changes).notices())

    assert "wear.particle" not in told("track")
    assert "grid.cell of 2.5 µm or less" in told("track", wear__particle="10 um")
    assert "sliding.shift = 2 would do" in told("track", wear__particle_thickness="0.1 um")
    assert "increments of 0.54 mm or less" in told("at rest", stepping__increment="2 mm")


def test_critical_pieces_are_those_of_the_softer_body() -> None:
    """By eq 2.3 with its own hardness, not the one that a contact may be fitted to."""
    critical = {
        "wear__particle": "critical",
        "junctions__surface_energy": "2 J/m^2",
        "counter__hardness": "4000 MPa",
        "disc__hardness": "2000 MPa",
    }
    study = study_of("track", **critical)
    expected = critical_junction(
        surface_energy=2e-3,
        shear_modulus=193e3 / (2.0 * 1.29),
        poisson=0.29,
        strength=2000.0 / (3.0 * np.sqrt(3.0)),
    )
    assert study.pieces.diameter == pytest.approx(expected, rel=1e-12)
    (sentence,) = (s for s in study.notices() if "critical" in s)
    assert "2000 MPa" in sentence
    assert f"d* = {1e3 * expected:.3g} µm" in sentence
    assert f"{1e3 * expected / 1.44:.3g} µm or {1e3 * expected / 0.64:.3g} µm" in sentence
    harder = study.replace({"contact.hardness": "900 MPa"})
    assert harder.pieces == study.pieces


def test_pieces_of_a_run_are_shown(tmp_path: Path) -> None:
    result = warpwear.run(study_of("track", sliding__speed="20 mm/min"), out=tmp_path / "run", plots=False)
    told = result.summary["pieces"]
    per_mm = result.history["pieces_disc"].sum() / 6.0
    assert told["disc"]["per_minute"] == pytest.approx(20.0 * per_mm)
    assert told["counter"]["number"] == np.count_nonzero(result.pieces["body"] == 0.0)
    told = summary_text(summarise(result))
    assert (
        "diameter d* 20 µm and thickness t 0.6 µm of a piece, dust 0 %, start zero (nothing pending)" in told
    )
    x, y = result.pieces["x"], result.pieces["y"]
    on_counter = result.pieces["body"] == 0.0
    assert np.abs(x[on_counter]).max() < 0.5 * 0.3
    assert np.abs(x).max() <= 0.5 * 0.4
    assert np.abs(y).max() < 0.5 * 0.3
    assert result.plot.pieces().axes
    classical = warpwear.run(
        study_of("track", sliding__distance="1 mm", wear__particle=None, wear__particle_thickness=None)
    )
    with pytest.raises(InputError, match="wear leaves at once"):
        classical.plot.pieces()
    with pytest.raises(InputError, match="has no pieces"):
        _ = classical.pieces
