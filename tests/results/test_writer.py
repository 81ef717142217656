"""Compressed blocks of a result, as any HDF5 reads them."""

import zlib
from pathlib import Path

import h5py
import numpy as np
import pytest

import warpwear
from warpwear.results import writer

SIDE = 256


def blocks() -> dict[str, np.ndarray]:
    """Fields of one block by what they are like."""
    draw = np.random.default_rng(1)
    rough = draw.normal(size=(SIDE, SIDE))
    x = np.linspace(-1.0, 1.0, SIDE)
    ball = np.add.outer(x**2, x**2)
    found = {
        "rough": rough,
        "smooth": ball,
        "constant": np.full((SIDE, SIDE), 6.4),
        "worn in part": np.where(ball < 0.5, rough, 0.0),
        "pressed in part": np.where(ball < 0.5, 6.4, rough),
        "islands": np.where(rough > 1.0, rough, 0.0),
        "signed zeros": np.where(rough > 0.0, 0.0, -0.0),
        "not finite": np.where(rough > 2.0, np.nan, np.where(rough < -2.0, np.inf, rough)),
        "last one worn": np.append(np.zeros(SIDE**2 - 1), 1.0).reshape(SIDE, SIDE),
        "narrow": rough[:, :7],
        "edge": rough[:100, :40],
        "one": rough[:1, :1],
    }
    # runs of every length that deflate's codes tell apart, with words of their own between them
    runs = [*range(1, 70), *range(250, 300), 511, 512, 513, 514, 515, 516, 517, 518, 519, 774, 775, 776, 777]
    values = [np.append(np.full(n, draw.normal()), draw.normal(size=3)) for n in runs]
    return found | {"runs": np.resize(np.concatenate(values), (SIDE, SIDE))}


@pytest.mark.parametrize("name", blocks())
def test_a_block_is_read_back_as_it_was(name: str, tmp_path: Path) -> None:
    values = blocks()[name]
    for chunk in ((SIDE, SIDE), values.shape):
        packed = writer._compressed(values, chunk)
        with h5py.File(tmp_path / "a.h5", "w") as file:
            how = {"compression": "gzip", "shuffle": True}
            dataset = file.create_dataset("a", values.shape, float, chunks=values.shape, **how)
            if packed is not None and chunk == values.shape:
                dataset.id.write_direct_chunk((0, 0), packed)
                assert np.array_equal(dataset[()].view(np.uint64), values.view(np.uint64))
        if packed is not None:
            planes = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(8, -1)
            read = planes.T.copy().view(np.float64).reshape(chunk)[tuple(slice(n) for n in values.shape)]
            assert np.array_equal(read.view(np.uint64), np.ascontiguousarray(values).view(np.uint64))


def test_bytes_without_order_are_stored_and_runs_are_not() -> None:
    """What deflate would gain nothing on costs no more than itself, and a run next to nothing."""
    size = {name: len(writer._compressed(values, (SIDE, SIDE)) or b"") for name, values in blocks().items()}
    whole = 8 * SIDE**2
    assert size["rough"] < 0.95 * whole  # sign and exponent have an order
    worn = np.pi / 8 * size["rough"]
    assert worn < size["worn in part"] < 1.05 * worn + 8192
    assert size["pressed in part"] < 0.7 * whole
    assert size["constant"] < 1000
    assert writer._compressed(np.zeros((SIDE, SIDE)), (SIDE, SIDE)) is None  # is not written at all


def test_single_keeps_all_digits_of_the_pressure_and_rounds_the_rest(tmp_path: Path) -> None:
    """Cells at the hardness are told by its very value; what a run shows at its end is what is read later."""
    changes = {"grid.cell": "20 um", "sliding.distance": "30 mm", "output.snapshots": ["3 mm"]}
    study = warpwear.Study.load("v3-fine").replace(changes)
    with warpwear.run(study.replace({"output.precision": "double"}), plots=False) as exact:
        whole = [exact.snapshots[i].fields for i in (0, 1)]
    for out in (None, tmp_path / "run"):
        with warpwear.run(study, out=out, plots=False) as run:
            at_hand = [run.snapshots[i].fields for i in (0, 1)]
        for fields, kept in zip(whole, at_hand, strict=True):
            assert np.array_equal(fields["pressure"], kept["pressure"])
            for name in ("gap", "wear_counter", "wear_disc"):
                assert np.array_equal(kept[name], fields[name].astype(np.float32)), name
                assert not np.array_equal(kept[name], fields[name]), name
    with warpwear.Result(tmp_path / "run") as read:
        for kept, fields in zip(at_hand, (read.snapshots[i].fields for i in (0, 1)), strict=True):
            assert all(
                np.array_equal(kept[name], fields[name]) and fields[name].dtype == float for name in kept
            )
