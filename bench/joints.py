"""Joints of random surfaces beside lines of the literature: `python bench/joints.py`, a few minutes.

Prints the tables of docs/validation/joints.md: conductance over the plastic and the elastic line for spectra,
and from plastic to elastic by H/(E* g). Surfaces are Gaussian, periodic, of an area of 1 and an E* of 1.
`--seconds` prints instead what the outputs of a joint cost beside its contact, on pinned cores, and
`--peer PYTHON` the stiffness beside two loads of tamaas, where the interpreter PYTHON has it.
"""

import argparse
import json
import math
import os
import subprocess
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from scipy import signal

import warpwear
from warpwear.laws.elastic import joint_laws

#: Longest wave, roll-off (0: none), shortest wave in cells, Hurst exponent, over the side.
SPECTRA = [
    (0.25, 0.0, 16, 0.8),
    (0.25, 0.0, 32, 0.8),
    (0.25, 0.0, 64, 0.8),
    (0.5, 1 / 16, 16, 0.8),
    (0.25, 0.0, 16, 0.3),
    (0.125, 0.0, 32, 0.8),
]
RATIOS = (0.1, 0.2, 0.3, 0.5, 0.7, 1.0, math.inf)
CROSSING = {"longest": 0.5, "roll_off": 1 / 8, "cut_off": 16, "hurst": 0.8}
#: Mean pressures over E* beside the peer, on surfaces of a gradient of 0.1; its two loads lie that far apart.
PEER_LOADS = (0.0005, 0.002, 0.01)
PEER_STEP = 1e-3


def surface(
    n: int, seed: int, *, longest: float, roll_off: float, cut_off: int, hurst: float
) -> tuple[np.ndarray, float]:
    """Heights of an rms gradient of 1 over an area of 1, and their rms."""
    i = np.fft.fftfreq(n, 1.0 / n)[:, np.newaxis]
    j = np.fft.rfftfreq(n, 1.0 / n)
    k = np.hypot(i, j)
    knee = 1.0 / (roll_off or longest)
    there = (k >= 1.0 / longest) & (k <= n / cut_off)
    amplitude = np.where(there, np.maximum(k, knee) ** -(1.0 + hurst), 0.0)
    generator = np.random.default_rng(seed)
    waves = amplitude * (generator.standard_normal(k.shape) + 1j * generator.standard_normal(k.shape))
    heights = np.fft.irfft2(waves, s=(n, n))
    gradient = [np.fft.irfft2(waves * 2j * math.pi * q, s=(n, n)) for q in (i, j)]
    g = math.sqrt(sum(float(np.mean(part**2)) for part in gradient))
    return heights / g, float(heights.std() / g)


def shown(values: list[float]) -> str:
    return f"{np.mean(values):.2f} ± {np.std(values, ddof=1) / math.sqrt(len(values)):.2f}"


def over_lines(heights: np.ndarray, sigma: float, g: float, pressure: float, hardness: float) -> list[float]:
    """Conductance over the plastic line and over the elastic one, part of the area at H, A E* g/p."""
    contact = warpwear.solve_contact(
        g * heights, cell=1.0 / len(heights), mean_pressure=pressure, modulus=1.0,
        hardness=hardness, boundary="periodic", tolerance=1e-5,
    )  # fmt: skip
    laws = joint_laws(np.array(pressure), sq=g * sigma, slope=g, hardness=hardness, modulus=1.0)
    length, at = contact.conductance(), contact.area_at_hardness / contact.area
    over = [length / float(laws.get(name, math.nan)) for name in ("plastic", "elastic")]
    return [*over, at, contact.area * g / pressure]


def bearing(heights: np.ndarray, sigma: float, part: float) -> float:
    """Conductance over the plastic line of the bearing area."""
    contact = warpwear.solve_contact(heights, cell=1.0 / len(heights), mean_pressure=part, hardness=1.0)
    line = joint_laws(np.array(part), sq=sigma, slope=1.0, hardness=1.0, modulus=1.0)["plastic"]
    return contact.conductance(boundary="periodic") / float(line)


