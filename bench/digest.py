"""Runs every preset and its variants on coarse cells, keeps the results, and compares two kept folders.

    python bench/digest.py make FOLDER [--threads 1,2] [--device cpu] [--only v1,track]
    python bench/digest.py compare FOLDER OTHER [--tolerance 1e-12]

Whoever changes how a step is computed makes a folder before and one after, and compares them: every dataset
of every `result.h5` is to be bit for bit what it was. `make` leaves out what is there already and writes a
digest of every dataset beside the result, as digests.txt. `compare` takes the cases that both folders have,
names what differs and by how much, and ends with status 1 where that is more than the tolerance.
"""

import hashlib
import sys
import time
from pathlib import Path
from typing import Any

import click
import h5py
import numpy as np

import warpwear

#: What a preset keeps for looking at is kept here in all digits, at more distances: steps end at them.
KEPT: dict[str, dict[str, Any]] = {
    "v3-fine": {
        "output.precision": "double",
        "output.snapshots": ["0.3 mm", "3 mm", "30 mm", "240 mm", "600 mm", "1200 mm", "2400 mm"],
    },
}
HALF_SPACE = {"contact.law": "half-space", "grid.cell": "10 um", "sliding.distance": "60 mm"}
#: Case: the preset and what is changed in it.
CASES: dict[str, tuple[str, dict[str, Any]]] = {
    "v1": ("v1", {}),
    "v2": ("v2", {}),
    "v3": ("v3", {}),
    "v3-fine": ("v3-fine", {"grid.cell": "5 um"}),
    "v3-fine-springs": (
        "v3-fine",
        {"grid.cell": "5 um", "contact.stiffness": "1.9e6 N/mm^3", "sliding.distance": "300 mm"},
    ),
    "two-scale": ("two-scale", {"grid.cell": "5 um", "sliding.distance": "300 mm"}),
    "two-scale-load": (
        "two-scale",
        {"grid.cell": "5 um", "sliding.distance": "60 mm", "patches.coupling": "load"},
    ),
    "track": ("track", {"grid.cell": "10 um", "sliding.distance": "480 mm"}),
    "track-5": ("track", {"grid.cell": "5 um", "sliding.distance": "90 mm"}),
    "track-keep": (
        "track",
        {"grid.cell": "10 um", "sliding.distance": "240 mm", "sliding.plastic": "keep"},
    ),
    "track-full": ("track", {"grid.cell": "10 um", "sliding.distance": "120 mm", "sliding.track": "full"}),
    "coat": ("coat", {"grid.cell": "8 um"}),
    "v2-updated": (
        "v2",
        {"contact.bulk_update": "updated", "stepping.scheme": "implicit", "sliding.distance": "600 mm"},
    ),
    "v1-updated": ("v1", {"contact.bulk_update": "updated", "sliding.distance": "600 mm"}),
    "v1-explicit": ("v1", {"stepping.scheme": "explicit", "sliding.distance": "300 mm"}),
    "v3-fine-exponential": (
        "v3-fine",
        {
            "grid.cell": "10 um",
            "wear.law": "exponential",
            "wear.decay": "0.001 1/mm",
            "sliding.distance": "300 mm",
        },
    ),
    "v3-fine-running-in": (
        "v3-fine",
        {
            "grid.cell": "10 um",
            "wear.law": "running-in",
            "wear.running_in": "100 mm",
            "wear.initial_counter": "3e-3 mm^3/N/m",
            "sliding.distance": "300 mm",
        },
    ),
    "v3-fine-across": (
        "v3-fine",
        {"grid.cell": "10 um", "wear.distance_factor": "across", "sliding.distance": "300 mm"},
    ),
    "v3-fine-explicit": (
        "v3-fine",
        {"grid.cell": "10 um", "stepping.scheme": "explicit", "sliding.distance": "60 mm"},
    ),
    "half-space": ("v3-fine", HALF_SPACE),
    "half-space-patches": ("two-scale", HALF_SPACE),
    "half-space-track": ("track", HALF_SPACE),
    "half-space-track-keep": ("track", HALF_SPACE | {"sliding.plastic": "keep"}),
    "static": ("v3-fine", {"grid.cell": "5 um", "sliding.distance": "0 mm"}),
    "bearing-curve": (
        "v1",
        {
            "wear.law": "bearing-curve",
            "stepping.scheme": "implicit",
            "disc.synthetic.kind": "self-affine",
            "disc.synthetic.ra": "1 um",
            "sliding.distance": "60 mm",
        },
    ),
}


@click.group()
def main() -> None:
    """Are the results what they were?"""


