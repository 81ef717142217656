"""Predictions of public tests beside what was measured: fetch the files, read them, give the verdicts.

    python bench/others/verdicts.py fetch --into others-data
    python bench/others/verdicts.py measure others-data
    python bench/others/verdicts.py table

The rule stands in README.md of this folder, the readings in words in each `prediction.toml`.
"""

import hashlib
import math
import tomllib
import urllib.request
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote

import click
import numpy as np
import pandas as pd
import tomli_w

from warpwear.measured.rows import read_rows

HERE = Path(__file__).parent
#: A band whose ends differ by more says nothing; a rigid form's point counts with this part on either side.
WIDEST, POINT = 4.0, 0.05
#: Circumference of the track of c1 and c2 [m], and how far their courses are computed [m].
LAP, REACH = 2.0 * math.pi * 3.02e-3, 8.0
Values = dict[str, dict[str, float]]  # case -> quantity -> value
Numbers = np.ndarray[tuple[int, ...], np.dtype[np.float64]]


def verdict(quantity: dict[str, Any], value: float) -> str:
    """Judge a measured value by the rule of README.md."""
    low, high = quantity["low"], quantity["high"]
    if high > WIDEST * low:
        return f"says nothing (band of a factor of {high / low:.2g})"
    rigid = quantity.get("rigid")
    as_well = bool(rigid) and rigid[0] * (1.0 - POINT) <= value <= rigid[1] * (1.0 + POINT)
    beside = ": the rigid form does as well, no agreement" if as_well else ""
    if low <= value <= high:
        return f"inside{beside}"
    off = value / high if value > high else low / value
    return f"off by {off:.2f}{', the rigid form is right' if as_well else ''}"


def groove(path: Path) -> dict[str, float]:
    """Section [µm²] and depth [µm] of a track in a profile of mm and µm with decimal commas."""
    table = pd.read_csv(path, decimal=",")
    x, z = (table[name].to_numpy(float) for name in ("Distance", "Profile"))
    smooth = np.convolve(z, np.full(21, 1.0 / 21.0), "valid")
    place = x[10:-10]
    lowest = int(smooth[100:-100].argmin()) + 100
    reach = round(0.3 / float(np.median(np.diff(place))))
    left = max(lowest - reach, 0) + int(smooth[max(lowest - reach, 0) : lowest].argmax())
    right = lowest + int(smooth[lowest : lowest + reach].argmax())
    inside = slice(left, right + 1)
    line = np.interp(place[inside], place[[left, right]], smooth[[left, right]])
    below = line - smooth[inside]
    area = 1e3 * float(np.trapezoid(below, place[inside]))
    return {"section of the groove": area, "depth of the groove": float(below.max())}


