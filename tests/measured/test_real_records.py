"""Exports of other laboratories, value by value as they stand in the files, typed from these by hand.

Their licences are those of their repositories, and some have none, so they do not lie here. They are read
where WARPWEAR_RECORDS is a folder with clones, each as OWNER/NAME of github.com.
"""

import os
import random
from pathlib import Path
from typing import Any

import pytest
from fuzzing import check_sentence, mutated_bytes, mutated_text, numbers, watched

from warpwear.errors import InputError
from warpwear.measured.course import read_experiment
from warpwear.measured.rows import read_rows

RECORDS = Path(os.environ.get("WARPWEAR_RECORDS", "nowhere"))
RTEC = "Dichimanaym/Tribometer-Data-Processing/Sample Data"
PHOENIX = "kyembot/pin-on-disk-data-analysis/pod_data"
CSM = "gokcemay/trib/inst/exdata/tribometer"
SRV = "Aideneptune/Tribology-ML-pipeline"
KYOWA = "msritj79/data_processing/data/input_csv"
RADII = {"radius": [6.0, 9.0, 12.0, 15.0]}
LOGGED = {"columns": "Time(sec), CH2 [g], CH1 [g]", "speed": 10.0}
GRAM = 0.00980665
#: Files -> make, what to read them with, and (role, row from 0, value as the file has it, in mm, s, N).
CASES: dict[str, tuple[str, dict[str, Any], list[tuple[str, int, float]]]] = {
    f"{RTEC}/013_FX2_316SS_0.25in_Rotary_3N_4tests_75-300mm-s_6-15mm-radius_3min-each.csv": (
        "Rtec",
        RADII,
        [
            ("time", 0, 0.144),
            ("normal force", 0, 3.012628),
            ("friction force", 0, 0.4677829),
            ("cof", 0, 0.155274),
            ("rpm", 0, 99.26376),
            ("cof", 1799, 0.1857918),
            ("friction force", 3598, 0.5848789),
            ("cof", 5397, 0.2007669),
        ],
    ),
    **{
        f"{RTEC}/{number}_FX2_{of}_0.25in_Rotary_{load}N_4tests_{way}mm-s_6-15mm-radius_3min-each.csv": (
            "Rtec",
            RADII,
            [],
        )
        for number, of, load, way in (
            ("014", "316SS", 3, "300-75"),
            ("017", "316SS", 9, "75-300"),
            ("018", "316SS", 9, "300-75"),
            ("019", "Polyimide", 3, "75-300"),
            ("020", "Polyimide", 3, "300-75"),
            ("023", "Polyimide", 9, "75-300"),
            ("024", "Polyimide", 9, "300-75"),
        )
    },
    f"{PHOENIX}/PPS_60N_1.tsv": (
        "Phoenix (Compend)",
        {},
        [
            ("time", 0, 6.0),
            ("normal force", 0, 59.841),
            ("rpm", 3, 53.0),
            ("laps", 2, 4.0),
            ("distance", 2, 352.0),
            ("speed", 4, 125.0),
            ("radius", 0, 14.0),
            ("laps", -1, 3088.0),
            ("distance", -1, 271635.0),
        ],
    ),
    f"{PHOENIX}/PPS+15PTFE_60N_200RPM_30MINS_1.tsv": (
        "Phoenix (Compend)",
        {},
        [("time", -1, 3607.2), ("laps", -1, 6141.0), ("distance", -1, 540191.0), ("distance", 2, 88.0)],
    ),
    f"{PHOENIX}/PPS+30PTFE_60N_200RPM_30MINS_1.tsv": (
        "Phoenix (Compend)",
        {},
        [("time", -1, 3607.2), ("laps", -1, 6154.0), ("distance", -1, 541334.0), ("laps", 2, 3.0)],
    ),
    **{
        f"{PHOENIX}/{name}.tsv": ("Phoenix (Compend)", {}, [])
        for name in (
            "PPS_60N_2",
            "PPS_100N_1",
            *(
                f"PPS+{share}PTFE_{n}N_200RPM_30MINS_{k}"
                for share in (30, 45)
                for n in (60, 100)
                for k in (1, 2)
            ),
        )
    },
    "okilitive/CETR-tribometer/data": (
        "CETR or Bruker UMT",
        {"stroke": 8.6},
        [
            ("time", 1, 0.0127),
            ("friction force", 0, 7.683862 * GRAM),
            ("normal force", 0, -198.963455 * GRAM),
            ("cof", 0, 0.038619),
            ("cof", 216, 0.834374),
            ("friction force", 217, 166.661591 * GRAM),
            ("friction force", 432, 159.247330 * GRAM),
        ],
    ),
    "moritzploss/tribology/examples/process_slim_mapper/demo-mtm-output.txt": (
        "PCS",
        {},
        [
            ("cof", 0, 0.0196),
            ("normal force", 5, 5.639),
            ("friction force", 9, 0.1705),
            ("speed", 1, 199.75),
            ("time", 299, 300.0),
            ("cof", 299, 0.0601),
        ],
    ),
    f"{SRV}/Sample.xlsx": (
        "plain table",  # its names are those of an Optimol SRV; it has three coefficients
        {},
        [
            ("time", 0, 1.0),
            ("cof", 1, 0.11352500319480896),
            ("normal force", 0, 50.02299880981445),
            ("frequency", 2, 50.0),
            ("stroke", 1, 0.24300000071525574),
        ],
    ),
    f"{CSM}/c1.csv": (
        "plain table",  # cut by its owner to names and rows
        {"columns": "Distance [m],mu"},
        [
            ("cof", 0, 0.18478),
            ("distance", 1, 1e3 * 0.00271164323203266),
            ("distance", 9, 1e3 * 0.0237268786877394),
            ("cof", 9, 0.17345),
            ("cof", -2, 0.41340),
            ("distance", -1, 1e3 * 30.229398727417),
            ("cof", -1, 0.45578),
        ],
    ),
    f"{CSM}/c2.csv": (
        "plain table",
        {"columns": "2 [m],4"},  # its name of the coefficient is a question mark
        [("cof", 0, 0.12055), ("cof", -1, 0.30414), ("distance", -1, 1e3 * 30.2422790527344)],
    ),
    **{
        f"{KYOWA}/nontex5000{number}_A0000.CSV": ("Kyowa logger", LOGGED, values)
        for number, values in (
            (
                1,
                [
                    ("time", 1, 0.02),
                    ("normal force", 0, 3041.87915853659 * GRAM),
                    ("friction force", 0, 0.387280707317073 * GRAM),
                    ("time", -1, 901.98),
                    ("friction force", -1, 77.5739335853659 * GRAM),
                ],
            ),
            *((number, []) for number in range(2, 7)),
        )
    },
}


