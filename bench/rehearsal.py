"""What a prediction is worth: tests in which everything is known, from the machine's files to the band.

    python bench/rehearsal.py --cases 50 --out rehearsal.jsonl
    python bench/rehearsal.py --summary rehearsal.jsonl

A test is made by a run whose surface, wear coefficient, film and shear strength nobody is told. Its record
is written as a Rtec tribometer writes one (forces, position, recipe steps, footer), with correlated noise,
and its worn ball as a map, with noise. Both are read back by the readers of the program, the study is
calibrated on them at 4 N (`warpwear.infer`, by its own surface), and the calibrated study's sweep predicts
the same pair at 8 N. The hidden pair is tested at 8 N as well. Held are the coefficient of friction, read
from its record, in the first and in the last third of the distance, and the volume that the ball has lost,
read from its map: each inside the 5 to 95 % of the prediction or not. Ninety per cent of the cases should be
inside. Case n has the seed 9000 + n. A case is a line of the file and is not made again.
"""

import json
import tempfile
import time
import tomllib
import warnings
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import click
import numpy as np
from click.testing import CliRunner

import warpwear
from warpwear import Result, Study
from warpwear.cli.main import commands
from warpwear.errors import ConvergenceError, InputError
from warpwear.grid import FloatArray
from warpwear.measured.course import read_experiment

FIRST_SEED = 9000
LIGHT, HEAVY = "4 N", "8 N"
STUDY: dict[str, Any] = {
    "study": {"name": "rehearsal"},
    "counter": {"radius": "3 mm", "young": "200 GPa", "poisson": 0.3},
    "disc": {
        "young": "200 GPa",
        "poisson": 0.3,
        "synthetic": {
            "kind": "self-affine",
            "sq": "0.5 um",
            "roll_off": "200 um",
            "cut_off": "80 um",
            "seed": 1,
            "period": "2.4 mm",
        },
    },
    "contact": {"law": "local", "load": LIGHT, "hardness": "400 MPa"},
    "wear": {"counter": "1.4e-4 mm^3/N/m", "disc": "4e-4 mm^3/N/m"},
    "friction": {
        "shear_strength": "28 MPa",
        "film": {"thickness": "60 nm", "shear_strength": "8 MPa"},
    },
    "grid": {"cell": "20 um", "extent": "1.2 mm"},
    "sliding": {"distance": "1200 mm", "stroke": "30 mm", "track": "2.4 mm", "shift": 6, "speed": "10 mm/s"},
    "output": {"snapshots": []},
}
#: Unknowns and what is known of them before; the truth is drawn from the same.
UNKNOWN = {
    "wear.counter": "log-uniform 1e-4 .. 2e-4 mm^3/N/m",
    "friction.film.thickness": "log-uniform 40 .. 80 nm",
    "friction.shear_strength": "log-uniform 15 .. 50 MPa",
}
#: Samples a second of the record [Hz]; deviation and length [mm] of its noise; noise of the map [mm].
RATE, SCATTER, LENGTH, MAP_NOISE = 10.0, 0.01, 15.0, 1e-4
#: Runs of a prediction, and the parts of them that its band leaves out below and above [%].
DRAWS, BAND = 32, (5.0, 95.0)
Numbers = dict[str, float]


def truth_of(random: np.random.Generator) -> dict[str, str]:
    """Draw what nobody is told, as keys of the study."""
    keys = {}
    for key, prior in UNKNOWN.items():
        _, low, _, high, unit = prior.split()
        keys[key] = f"{float(low) * (float(high) / float(low)) ** random.random():.6g} {unit}"
    return keys | {"disc.synthetic.seed": int(random.integers(1000, 1_000_000))}


def write_record(result: Result, path: Path, random: np.random.Generator) -> None:
    """Write the record of a run as a Rtec tribometer does: title, steps, a field more a row, footer."""
    sliding, load = result.study.sliding, result.study.contact.load
    assert sliding.speed
    assert sliding.stroke
    count = int(sliding.total / sliding.speed * RATE)
    time_s = np.arange(1, count + 1) / RATE
    distance = sliding.speed * time_s
    noise = np.zeros(count)
    keep = np.exp(-sliding.speed / RATE / LENGTH)
    for at, kick in enumerate(random.normal(0.0, SCATTER * np.sqrt(1.0 - keep**2), count)):
        noise[at] = kick + keep * noise[at - 1]
    cof = np.interp(distance, result.history["distance"], result.history["cof"]) + noise
    passes, along = np.divmod(distance, sliding.stroke)
    forward = passes % 2 == 0
    position = np.where(forward, along, sliding.stroke - along)
    fz = load * (1.0 + random.normal(0.0, 0.005, count))
    fx = np.where(forward, 1.0, -1.0) * cof * fz
    rows = [
        f"1,{t:.3f},1,{z:.6f},{x:.6f},{p:.4f}," for t, z, x, p in zip(time_s, fz, fx, position, strict=True)
    ]
    head = "Recipe, UpperSample, LowerSample, OtherInfo\rrehearsal.Rx,,,,\r"
    names = "Step, Timestamp, RecipeStep, DAQ.Fz (N),DAQ.Fx (N),Linear.Position (mm),"
    path.write_text("\n".join([head, names, *rows, "", "TotalTime", "00:02:00.0\n"]), encoding="utf-8")


def write_ball(result: Result, folder: Path, random: np.random.Generator) -> Path:
    """Write the worn ball as points x y z [mm], with noise."""
    (plain,) = result.export(folder / "export", formats=["xyz"], bodies=["counter"])
    points = np.loadtxt(plain)
    points[:, 2] += random.normal(0.0, MAP_NOISE, len(points))
    path = folder / "ball.xyz"
    np.savetxt(path, points, fmt="%.7f")
    return path