def course(distance: Numbers, cof: Numbers) -> dict[str, float]:
    """Numbers of a course [m, 1] of laps: start, rise, overshoot and level."""
    near = distance < REACH
    laps, which = np.unique((distance[near] // LAP).astype(int), return_inverse=True)
    means = np.bincount(which, cof[near]) / np.bincount(which)
    start, level, top = float(np.median(means[:3])), float(means[-(len(means) // 3) :].mean()), means.max()

    def first(part: float) -> float:
        return float(laps[np.flatnonzero(means >= start + part * (top - start))[0]])

    return {
        "coefficient at the start": start,
        "lap of half the rise": first(0.5),
        "laps from 10 to 90 % of the rise": first(0.9) - first(0.1),
        "overshoot": float(top) / level,
        "level": level,
    }


def trib(data: Path) -> Values:
    """Read profiles and courses of c1 and c2."""
    values = {}
    for case in ("c1", "c2"):
        values[case] = groove(data / f"profile_{case.upper()}.csv")
        if (data / f"{case}.csv").exists():
            table = read_rows(data / f"{case}.csv", "2 [m],4").table
            values[case] |= course(1e-3 * table["distance"], table["cof"])
    return values


def steps_of(path: Path) -> list[float]:
    """Mean coefficient of the second half of each long step of a Rtec record."""
    rows = read_rows(path)
    normal, friction = rows.table["normal force"], rows.table["friction force"]
    turning = (np.abs(rows.table["rpm"]) > 1.0) & (np.abs(normal) > 0.5)
    groups = [np.flatnonzero(turning & (rows.step == number)) for number in range(len(rows.steps))]
    longest = max(group.size for group in groups)
    halves = [group[group.size // 2 :] for group in groups if group.size > longest / 2]
    return [float(np.abs(friction[half] / normal[half]).mean()) for half in halves]


def saint_gobain(data: Path) -> Values:
    """Ratio of the coefficients at 9 and 3 N, step by step."""
    values = {}
    for case, light, heavy in (("316SS", (13, 14), (17, 18)), ("Polyimide", (19, 20), (23, 24))):
        ratios = []
        for low, high in zip(light, heavy, strict=True):
            pairs = zip(steps_of(data / f"{low:03d}.csv"), steps_of(data / f"{high:03d}.csv"), strict=True)
            ratios += [above / below for below, above in pairs]
        values[case] = {
            "coefficient at 9 N over that at 3 N": math.exp(float(np.log(ratios).mean())),
            "standard deviation of its eight": float(np.std(ratios, ddof=1)),
        }
    return values


def pin(path: Path) -> tuple[float, float]:
    """Coefficient and wear depth a metre [µm/m] of the second half of a TE67 record."""
    table = read_rows(path).table
    # Picked where a coefficient would stand: a record of friction has no place for a wear depth.
    depth = read_rows(path, "Distance [m],Displacement").table["cof"]
    moving = np.flatnonzero(table["rpm"] > 1.0)
    half = moving[moving.size // 2 :]
    slope = np.polyfit(1e-3 * table["distance"][half], depth[half], 1)[0]
    return float(table["cof"][half].mean()), abs(float(slope))


def pps(data: Path) -> Values:
    """Ratios of friction and of wear depth at the two loads."""
    values = {}
    for case in ("PPS", "PPS+30PTFE", "PPS+45PTFE"):
        light, heavy = (
            np.mean([pin(path) for path in sorted(data.glob(f"{case}_{load}N_*.tsv"))], axis=0)
            for load in (60, 100)
        )
        values[case] = {
            "coefficient at 98 N over that at 60 N": float(heavy[0] / light[0]),
            "wear depth a metre at 98 N over that at 60 N": float(heavy[1] / light[1]),
        }
    return values


READERS: dict[str, Callable[[Path], Values]] = {"trib": trib, "saint-gobain": saint_gobain, "pps-ptfe": pps}


def table_rows() -> Iterator[tuple[str, ...]]:
    """Give a row for each quantity of each case: what was predicted, what was measured, the verdict."""
    for path in sorted(HERE.glob("*/prediction*.toml")):
        prediction = tomllib.loads(path.read_text(encoding="utf-8"))
        other = path.with_name("measured.toml")
        measured = tomllib.loads(other.read_text(encoding="utf-8")) if other.exists() else {}
        for case in prediction["cases"]:
            for quantity in prediction["quantity"]:
                if case not in quantity.get("cases", prediction["cases"]):
                    continue
                value = measured.get(case, {}).get(quantity["name"])
                known = "" if prediction["blind"] else "known; "
                band = f"{quantity['low']:.3g} to {quantity['high']:.3g}"
                rigid = " to ".join(f"{v:.3g}" for v in dict.fromkeys(quantity.get("rigid", []))) or "–"
                yield (
                    f"{path.parent.name} {case}",
                    f"{quantity['name']}, {quantity['unit']}".removesuffix(", 1"),
                    band,
                    rigid,
                    "not opened" if value is None else f"{value:.3g}",
                    "–" if value is None else known + verdict(quantity, value),
                )


@click.group()
def main() -> None:
    """Predictions of public tests beside what was measured."""


@main.command()
@click.option("--into", type=click.Path(path_type=Path), required=True)
def fetch(into: Path) -> None:
    """Fetch the public files that may not, or need not, lie here."""
    for name, entry in tomllib.loads((HERE / "files.toml").read_text(encoding="utf-8")).items():
        target = into / entry["folder"] / name
        target.parent.mkdir(parents=True, exist_ok=True)
        address = f"https://raw.githubusercontent.com/{entry['repository']}/{entry['commit']}/{quote(entry['path'])}"
        with urllib.request.urlopen(address, timeout=60) as answer:
            content = answer.read()
        if hashlib.sha256(content).hexdigest() != entry["sha256"]:
            raise click.ClickException(f"{address} is not the file that was read: its SHA-256 is another")
        target.write_bytes(content)


@main.command()
@click.argument("data", type=click.Path(path_type=Path, exists=True))
def measure(data: Path) -> None:
    """Read the fetched files and write measured.toml beside each prediction."""
    for folder, reader in READERS.items():
        if (data / folder).exists():
            (HERE / folder / "measured.toml").write_bytes(tomli_w.dumps(reader(data / folder)).encode())


@main.command()
def table() -> None:
    """Print the table of the documentation."""
    click.echo("| test | quantity | predicted, 5 to 95 % | rigid form | measured | verdict |")
    click.echo("|---|---|---|---|---|---|")
    for row in table_rows():
        click.echo("| " + " | ".join(row) + " |")


if __name__ == "__main__":
    main()
