"""What steps change of a model is saved and restored bit for bit, by declaration."""

import json
import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import pytest
import warp as wp
from numpy.testing import assert_array_equal

from warpwear.engine.executor import Executor, Field
from warpwear.engine.state import InFrame, frames, restore, save
from warpwear.grid import Grid


@dataclass(frozen=True)
class Pair:
    first: float
    second: np.ndarray


@dataclass(frozen=True)
class Kept:
    place: tuple[float, float]
    pair: Pair
    reach: float | None = None


class Inner:
    STATE: ClassVar = {"values": Field}

    def __init__(self, executor: Executor, value: float) -> None:
        self.values = wp.full(3, value, dtype=wp.float64, device=executor.device)


class Outer:
    STATE: ClassVar = {
        "_field": InFrame("contact"),
        "columns": tuple,
        "band": InFrame("disc", columns=True),
        "inner": list,
        "other": Inner,
        "under": InFrame("disc"),
        "sums": {"ball": InFrame("counter"), "disc": InFrame("disc")},
        "kept": Kept,
        "rates": list,
        "row": dict,
        "count": int,
        "limit": float,
    }

    def __init__(self, executor: Executor, value: float) -> None:
        shape = executor.grid.shape
        self._field = executor.field(np.full(shape, value))
        self.band = executor.field(np.full(shape, value))
        self.columns = (0, 0)
        self.inner = [Inner(executor, value), Inner(executor, 2.0 * value)]
        self.other: Inner | None = None
        self.under = Inner(executor, value)
        self.sums = {name: Inner(executor, value) for name in ("ball", "disc", "of_none")}
        self.kept: Kept | None = None
        self.rates: list[Any] = []
        self.row = {"distance": value}
        self.count, self.limit, self.told = 0, math.inf, 0.0

    def restored(self) -> None:
        self.told = self.limit


def test_a_part_comes_back_bit_for_bit(device: str) -> None:
    with Executor(Grid(3, 21, 0.1), device=device) as executor:
        one, other = Outer(executor, 1.0 / 3.0), Outer(executor, 7.0)
        one.columns, one.count, one.limit = (2, 11), 3, 0.1 + 0.2
        one.kept = Kept((0.1, math.nan), Pair(1.0e-300, np.array([0.1, 0.2])), None)
        one.rates.extend([(1.0, 2.0), (3.0, -math.inf)])
        arrays, numbers = save(one)
        assert arrays["band"].shape == (3, 9)
        assert {"field", "inner.0.values", "kept.pair.second"} <= set(arrays)
        arrays = {name: values.copy() for name, values in arrays.items()}
        restore(other, arrays, json.loads(json.dumps(numbers)))
        assert_array_equal(other._field.numpy(), one._field.numpy())
        band = executor.to_numpy(other.band)
        assert np.all(band[:, 2:11] == 1.0 / 3.0)
        assert np.all(np.delete(band, np.s_[2:11], axis=1) == 7.0)
        assert [part.values.numpy()[0] for part in other.inner] == [1.0 / 3.0, 2.0 / 3.0]
        assert other.kept is not None
        assert other.kept.place[0] == 0.1
        assert math.isnan(other.kept.place[1])
        assert isinstance(other.kept.pair, Pair)
        assert_array_equal(other.kept.pair.second, one.kept.pair.second)
        assert other.rates == one.rates
        assert (other.columns, other.count, other.row, other.told) == ((2, 11), 3, one.row, 0.1 + 0.2)
        assert other.other is None
        assert {part.values.numpy()[0] for part in (other.under, *other.sums.values())} == {1.0 / 3.0}
        # A frame holds for all arrays of a part or of a name; others have none.
        of_the_disc = {"band", "under.values", "sums.disc.values"}
        declared = {"field": "contact", "sums.ball.values": "counter"} | dict.fromkeys(of_the_disc, "disc")
        assert frames(one) == declared
        assert {"sums.of_none.values", "inner.0.values"} <= set(arrays) - set(declared)


def test_members_that_the_declaration_does_not_have_are_told() -> None:
    class Undeclared:
        STATE: ClassVar = {"kept": float, "inner": list}

        def __init__(self) -> None:
            self.kept: Any = None
            self.inner: list[Any] = []

    one, other = Undeclared(), Undeclared()
    one.kept = Pair(1.0, np.zeros(2))
    with pytest.raises(TypeError, match=r"^kept was saved by the names of its members.*'float'"):
        restore(other, *save(one))
    one.kept, one.inner = 1.0, [Pair(1.0, np.zeros(2))]  # one more than there was
    with pytest.raises(TypeError, match=r"^inner\.0 was saved by the names of its members"):
        restore(other, *save(one))
    one.inner, other.inner = [2.0, 3.0], [5.0]
    restore(other, *save(one))
    assert other.inner == [2.0, 3.0]