def called(*arguments: str) -> str:
    """Call a command of the program and return what it prints."""
    answer = CliRunner().invoke(commands, arguments)
    if answer.exit_code:
        raise answer.exception or InputError(answer.output)
    return answer.stdout


def held_of(distance: FloatArray, cof: FloatArray, volume: float) -> Numbers:
    """Name what is held: mean coefficients of the first and the last third, and the ball's volume [mm³]."""
    third = float(distance[-1]) / 3.0
    return {
        "first third": float(cof[distance <= third].mean()),
        "last third": float(cof[distance >= 2.0 * third].mean()),
        "volume": volume,
    }


def tested(study: Study, folder: Path, random: np.random.Generator) -> tuple[Path, str, Numbers]:
    """Make a test and read its files back: the record, the volume with its error, and what is held."""
    folder.mkdir(parents=True)
    with warpwear.run(study) as result:
        write_record(result, folder / "record.csv", random)
        ball_file = write_ball(result, folder, random)
    course = read_experiment(folder / "record.csv", stroke=study.sliding.stroke)
    options = ("--ball", "--radius", "3 mm", "--pixel", "20 um", "--height-unit", "mm", "--json")
    ball = json.loads(called("surface", str(ball_file), *options, "--no-figure"))["ball"]
    volume, error = ball["volume_mm3"], ball["volume_error_mm3"]
    held = held_of(course.distance, course.cof, volume)
    return folder / "record.csv", f"{volume:.6g} +- {error:.3g} mm^3", held


def predicted(text: str, work: Path) -> dict[str, list[float]]:
    """Run the sweep of a calibrated study at the other load, each run on a surface of its own."""
    content = tomllib.loads(text)
    sweep = content.pop("sweep")
    design, vary = sweep["design"], sweep["vary"]
    samples = DRAWS if design == "sobol" else None
    if samples is None:
        vary = {key: values[:DRAWS] for key, values in vary.items() if isinstance(values, list)}
    vary["disc.synthetic.seed"] = f"101:{100 + DRAWS}"
    study = Study(**content).replace({"contact.load": HEAVY})
    with ThreadPoolExecutor(1) as pool:  # in this process, which has the kernels at hand
        result = warpwear.sweep(study, vary=vary, design=design, samples=samples, out=work, executor=pool)
    rows = []
    for row in range(len(result.table["run"])):
        with result.open(row) as one:
            history = one.history
            volume = float(history["wear_volume_counter"][-1])
            rows.append(held_of(history["distance"], history["cof"], volume))
    return {key: [row[key] for row in rows] for key in rows[0]}


def one(number: int, shared: Path) -> dict[str, Any]:
    """Make a case: test, calibrate, predict, test again. shared: folder of runs that cases have in common."""
    start = time.process_time()
    random = np.random.default_rng(FIRST_SEED + number)
    study, truth = Study(**STUDY), truth_of(random)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        record, volume, _ = tested(study.replace(truth), folder / "light", random)
        (folder / "found").mkdir()
        (folder / "found" / "runs").symlink_to(shared)
        found = warpwear.infer(
            study,
            unknown=UNKNOWN,
            experiments=[record],
            measured={"volume_counter": volume},
            out=folder / "found",
            seed=number,
        )
        if found.misses:
            return {"case": number, "failed": found.conflicts[0]}
        band = predicted((folder / "found" / "calibrated.toml").read_text(encoding="utf-8"), folder / "sweep")
        _, _, measured = tested(study.replace(truth | {"contact.load": HEAVY}), folder / "heavy", random)
    ends = {key: [float(v) for v in np.percentile(values, BAND)] for key, values in band.items()}
    inside = {key: ends[key][0] <= measured[key] <= ends[key][1] for key in ends}
    about = {"truth": truth, "band": ends, "measured": measured, "inside": inside}
    return {"case": number, **about, "seconds": round(time.process_time() - start, 1)}


def summary(lines: list[dict[str, Any]]) -> str:
    """Say how many cases each band holds, and how wide it is."""
    done = [line for line in lines if "inside" in line]
    text = [f"{len(lines)} cases, {len(lines) - len(done)} without a prediction"]
    for key in done[0]["inside"] if done else ():
        held = sum(line["inside"][key] for line in done)
        width = np.median([(line["band"][key][1] / line["band"][key][0]) for line in done])
        above = sum(line["measured"][key] > line["band"][key][1] for line in done)
        text.append(
            f"{key:<12} in the band {held} of {len(done)} ({100 * held / len(done):.0f} %), {above} above; "
            f"its ends differ by a factor of {width:.2f} in the median"
        )
    text += [f"case {line['case']}: {line['failed']}" for line in lines if "failed" in line]
    return "\n".join(text)


@click.command(help=__doc__)
@click.option("--cases", default=50)
@click.option("--first", default=0)
@click.option("--out", type=click.Path(path_type=Path), default=Path("rehearsal.jsonl"))
@click.option("--summary", "only", is_flag=True, help="Only read the file.")
def main(cases: int, first: int, out: Path, only: bool) -> None:
    warnings.simplefilter("ignore", warpwear.StudyWarning)
    lines = [json.loads(line) for line in out.read_text().splitlines()] if out.exists() else []
    there = {line["case"] for line in lines}
    with tempfile.TemporaryDirectory() as shared, out.open("a") as file:
        for number in range(first, first + cases if not only else first):
            if number not in there:
                try:
                    lines.append(one(number, Path(shared)))
                except (ConvergenceError, InputError) as error:
                    lines.append({"case": number, "failed": str(error)})
                file.write(json.dumps(lines[-1]) + "\n")
                file.flush()
    click.echo(summary(lines))


if __name__ == "__main__":
    main()