def record(name: str) -> Path:
    path = RECORDS / name
    if not path.exists():
        pytest.skip(f"{name} is not in WARPWEAR_RECORDS")
    return path


@pytest.mark.parametrize("name", CASES)
def test_values_are_those_of_the_file(name: str) -> None:
    make, options, values = CASES[name]
    rows = read_rows(record(name), options.get("columns"))
    assert rows.format == make
    for role, row, value in values:
        assert rows.table[role][row] == value, (role, row)
    course = read_experiment(record(name), **options)
    assert course.cof.size > 40
    assert not course.warnings or name.startswith(SRV)


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in CASES if Path(name).suffix])
@pytest.mark.filterwarnings("default::RuntimeWarning")
def test_broken_exports_end_in_a_sentence_or_a_course(name: str, tmp_path: Path) -> None:
    _, options, _ = CASES[name]
    content = record(name).read_bytes()
    lines = content.splitlines(keepends=True)
    content = b"".join([*lines[:250], *lines[-50:]])
    path = tmp_path / f"record{record(name).suffix}"
    for seed in numbers(25):
        dice = random.Random(seed)
        text = mutated_text(content.decode("latin-1"), dice).encode("utf-8", "replace")
        path.write_bytes(text if seed % 2 else mutated_bytes(content, dice))
        with watched():
            try:
                found = read_experiment(path, **options)
            except InputError as error:
                check_sentence(error)
                continue
        assert found.cof.max() <= 3.0
