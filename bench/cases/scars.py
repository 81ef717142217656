"""How often the volumes of a scar, after less before, are off by more than their errors.

    python bench/cases/scars.py [--cases 40] [--jobs 8] [--kinds self-affine turned rolled-off real]
    python bench/cases/scars.py --wrong 20 [--jobs 8] [--kinds ...]

cuts scars of known volume (bowls, bowls and grooves with pile-up, truncated asperities) into made and real
measured surfaces, of which before and after are shifted by up to 6 % of the field, turned by up to 3°, tilted
and have noise of their own. It prints, for each kind of surface and of scar, how many were refused, and for
the volumes worn, piled up and net and the area the part of cases within one and two errors, the mean and
the standard deviation in errors, and the median error; then pooled over a kind of surface, and over all. The
real ones are read from ../shared/surfaces and kept in the file of --surfaces, from which they are taken where
it is there already; with neither that kind is left out. A case takes about two seconds. With --wrong it lays
measurements of two places over each other, so many of each kind of surface, and prints how many are accepted
as one place, and the correlations of these.
"""

import argparse
import os
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ.setdefault(name, "1")
sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))

from cases_worn import FIELDS, KINDS, PIXEL, SCARS, SHARED, Off, measured_fields, off_by_errors, pair  # noqa: E402

from warpwear.errors import InputError  # noqa: E402
from warpwear.surfaces.worn.registration import difference  # noqa: E402

QUANTITIES = ("worn", "piled up", "net", "track", "area", "profile")


def take_surfaces(file: Path | None) -> None:
    """Take the real surfaces from a file; write it first where it is not there."""
    if file is None:
        return
    if not file.is_file():
        fields = {f"field{n}": np.float32(z) for n, z in enumerate(measured_fields())}
        np.savez_compressed(file, **fields)
    with np.load(file) as kept:
        FIELDS[:] = [np.float64(kept[name]) for name in kept.files]


def one(case: tuple[int, int, str, str]) -> Off | str:
    """Measure one case: seed, number, kind of surface, kind of scar."""
    return off_by_errors(*case)


def wrong(case: tuple[int, int, str]) -> float | str:
    """Lay two places over each other: seed, number, kind. Return the correlation, or why they are refused."""
    seed, number, kind = case
    here, there = (pair(np.random.default_rng([seed, number, k]), kind, "bowl", half=k) for k in (0, 1))
    try:
        size = (PIXEL, PIXEL)
        return difference(here.after, there.before, pixel=size, earlier_pixel=size).correlation
    except InputError as error:
        return str(error)


def wrong_pairs(pool: ProcessPoolExecutor, kinds: Sequence[str], count: int, seed: int) -> None:
    """Print how many pairs of two places are accepted."""
    every = 0
    for kind in kinds:
        found = list(pool.map(wrong, [(seed, number, kind) for number in range(count)]))
        accepted = sorted(f for f in found if not isinstance(f, str))
        every += len(accepted)
        print(f"{kind:12} {len(accepted)} of {count} wrong pairs accepted", np.round(accepted, 2), flush=True)
    print(f"together     {every} of {count * len(kinds)}")


def told(name: str, found: Sequence[Off | str]) -> None:
    """Print the line of some cases."""
    known = [f for f in found if not isinstance(f, str)]
    print(f"{name:24} {len(known):4} of {len(found)}", end="")
    for quantity in QUANTITIES:
        off = np.concatenate([np.ravel(f.off[quantity]) for f in known if quantity in f.off] or [[]])
        if off.size:
            error = np.median([f.relative[quantity] for f in known if quantity in f.relative] or [np.nan])
            one, two = (100 * np.mean(np.abs(off) < k) for k in (1, 2))
            scatter = f"{off.mean():+.1f} ± {off.std():.1f} ({100 * error:.2g} %)"
            print(f" | {quantity} {one:3.0f} {two:3.0f} % {scatter}", end="")
    print(flush=True)


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--cases", type=int, default=40)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--kinds", nargs="+", default=list(KINDS), choices=list(KINDS))
    parser.add_argument("--wrong", type=int, default=0, metavar="N", help="pairs of two places, a kind")
    parser.add_argument("--seed", type=int, default=23)
    parser.add_argument("--surfaces", type=Path, metavar="FILE.npz", help="real surfaces, to keep or to take")
    asked = parser.parse_args(arguments)
    take_surfaces(asked.surfaces)
    kinds = [kind for kind in asked.kinds if kind != "real" or FIELDS or SHARED.is_dir()]
    workers = partial(ProcessPoolExecutor, asked.jobs, initializer=take_surfaces, initargs=(asked.surfaces,))
    pairs = [(kind, worn) for kind in kinds for worn in SCARS]
    cases = [(asked.seed, n, kind, worn) for kind, worn in pairs for n in range(asked.cases)]
    if asked.wrong:
        with workers() as pool:
            wrong_pairs(pool, kinds, asked.wrong, asked.seed)
        return
    print("within 1 and 2 errors, mean ± standard deviation in errors (median error in % of the true value)")
    every: list[Off | str] = []
    with workers() as pool:
        found = pool.map(one, cases)
        for kind in kinds:
            first = len(every)
            for worn in SCARS:
                part = [next(found) for _ in range(asked.cases)]
                told(f"{kind}, {worn}", part)
                every += part
            told(f"{kind}, all", every[first:])
    told("pooled", every)
    for text in sorted({f for f in every if isinstance(f, str)}):
        print(f"refused: {text}")


if __name__ == "__main__":
    main()
