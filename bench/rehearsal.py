"""What a prediction is worth: tests in which everything is known, from the machine's files to the band.

    python bench/rehearsal.py --first 100 --cases 50 --shard 0/15 --out rehearsal-0.jsonl
    python bench/rehearsal.py --summary rehearsal-*.jsonl

A test is made by a run whose surface, wear coefficient, film and shear strength nobody is told. Its record
is written as a Rtec tribometer writes one (forces, position, recipe steps, footer), with correlated noise,
and its worn ball as a map, with noise. Both are read back by the readers of the program, the study is
calibrated on them at 4 N (`warpwear.infer`, by surfaces of its own), and its sweep predicts
the pair at 8 N. The hidden pair is tested at 8 N as well, on a fresh ball and a fresh track, that is another
surface of the same kind. Held are the coefficient of friction, read from its record, in the first and in the
last third of the distance, and the volume that the ball has lost, read from its map: each inside the 5 to
95 % of the prediction or not. The record is compared with a band that has its noise, which a machine's owner
knows; what the pair truly does, with the band as it is. Ninety per cent of the cases should be inside. Case n
has the seed 9000 + n. A case is a line of the file, with all draws, and is not made again.
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
from warpwear.results.ensemble import BAND, RANK
from warpwear.results.summary import course

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
    # A third is six cycles: what is read of the record has a point a cycle, of two strokes.
    "sliding": {"distance": "1080 mm", "stroke": "30 mm", "track": "2.4 mm", "shift": 6, "speed": "10 mm/s"},
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
#: Runs of a prediction.
DRAWS = 32
Numbers = dict[str, float]


def truth_of(random: np.random.Generator) -> dict[str, str]:
    """Draw what nobody is told, as keys of the study."""
    keys = {}
    for key, prior in UNKNOWN.items():
        _, low, _, high, unit = prior.split()
        keys[key] = f"{float(low) * (float(high) / float(low)) ** random.random():.6g} {unit}"
    return keys | {"disc.synthetic.seed": int(random.integers(1000, 1_000_000))}


def write_record(result: Result, path: Path, random: np.random.Generator) -> None:
    """Write the record of a run as a Rtec tribometer does: title, steps, a field more a row, footer.

    The signal is the mean of each pass: the 2.4 mm of the track stand for the whole stroke. A record of the
    course along them would lack, with the ends of strokes that a reader cuts, ever the same places.
    """
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
    cof = np.interp(distance, *course(result, "cof")) + noise
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


def held_of(cof: FloatArray, volume: float) -> Numbers:
    """Name what is held: mean coefficients of the first and the last third, and the ball's volume [mm³]."""
    third = cof.size // 3
    return {
        "first third": float(cof[:third].mean()),
        "last third": float(cof[-third:].mean()),
        "volume": volume,
    }


def truth_held(result: Result) -> Numbers:
    """Name what a run holds, without noise and instrument."""
    return held_of(course(result, "cof")[1], float(result.history["wear_volume_counter"][-1]))


def tested(study: Study, folder: Path, random: np.random.Generator) -> tuple[Path, str, dict[str, Numbers]]:
    """Make a test and read its files back: record, volume with its error, and what is measured and true."""
    folder.mkdir(parents=True)
    with warpwear.run(study) as result:
        write_record(result, folder / "record.csv", random)
        ball_file = write_ball(result, folder, random)
        true = truth_held(result)
    read = read_experiment(folder / "record.csv", stroke=study.sliding.stroke)
    options = ("--ball", "--radius", "3 mm", "--pixel", "20 um", "--height-unit", "mm", "--json")
    ball = json.loads(called("surface", str(ball_file), *options, "--no-figure"))["ball"]
    volume, error = ball["volume_mm3"], ball["volume_error_mm3"]
    held = {"measured": held_of(read.cof, volume), "true": true}
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
            rows.append(truth_held(one))
    return {key: [row[key] for row in rows] for key in rows[0]}