def main(n: int, crossing: int, seeds: int) -> None:
    print("| spectrum | plastic, P/H .003, .01, .03 | elastic, p/(E* g) .0015, .005, .015 |\n|---|---|---|")
    for longest, roll_off, cut_off, hurst in SPECTRA:
        like = {"longest": longest, "roll_off": roll_off, "cut_off": cut_off, "hurst": hurst}
        made = [surface(n, seed, **like) for seed in range(seeds)]
        plastic = [[bearing(*one, part) for one in made] for part in (0.003, 0.01, 0.03)]
        elastic = [
            [over_lines(*one, 0.1, 0.1 * load, math.inf)[1] for one in made]
            for load in (0.0015, 0.005, 0.015)
        ]
        texts = ["  ".join(map(shown, rows)) for rows in (plastic, elastic)]
        print(f"| {longest:g}, {roll_off:g}, {cut_off}, {hurst:g} | {texts[0]} | {texts[1]} |", flush=True)
    print(on_two_meshes(n // 2), flush=True)
    print("\n| H/(E* g) | share at H | G/plastic line | G/elastic line | A E* g/p |\n|---|---|---|---|---|")
    made = [surface(crossing, 100 + seed, **CROSSING) for seed in range(seeds)]
    for ratio in RATIOS:
        rows = np.array([over_lines(*one, 0.1, 0.1 * 0.01, 0.1 * ratio) for one in made])
        plastic, elastic, at, area = (list(column) for column in rows.T)
        print(
            f"| {ratio:g} | {shown(at)} | {shown(plastic)} | {shown(elastic)} | {shown(area)} |", flush=True
        )


def on_two_meshes(n: int) -> str:
    """What cells half as wide change of the conductance of one surface [%]."""
    coarse, sigma = surface(n, 0, longest=0.25, roll_off=0.0, cut_off=32, hurst=0.8)
    fine = signal.resample(signal.resample(coarse, 2 * n, axis=0), 2 * n, axis=1)
    cases = {"elastic, p/(E* g) .005": (over_lines, 0.1, 0.0005, math.inf)}
    cases["capped, H/(E* g) .3"] = (over_lines, 0.1, 0.0005, 0.03)
    cases |= {f"hardness alone, P/H {part:g}": (bearing, part) for part in (0.003, 0.03)}
    changes = []
    for name, (over, *given) in cases.items():
        before, after = (np.ravel(over(heights, sigma, *given)) for heights in (coarse, fine))
        at = 1 if over is over_lines else 0
        changes.append(f"{name}: {100.0 * (before[at] / after[at] - 1.0):.2f} %")
    return f"\nOne surface on {n}² beside {2 * n}² cells: {'; '.join(changes)}"


def beside_tamaas(interpreter: str) -> None:
    """Stiffness beside the slope of tamaas' load over its mean gap, and both programs' area and gap."""
    print("| cells | p/E* | stiffness here, by tamaas | off | area here, by tamaas | mean gap, off |")
    print("|---|---|---|---|---|---|")
    for n in (256, 512):
        heights = 0.1 * surface(n, 0, **CROSSING)[0]
        asked = [load * (1.0 + side * PEER_STEP) for load in PEER_LOADS for side in (-1, 0, 1)]
        with tempfile.TemporaryDirectory() as folder:
            np.save(path := Path(folder) / "heights.npy", heights)
            script = Path(__file__).parent / "contenders" / "mean_gaps.py"
            command = [interpreter, str(script), str(path), *map(repr, asked)]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            return print(f"tamaas is left out: {(done.stderr.strip().splitlines() or ['no word'])[-1]}")
        told = json.loads(done.stdout)
        for load, less, at, more in zip(PEER_LOADS, *(told["found"][i::3] for i in range(3)), strict=True):
            contact = warpwear.solve_contact(heights, cell=1.0 / n, mean_pressure=load, modulus=1.0)
            slope, stiffness = 2.0 * PEER_STEP * load / (less[0] - more[0]), contact.stiffness()
            gap = float(np.maximum(contact.gap, 0.0).mean())
            print(
                f"| {n}² | {load:g} | {stiffness:.5f}, {slope:.5f} | {stiffness / slope - 1.0:.0e} "
                f"| {contact.area:.5f}, {at[1]:.5f} | {gap:.6g}, {gap / at[0] - 1.0:.0e} |", flush=True
            )  # fmt: skip
    print(f"by tamaas {told['version']}, PolonskyKeerRey")


def pin(threads: int) -> None:
    """Keep all threads of this process, those of libraries too, on as many cores."""
    if hasattr(os, "sched_setaffinity"):
        cores = sorted(os.sched_getaffinity(0))[:threads]
        for task in os.listdir("/proc/self/task"):
            os.sched_setaffinity(int(task), cores)


def timed(work: Callable[..., Any], *what: Any, **options: Any) -> tuple[Any, np.ndarray]:
    """What some work returns, and its seconds of processors and on the wall."""
    before = np.array([time.process_time(), time.perf_counter()])
    done = work(*what, **options)
    return done, np.array([time.process_time(), time.perf_counter()]) - before


def conducted(contact: Any, **on: Any) -> tuple[float, float]:
    """Conductance and stiffness of a contact."""
    return contact.conductance(**on), contact.stiffness(**on)


def row(name: str, spent: list[np.ndarray], contact: list[np.ndarray], noted: str) -> None:
    """Print the least of several turns, over that of the contact, and the first one's wall."""
    (least, beside), first = (np.min(one, axis=0) for one in (spent, contact)), spent[0][1]
    ratios = " | ".join(f"{one:.2f}" for one in least / beside)
    print(f"| {name} | {least[0]:.3f} | {least[1]:.3f} | {first:.3f} | {ratios} | {noted} |", flush=True)


def seconds(n: int, device: str, threads: int, turns: int) -> None:
    """Print what conductance and stiffness cost, elastic and capped, and on a CPU flow and heat."""
    is_cpu = device == "cpu"
    pin(threads if is_cpu else os.cpu_count() or 1)
    on: dict[str, Any] = {"device": device, "threads": threads if is_cpu else None}
    load = warpwear.__version__, time.strftime("%F %T"), *os.getloadavg()
    print(f"{n} x {n}, {device}, {threads} threads, least of {turns} turns; version, time and load: {load}\n")
    print("| what | processor s | wall s | first wall s | over contact: processor | wall | transforms |")
    print("|---|---|---|---|---|---|---|")
    heights, _ = surface(n, 100, **CROSSING)
    wanted = {"elastic": (0.01, math.inf), "capped": (0.01, 0.47)}
    if is_cpu:
        wanted |= {"elastic, sparse": (0.002, math.inf), "elastic, dense": (0.1, math.inf)}
    for name, (pressure, hardness) in wanted.items():
        asked = {"mean_pressure": 0.1 * pressure, "hardness": 0.1 * hardness, "cell": 1.0 / n, **on}
        asked |= {"modulus": 1.0, "boundary": "periodic", "tolerance": 1e-5}
        contacts, joints = [], []
        for _ in range(turns):
            contact, spent = timed(warpwear.solve_contact, 0.1 * heights, **asked)
            contacts.append(spent)
            lengths, spent = timed(conducted, contact, **on)
            joints.append(spent)
        made = [one.iterations for one in contact.conductions.values()]
        told = f"A {contact.area:.4f}, {contact.evaluations} pairs"
        row(f"{name}: contact", contacts, contacts, told)
        told = f"{lengths[0]:.7g}, {lengths[1]:.7g}: {' + '.join(f'{2 * one + 2}' for one in made)} pairs"
        row(f"{name}: conductance + stiffness", joints, contacts, told)
        if not is_cpu or name != "elastic":
            continue
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            _, flow = timed(contact.flow_factors)
        heat = {"conductivity": 1.0, "diffusivity": 0.1, "friction": 0.5, "threads": threads}
        flashes = [timed(contact.flash, 1.0, **heat)[1] for _ in range(turns)]
        row("elastic: flow factors", [flow], contacts, "")
        row("elastic: flash", flashes, contacts, "")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("sizes", nargs="*", type=int, help="cells of both tables, and seeds: 1024 512 5")
    parser.add_argument("--seconds", action="store_true", help="print what the outputs cost instead")
    parser.add_argument("--peer", metavar="PYTHON", help="set the stiffness beside tamaas instead")
    parser.add_argument("--size", type=int, default=1024)
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--turns", type=int, default=5)
    given = parser.parse_args()
    if given.peer:
        beside_tamaas(given.peer)
    elif given.seconds:
        seconds(given.size, given.device, given.threads, given.turns)
    else:
        main(*(given.sizes or (1024, 512, 5)))
