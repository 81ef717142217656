"""Bad input is one sentence with the field, its value and what is allowed."""

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from warpwear import InputError, Study

BAD = [
    (
        {"run.threads": 2},
        r"^'run\.threads' is no key of a study; allowed are run\.checkpoint, run\.lap_memory\.$",
    ),
    ({"radius": "3 mm"}, r"^'radius' is no key of a study; did you mean 'counter\.radius'\?$"),
    ({"contact.load": "8"}, r"^contact\.load = '8': needs its unit: a force such as '8 N'\.$"),
    ({"contact.hardnes": "3 MPa"}, r"'contact\.hardnes' .*did you mean 'contact\.hardness'"),
    ({"contcat": {}}, r"'contcat' .*did you mean 'contact'"),
    ({"contact.load": "-8 N"}, r"contact\.load = '-8 N': must be greater than 0 N"),
    ({"contact.load": "nan N"}, r"contact\.load = 'nan N': is not a number"),
    ({"contact.load": "inf N"}, r"contact\.load = 'inf N': must be finite"),
    ({"contact.load": "8 mm"}, r"contact\.load = '8 mm': has the wrong dimension: .*'8 N'"),
    ({"contact.load": "8 bananas"}, r"contact\.load = '8 bananas': cannot be read"),
    ({"contact.load": 8}, r"contact\.load = 8: needs its unit"),
    # What a parser of expressions would read as 85, 800, 8 and 9.
    ({"contact.load": "8,5 N"}, r"contact\.load = '8,5 N': has a comma: write .* a decimal point"),
    ({"sliding.distance": "2 400 mm"}, r"sliding\.distance = '2 400 mm': is not one number with one unit"),
    ({"contact.load": "2*4 N"}, r"contact\.load = '2\*4 N': is not one number with one unit"),
    ({"contact.load": "8 N + 1 N"}, r"contact\.load = '8 N \+ 1 N': is not one number with one unit"),
    ({"wear.counter": "9,4e-4 mm^3/N/m"}, r"wear\.counter = '9,4e-4 mm\^3/N/m': has a comma"),
    ({"study.name": "../x"}, r"study\.name = '\.\./x'"),
    ({"output.snapshots": "5 mm"}, r"output\.snapshots = '5 mm': must be a list in brackets"),
    ({"wera": {"counter": "1 mm"}}, r"'wera' is no key .*did you mean 'wear'"),
    (
        {"contact.load": "9 kN"},
        r"contact\.load = 9000 N is more than the domain under the counter-body carries .*1327\.5 N",
    ),
    ({"contact.hardness": "nan MPa"}, r"contact\.hardness = 'nan MPa'"),
    ({"contact.hardness": "inf MPa", "stepping.scheme": "explicit"}, r"contact\.hardness = inf MPa needs"),
    ({"contact.law": "half"}, r"contact\.law = 'half' is not allowed; allowed: 'local' or 'half-space'"),
    ({"grid.cell": "0 um"}, r"grid\.cell = '0 um': must be greater than 0 mm"),
    ({"grid.cell": "7 um"}, r"grid\.extent = 1\.5 mm is not a whole number .*cells of 7 µm.*1\.498 mm"),
    (
        {"counter.radius": "3 mm", "counter.diameter": "6 mm"},
        r"^counter\.radius and counter\.diameter exclude each",
    ),
    ({"sliding.distance": "1 m", "sliding.passes": 3}, r"^sliding\.distance and sliding\.passes exclude"),
    (
        {"sliding.duration": "1 h"},
        r"^sliding\.duration = 3600 s needs sliding\.frequency, a frequency such as '1 Hz'",
    ),
    (
        {"sliding.frequency": "60 rpm", "sliding.stroke": None},
        r"^sliding\.frequency = 1 Hz needs sliding\.stroke or",
    ),
    (
        {"counter.radius": "2 um"},
        r"^contact\.load = 8 N is more than .* carries .*\(0\.00708 N\); .* a larger counter-body",
    ),
    (
        {"friction.coefficient": "0,55"},
        r"coefficient = '0,55': must be a number .* with a decimal point: 0\.55\.$",
    ),
    (
        {"output.snapshots": ["1 mm"] * 10_001},
        r"output\.snapshots = .* has 10,001 distances; allowed are 10,000",
    ),
    ({"a." * 50_000 + "a": 1}, r"^'a\.a\..{,80}…' is no key"),
    ({"a" * 50_000: 1}, r"^'a{80}…' is no key"),
    ({"stepping.increment": "1 mm", "stepping.first": "1 um"}, r"stepping\.increment and stepping\.first"),
    ({"stepping.growth": 0.9}, r"stepping\.growth = 0\.9: must be at least 1"),
    ({"friction.coefficient": 0.5, "friction.shear_strength": "3 MPa"}, r"exclude each other"),
    ({"friction.coefficient": 4.0}, r"friction\.coefficient = 4\.0: must be at most 3"),
    ({"disc.surface": "a.sur", "disc.synthetic": {"kind": "flat"}}, r"disc\.surface .*\[disc\.synthetic\]"),
    (
        {"disc.level": "cubic"},
        r"disc\.level = 'cubic' is not allowed; allowed: 'none', 'plane', 'sphere' or 'cylinder'",
    ),
    ({"disc.synthetic.kind": "sandy"}, r"disc\.synthetic\.kind = 'sandy' is not allowed; .*'flat'"),
    ({"wear.counter": "-1e-4 mm^3/N/m"}, r"wear\.counter = '-1e-4 mm\^3/N/m': must be at least 0"),
    ({"wear.disc": "1 mm"}, r"wear\.disc = '1 mm': has the wrong dimension"),
    ({"output.snapshots": ["3 N"]}, r"output\.snapshots\.0 = '3 N': has the wrong dimension"),
    ({"study": 3}, r"study = 3 is not a section"),
    ({"contact.load": {"a": 1}}, r"contact\.load = \{'a': 1\}: needs its unit"),
    ({"wear.counter": 1e-4, "contact.hardness": "inf MPa"}, r"wear\.counter = 0\.0001 is k of .*finite"),
    ({"disc.material": "kryptonite"}, r"disc\.material = 'kryptonite'"),
    ({"study.model": "two-scale", "patches.seed": -1}, r"patches\.seed = -1: "),
    ({"study.model": "macro", "counter.radius": "inf mm"}, r"contact\.bulk_stiffness = 'area' needs a ball"),
    (
        {"study.model": "macro", "disc.material": None},
        r"contact\.bulk_stiffness = 'area' needs Young's modulus .*",
    ),
    (
        {
            "study.model": "macro",
            "contact.bulk_stiffness": "1e6 N/mm^3",
            "contact.bulk_update": "updated",
        },
        r"bulk_update = 'updated' needs contact\.bulk_stiffness = 'area', 'pressure' or 'approach', not 1e",
    ),
    ({"contact.bulk_stiffness": "volume"}, r"contact\.bulk_stiffness = 'volume'"),
    ({"wear.law": "exponential"}, r"wear\.law = 'exponential' needs wear\.decay"),
    ({"wear.law": "running-in", "wear.running_in": "1 mm"}, r"needs wear\.initial_counter or"),
    ({"wear.decay": "3 mm"}, r"wear\.decay = '3 mm': has the wrong dimension: an inverse length"),
    ({"friction.initial_ratio": 2.0}, r"^friction\.initial_ratio = 2 needs friction\.running_in"),
    ({"wear.counter": 10**400}, r"wear\.counter = 1000.*: is too large"),
    ({"sliding.passes": 10**400}, r"sliding\.passes = 1000"),
    ({"counter.radius": "1 mm", "grid.extent": "4 mm", "contact.hardness": "1 MPa"}, r"carries .*3\.14168 N"),
    ({"stepping.increment": "1 nm"}, r"sliding\.distance = 2400 mm takes 2\.4e\+09 steps; .*1,000,000"),
    ({"stepping.largest": "1 nm", "stepping.first": "0.1 nm"}, r"takes 2\.4e\+09 steps"),
    ({"stepping.first": "3 um", "stepping.largest": "1 um"}, r"stepping\.first = 0\.003 mm must not exceed"),
    ({"grid.cell": "1e-25 mm"}, r"grid\.cell = 1e-25 mm makes more than 1,000,000 cells"),
    ({"study.name": "x" * 300}, r"study\.name = "),
    ({"assumed": 3}, r"assumed"),
    (
        {"counter": 3, "counter.radius": "3 mm"},
        r"'counter\.radius' is no key|counter = 3 is not a section",
    ),
    ({"contact.load.x": 3}, r"'contact\.load\.x' is no key"),
]