def noise_of(length: float) -> float:
    """Return the standard deviation of a record's mean over a length [mm], of the noise that it is made with.

    The mean over L of noise of deviation σ and length ℓ has the variance 2 σ² ℓ/L (1 − ℓ/L (1 − e^(−L/ℓ))).
    """
    part = LENGTH / length
    return float(SCATTER * np.sqrt(2.0 * part * (1.0 - part * (1.0 - np.exp(-1.0 / part)))))


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
            tests=[{"record": record, "volume_counter": volume}],
            out=folder / "found",
            seed=number,
        )
        if found.misses:
            return {"case": number, "failed": found.conflicts[0]}
        posterior = {row["key"]: [row["low"], row["median"], row["high"]] for row in found.table}
        drawn = predicted(
            (folder / "found" / "calibrated.toml").read_text(encoding="utf-8"), folder / "sweep"
        )
        heavy = truth | {"contact.load": HEAVY}
        tests = {}
        for name, seed in (("fresh", int(random.integers(1000, 1_000_000))), ("same", None)):
            other = heavy if seed is None else heavy | {"disc.synthetic.seed": seed}
            _, _, tests[name] = tested(study.replace(other), folder / name, random)
    seconds = round(time.process_time() - start, 1)
    about = {"truth": truth, "posterior": posterior, "drawn": drawn, "tests": tests}
    return {"case": number, **about, "seconds": seconds}


def inside_of(line: dict[str, Any], of: str = "measured") -> dict[str, tuple[float, float, float]]:
    """Give the band of each quantity of a case, and its value in the second test: low, high, value.

    of: "measured", to which the band has the machine's noise, or "true".
    """
    sides = {}
    third = Study(**STUDY).sliding.total / 3.0
    random = np.random.default_rng(line["case"])
    for key, values in line["drawn"].items():
        noise = 0.0 if of == "true" or key == "volume" else noise_of(third)
        low, high = np.percentile(random.normal(values, noise), BAND, method=RANK)
        sides[key] = float(low), float(high), line["tests"]["fresh"][of][key]
    return sides


def summary(lines: list[dict[str, Any]]) -> str:
    """Say how many cases each band holds, and how wide it is."""
    cases = [line for line in lines if "drawn" in line]
    text = [f"{len(lines)} cases, {len(lines) - len(cases)} without a prediction"]
    for of in ("measured", "true"):
        done = [inside_of(line, of) for line in cases]
        for key in done[0] if done else ():
            low, high, value = np.array([sides[key] for sides in done]).T
            inside = int(((low <= value) & (value <= high)).sum())
            text.append(
                f"{of} {key:<12} in the band {inside} of {len(done)} ({100 * inside / len(done):.0f} %), "
                f"{(value > high).sum()} above; its ends differ by a factor of {np.median(high / low):.2f}"
            )
    text += [f"case {line['case']}: {line['failed']}" for line in lines if "failed" in line]
    return "\n".join(text)


def lines_of(path: Path) -> list[dict[str, Any]]:
    """Read a file of cases, which may not be there yet."""
    return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []


@click.command(help=__doc__)
@click.option("--cases", default=50)
@click.option("--first", default=0)
@click.option("--shard", default="0/1", help="Which part of the cases, of how many.")
@click.option("--out", type=click.Path(path_type=Path), default=Path("rehearsal.jsonl"))
@click.option("--summary", "only", is_flag=True, help="Only read the files.")
@click.argument("files", nargs=-1, type=click.Path(path_type=Path, exists=True))
def main(cases: int, first: int, shard: str, out: Path, only: bool, files: tuple[Path, ...]) -> None:
    warnings.simplefilter("ignore", warpwear.StudyWarning)
    if only:
        return click.echo(summary([line for file in files for line in lines_of(file)]))
    part, parts = map(int, shard.split("/"))
    there = {line["case"] for line in lines_of(out)}
    with tempfile.TemporaryDirectory() as shared, out.open("a") as file:
        for number in range(first + part, first + cases, parts):
            if number not in there:
                try:
                    line = one(number, Path(shared))
                except (ConvergenceError, InputError) as error:
                    line = {"case": number, "failed": str(error)}
                file.write(json.dumps(line) + "\n")
                file.flush()
    click.echo(summary(lines_of(out)))


if __name__ == "__main__":
    main()
