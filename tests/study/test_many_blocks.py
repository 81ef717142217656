"""A programme costs what its blocks cost: ten thousand are read in seconds, and their limit is told."""

import time
from typing import Any

import pytest

from warpwear.errors import InputError
from warpwear.study.loading import parse_toml
from warpwear.study.resolve import MOST_BLOCKS
from warpwear.study.study import Study

SECONDS = 5.0
WAYS: dict[str, dict[str, Any]] = {
    "at rest": {"sliding": {}, "length": {"distance": "10 um"}},
    "strokes": {"sliding": {"stroke": "1 mm", "track": "full"}, "length": {"passes": 2}},
    "rotation": {"sliding": {"track_radius": "3 mm", "track": "1 mm"}, "length": {"revolutions": 1}},
}


def programme(how: str, count: int, **last: Any) -> Study:
    blocks = [{"load": f"{1.0 + n / count:.5f} N", **WAYS[how]["length"]} for n in range(count)]
    blocks[-1] |= last
    return Study(
        counter={"radius": "3 mm", "young": "210 GPa", "poisson": 0.3},
        disc={
            "young": "210 GPa",
            "poisson": 0.3,
            "synthetic": {"kind": "self-affine", "sq": "0.2 um", "cut_off": "20 um"},
        },
        contact={"law": "local", "hardness": "2 GPa"},
        wear={"counter": "1e-9 mm^3/N/m", "disc": "1e-9 mm^3/N/m"},
        friction={"coefficient": 0.6},
        grid={"cell": "10 um", "extent": "0.3 mm"},
        sliding=WAYS[how]["sliding"],
        block=blocks,
    )


@pytest.mark.parametrize(
    "how", [pytest.param(way, marks=[] if way == "strokes" else pytest.mark.slow) for way in WAYS]
)
def test_ten_thousand_blocks_are_shown_in_seconds(how: str) -> None:
    started = time.process_time()
    study = programme(how, MOST_BLOCKS)
    assert study.replace({}).to_toml(marked=True).count("[[block]]") == MOST_BLOCKS
    study.notices()
    assert time.process_time() - started < SECONDS


def test_more_blocks_are_refused() -> None:
    with pytest.raises(InputError, match=r"10,001 blocks; allowed are 10,000"):
        programme("at rest", MOST_BLOCKS + 1)


@pytest.mark.parametrize("wrong", [{"load": "100 kN"}, {"stroke": "1.0001 mm"}])
def test_no_block_is_overlooked_among_many(wrong: dict[str, Any]) -> None:
    for count in (1, 300):
        with pytest.raises(InputError, match=rf"block {count}: "):
            programme("strokes", count, **wrong)


@pytest.mark.parametrize("name", ["block", "disc.layers"])
def test_a_table_for_a_list_of_tables_is_told(name: str) -> None:
    with pytest.raises(ValueError, match=rf"a list of tables has \[\[{name}\]\] above each"):
        parse_toml(f"[{name}]\na = 1\n[{name}]\na = 2\n")


def test_one_block_in_single_brackets_is_told() -> None:
    with pytest.raises(InputError, match=r"write \[\[block\]\] above each block"):
        Study(block={"load": "1 N", "distance": "1 mm"})