@pytest.mark.parametrize(("changes", "message"), BAD, ids=[",".join(c)[:40] for c, _ in BAD])
def test_bad_input_is_one_sentence(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        Study.load("v3-fine").replace(changes)
    sentence = str(caught.value)
    assert "\n" not in sentence
    assert sentence.endswith((".", "?"))


def test_a_missing_key_is_named() -> None:
    with pytest.raises(InputError, match=r"^counter is missing: a section \[counter] with .*radius"):
        Study()
    with pytest.raises(InputError, match=r"contact\.load is missing: normal load"):
        Study.load("v3").replace({"contact": {"hardness": "590 MPa"}})


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"[contact\n", "is not TOML"),
        (b"\xff\xfe\x00", "is not TOML: 'utf-8' codec"),
        (b"", "counter is missing"),
        (b"disc = 3", "missing"),
    ],
)
def test_a_file_that_is_no_study(tmp_path: Path, content: bytes, message: str) -> None:
    path = tmp_path / "study.toml"
    path.write_bytes(content)
    with pytest.raises(InputError, match=message):
        Study.load(path)


def test_an_unknown_name_suggests_the_nearest() -> None:
    with pytest.raises(
        InputError, match=r"is no file, no run folder and no preset .*Did you mean 'v3-fine'\?"
    ):
        Study.load("v3fine")