@main.command()
@click.argument("folder", type=click.Path(path_type=Path))
@click.option("--threads", default="1,2", show_default=True, help="Numbers of threads, each a run.")
@click.option("--device", default="cpu", show_default=True, help="cpu, or cuda:0 for the first GPU.")
@click.option("--only", default="", help="Cases, separated by commas. [default: all]")
def make(folder: Path, threads: str, device: str, only: str) -> None:
    """Run the cases into FOLDER, a run folder a case and number of threads, with digests.txt in it."""
    chosen = only.split(",") if only else [*CASES]
    unknown = sorted(set(chosen) - set(CASES))
    if unknown:
        raise click.BadParameter(f"--only {','.join(unknown)}: allowed are {', '.join(CASES)}")
    for name in chosen:
        preset, changes = CASES[name]
        for count in map(int, threads.split(",")):
            out = folder / f"{name}-{count}"
            if (out / "digests.txt").is_file():
                continue
            start = time.perf_counter()
            try:
                study = warpwear.Study.load(preset).replace(KEPT.get(preset, {}) | changes)
                warpwear.run(
                    study, out=out, device=device, threads=count, plots=False, overwrite=True
                ).close()
            except warpwear.InputError as error:
                click.echo(f"{out.name}: refused: {error}")
                continue
            digests = digests_of(out / "result.h5")
            (out / "digests.txt").write_text("".join(f"{value} {key}\n" for key, value in digests.items()))
            whole = hashlib.sha256("".join(digests.values()).encode()).hexdigest()[:16]
            click.echo(f"{out.name}: {whole}, {len(digests)} datasets, {time.perf_counter() - start:.1f} s")


@main.command()
@click.argument("folder", type=click.Path(path_type=Path, exists=True))
@click.argument("other", type=click.Path(path_type=Path, exists=True))
@click.option("--tolerance", default=0.0, show_default=True, help="Allowed difference, relative.")
def compare(folder: Path, other: Path, tolerance: float) -> None:
    """Say which datasets of the cases in FOLDER differ from those in OTHER, and by how much."""
    worst = 0.0
    compared = 0
    for path in sorted(folder.glob("*/result.h5")):
        beside = other / path.parent.name / path.name
        if not beside.is_file():
            continue
        compared += 1
        apart = differences(datasets_of(path), datasets_of(beside))
        worst = max([worst, *apart.values()])
        largest = sorted(apart, key=lambda key: -apart[key])
        told = ", ".join(f"{key} {apart[key]:.1e}" for key in largest[:6]) + (", …" if largest[6:] else "")
        click.echo(f"{path.parent.name}: " + (f"{len(apart)} differ: {told}" if apart else "identical"))
    click.echo(f"{compared} cases compared, largest difference {worst:.1e}")
    sys.exit(1 if worst > tolerance or not compared else 0)


def differences(one: dict[str, Any], other: dict[str, Any]) -> dict[str, float]:
    """Largest difference over the largest value, of every dataset that is not the same bit for bit.

    Infinite where it is missing in one of them, has another shape, is no number or is NaN elsewhere.
    """
    apart = dict.fromkeys(one.keys() ^ other.keys(), np.inf)
    for key in one.keys() & other.keys():
        a, b = one[key], other[key]
        if a.shape == b.shape and a.dtype == b.dtype and a.tobytes() == b.tobytes():
            continue
        comparable = a.shape == b.shape and a.dtype.kind == b.dtype.kind == "f"
        if not comparable or not np.array_equal(np.isnan(a), np.isnan(b)):
            apart[key] = np.inf
            continue
        finite = np.isfinite(a) & np.isfinite(b)
        scale = float(np.abs(a[finite]).max(initial=0.0)) or 1.0
        apart[key] = float(np.abs(a[finite] - b[finite]).max(initial=0.0)) / scale
    return apart


def datasets_of(path: Path) -> dict[str, Any]:
    """All datasets of a result file as arrays, by their names."""
    found: dict[str, Any] = {}
    with h5py.File(path, "r") as file:
        file.visititems(
            lambda name, item: (
                found.update({name: np.asarray(item)}) if isinstance(item, h5py.Dataset) else None
            )
        )
    return found


def digests_of(path: Path) -> dict[str, str]:
    """A digest of every dataset of a result file, of its bytes, type and shape, by its name."""
    return {
        name: hashlib.sha256(f"{a.dtype.str} {a.shape} ".encode() + a.tobytes()).hexdigest()[:16]
        for name, a in sorted(datasets_of(path).items())
    }


if __name__ == "__main__":
    main()
