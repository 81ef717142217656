"""Searches leave out tiles by bounds that hold while gaps only grow: whoever raises a surface says so."""

from operator import attrgetter
from typing import Any

import numpy as np
import pytest
from cases_features import STUDIES, Debris, attach, model_of, needs_transforms
from cases_track import small
from numpy.testing import assert_array_equal

import warpwear
from warpwear.engine.executor import Executor
from warpwear.engine.program import Program
from warpwear.engine.tiles import tile_extremes
from warpwear.errors import InvariantError
from warpwear.grid import FloatArray
from warpwear.kernels.cells import LANES, PADDING, TILE_VECTORS
from warpwear.models.track.local import SlidingContact
from warpwear.models.track.tiles import SlidingTiles
from warpwear.runs.order import RunOrder
from warpwear.study.study import Study

DEPTH = 1.0e-4


class Heap(Debris):
    of_step = DEPTH


class Untold(Heap):
    """Raises the disc without a word."""

    raises = False


def wide() -> Study:
    """A study whose rows have many tiles."""
    study = small("full", grid__extent="1.62 mm", grid__cell="10 um", sliding__distance="2 mm")
    return study.replace({"counter.radius": "3 mm"})


def run(
    monkeypatch: pytest.MonkeyPatch, kind: type[Debris], device: str, *, strict: bool = True
) -> dict[str, FloatArray]:
    with monkeypatch.context() as patch:
        attach(patch, kind)
        return warpwear.run(wide().replace({"checks.strict": strict}), device=device).history


def test_bounds_are_made_anew(device: str, threads: int) -> None:
    dice = np.random.default_rng(5)
    study = wide()
    with Executor(study.cells, device=device, threads=threads) as executor:
        disc = dice.normal(0.0, 1e-3, (study.track.rows, study.cells.ny))
        contact = SlidingContact(study.contact_task, disc, executor)
        tiles, bodies = contact.tiles, contact.state
        assert tiles.below_bounds() == 0.0
        for field, sign in ((bodies.disc, 1.0), (bodies.counter, -1.0)):
            host = field.numpy()
            host += sign * dice.uniform(0.0, 1e-3, host.shape)
            field.assign(host)
        assert tiles.below_bounds() > 0.0
        program = Program(executor)
        tiles.refresh(program)
        program.run()
        assert tiles.below_bounds() == 0.0
        lowest, highest = tile_extremes(np.minimum, bodies.counter), tile_extremes(np.maximum, bodies.disc)
        count = lowest.shape[1]
        assert_array_equal(tiles.lowest.to_numpy()[:, :count], lowest)
        assert_array_equal(tiles.highest.to_numpy()[:, :count], highest)
        assert_array_equal(tiles.highest_of_row.numpy(), highest.max(axis=1))
        padded = np.pad(lowest, ((0, 0), (0, -count % LANES)), constant_values=PADDING)
        eight = padded.reshape(lowest.shape[0], -1, LANES).min(axis=2)
        assert_array_equal(tiles.lowest_of_eight.numpy(), eight)


def test_who_raises_a_surface_without_a_word_is_found_out(
    monkeypatch: pytest.MonkeyPatch, device: str
) -> None:
    with pytest.raises(InvariantError, match=r"^a gap lies \S+ mm below the bound of its tile after"):
        run(monkeypatch, Untold, device)


def test_who_says_so_gets_what_a_search_of_every_tile_finds(
    monkeypatch: pytest.MonkeyPatch, device: str
) -> None:
    told, untold = run(monkeypatch, Heap, device), run(monkeypatch, Untold, device, strict=False)
    refresh = SlidingTiles.refresh

    def without_bounds(self: SlidingTiles, program: Program) -> None:
        refresh(self, program)

        def forget() -> None:
            self.lowest.numbers.fill_(-PADDING)
            self.lowest_of_eight.fill_(-PADDING)

        program.call(forget)

    monkeypatch.setattr(SlidingTiles, "refresh", without_bounds)
    every = run(monkeypatch, Heap, device)
    assert told.keys() == every.keys()
    for name, values in every.items():
        assert_array_equal(told[name], values, err_msg=name)
    assert not np.array_equal(untold["area_contact"], told["area_contact"])


#: The field of a host that closes gaps where it grows, or with a minus.
RAISED = {
    "track": ("contact.state.disc", 1.0),
    "track, bearing area": ("contact.state.counter", -1.0),
    "rest": ("gap", -1.0),
    "rest, across": ("contact.state.disc", 1.0),
    "patches": ("contact.gap", -1.0),
    "patches, half-space": ("gap", -1.0),
}


@pytest.mark.parametrize("case", RAISED)
def test_every_host_that_leaves_out_tiles_is_looked_at(case: str, device: str) -> None:
    """Wear opens gaps, and a surface that is raised by a nanometre somewhere is found."""
    study, (name, sign) = STUDIES[case], RAISED[case]
    needs_transforms(study, device)
    with RunOrder(study).arrangement.executor(study, device=device, threads=1) as executor:
        model = model_of(study, executor)
        assert model.below_bounds() <= 0.0
        for _ in model.steps([(0.03, False)] * 5):
            assert model.below_bounds() <= 0.0
        field = attrgetter(name)(model)
        host = field.numpy().copy()
        host += sign * 1e-6 * (np.abs(host) < 1.0)
        field.assign(host)
        assert model.below_bounds() == pytest.approx(1e-6, rel=1e-3)


def test_gaps_that_are_kept_are_bounds_too(device: str) -> None:
    """A valley that is filled up to the highest cell of its tile leaves the bounds of both bodies true."""
    study = STUDIES["rest, across"]
    with Executor(study.cells, device=device) as executor:
        model: Any = model_of(study, executor)
        assert len(list(model.steps([(0.03, False)] * 5))) == 5
        disc, highest = model.contact.state.disc, model.contact.tiles.highest.to_numpy()
        host = disc.numpy()
        cells = LANES * int(TILE_VECTORS)
        full = np.repeat(highest, cells, axis=1)[:, : host[0].size].reshape(host.shape)
        disc.assign(np.where(np.abs(host) < 1.0, full, host))
        assert model.below_bounds() > 1e-6