def test_an_explicit_step_beyond_the_stability_limit_is_refused_with_the_limit() -> None:
    # 2/(k K) = 2 / (2e5 × 2.21e-6) = 4.52 mm
    explicit = {"stepping.scheme": "explicit", "contact.stiffness": "2e5 N/mm^3"}
    study = Study.load("v3-fine").replace(explicit | {"stepping.increment": "4.5 mm"})
    with pytest.raises(InputError, match=r"stepping\.increment = 4\.6 mm .*4\.52 mm.*force = true"):
        study.replace({"stepping.increment": "4.6 mm"})
    forced = study.replace({"stepping.increment": "4.6 mm", "stepping.force": True})
    assert [n for n in forced.notices() if "4.52 mm: areas" in n and "mean nothing" in n]
    assert not any("stability" in n for n in study.replace({"stepping.force": True}).notices())
    # Without a foundation there is no such limit, and an implicit step has none either.
    study.replace({"stepping.increment": "4.6 mm", "contact.stiffness": "inf N/mm^3"})
    study.replace({"stepping.increment": "4.6 mm", "stepping.scheme": "implicit"})


def test_a_load_tolerance_must_be_smaller_than_the_load() -> None:
    with pytest.raises(
        InputError, match=r"load_tolerance = 100 N .*must be smaller than contact\.load = 8 N"
    ):
        Study.load("v3").replace({"stepping.load_tolerance": "100 N"})
    # A static contact without a foundation is a bearing area too, whatever the scheme.
    static = Study.load("v3-fine").replace(
        {"sliding.distance": "0 mm", "output.snapshots": [], "stepping.load_tolerance": "3 N"}
    )
    assert static.notices() == []
    assert 'load_tolerance = "3.0 N"' in static.to_toml()


def test_explicit_growing_steps_are_judged_by_the_largest_that_is_taken() -> None:
    explicit = {"stepping.scheme": "explicit", "contact.stiffness": "2e6 N/mm^3", "output.snapshots": []}
    study = Study.load("v3-fine").replace(explicit | {"sliding.distance": "0.1 mm"})
    with pytest.raises(InputError, match=r"stepping\.largest = 3 mm .*0\.452 mm"):
        study.replace({"sliding.distance": "30 mm"})


@pytest.mark.parametrize(
    "text", ["a = " + "9" * 5000, "a = " + "[" * 5000], ids=["a number of 5000 digits", "endless nesting"]
)
def test_toml_that_no_parser_takes(tmp_path: Path, text: str) -> None:
    (tmp_path / "s.toml").write_text(text)
    with pytest.raises(InputError, match="is not TOML"):
        Study.load(tmp_path / "s.toml")
    with pytest.raises(InputError):
        Study.load("x" * 300)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (
            lambda study: study.replace(load="8 N"),
            r"^'load' is no key of .* 'contact\.load'",
        ),
        (
            lambda study: study.replace(("contact.load", "4 N")),
            r"^\('contact\.load', '4 N'\) is no change",
        ),
        (lambda study: study.replace("contact.load"), r"^'contact\.load' is no change of a study"),
        (lambda study: study.replace({3: "4 N"}), r"^\{3: '4 N'\} is no change of a study"),
    ],
)
def test_what_is_no_change_is_told(change: Callable[[Study], Study], told: str) -> None:
    with pytest.raises(InputError, match=told):
        change(Study.load("v3"))


@pytest.mark.parametrize(
    ("key", "value"),
    [
        *((f"synthetic.{name}", "-3 um") for name in ("ra", "cut_off", "period", "fine_ra")),
        *((f"synthetic.{name}", value) for name in ("hurst", "seed") for value in (-1, "nan")),
        ("synthetic.hurst", 1.2),
        ("synthetic.seed", 1.5),
        ("synthetic.lay", "400 deg"),
        ("extend", "repeat"),
        ("sliding_axis", "z"),
        ("height_sign", "left"),
        ("outliers", 2.0),
        ("outliers", math.inf),
        ("level", 13),
    ],
)
def test_a_surface_that_is_none_is_refused_with_its_key(key: str, value: Any) -> None:
    with pytest.raises(InputError, match=rf"^disc\.{re.escape(key)} = "):
        Study.load("v3").replace({f"disc.{key}": value})
