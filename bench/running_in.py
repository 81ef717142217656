"""Courses of contact area and friction of bodies that wear in pieces, beside what is known of them.

    python bench/running_in.py --jobs 16
    python bench/running_in.py --jobs 16 --only seed half --csv courses.csv
    python bench/running_in.py --read courses.csv --draw bench/pictures/running_in.png

Every case is a run of the reference of wear in pieces (a ball on a self-affine disc of 1.2 mm, half-space,
5 µm cells) with a few keys changed, in a process of its own with one thread. The table has the mean area of
passes of 30 mm by the distance at their ends, or with a film ("μ …") the mean coefficient of friction; what
is known stands below it, case by case. --draw draws all courses in one picture; with --read they are those
of a table of --csv, and nothing is run.
"""

import argparse
import csv
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

import warpwear
from warpwear import Study

PASS = 30.0  # [mm]
ENDS = (30.0, 90.0, 150.0, 240.0, 360.0, 480.0, 600.0, 900.0, 1200.0, 2400.0)  # of the passes shown [mm]
#: The preset that a case without film and growing junctions is made of, and what it leaves out.
PRESET = "running-in"
BARE: dict[str, Any] = {"friction.film": None, "friction.junction_growth": 0.0}
QUIET: dict[str, Any] = {"output.snapshots": [], "run.checkpoint": "inf s"}
#: Friction of the reference, means of the 30 mm before each distance [mm].
FRICTION = {
    30.0: 0.070,
    90.0: 0.168,
    150.0: 0.280,
    240.0: 0.393,
    360.0: 0.453,
    480.0: 0.465,
    600.0: 0.472,
    900.0: 0.485,
}
#: Friction at 30, 90 and 150 mm with dust, by its share and the film [nm].
DUST_FRICTION = {
    (0.01, 10.0): (0.070, 0.167, 0.344),
    (0.05, 10.0): (0.095, 0.501, 0.561),
    (0.20, 300.0): (0.071, 0.130, 0.236),
}
#: Lengths over which films wear through [mm].
LENGTHS = {
    "μ, seed 1": 89.0,
    "μ, d* 40, t 1.2": 164.0,
    "μ, d* 130, t 0.6": 274.0,
    "μ, d* 20, t 0.3": 79.0,
    "μ, Ra 1": 48.0,
}
CLASSICAL = {"wear.particle": None, "wear.particle_thickness": None}
SMOOTH = {"disc.synthetic.kind": "flat", "wear.disc": "0 mm^3/N/m", "contact.hardness": "inf MPa"}
SEEDS = range(1, 6)


COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
LINES = ("-", "--", ":")
REFERENCE = {"friction": "reference", "area": "pieces alone, Ra 0.3 µm"}
#: What is drawn: by what it shows, title of a panel -> case -> label; and the cases of the reference's band.
PANELS: dict[str, tuple[dict[str, dict[str, str]], list[str]]] = {
    "friction": (
        {
            "ingredients": {
                "μ, all dust": "dust, no pieces",
                "μ, no growth": "junctions do not grow",
                "μ, film of 100 nm": "film of 100 nm",
                "μ, dents kept": "dents kept",
                "μ, to 2400 mm": "to 2400 mm",
                "μ, to 2400 mm, dents kept": "to 2400 mm, dents kept",
            },
            "dust and start": {
                "μ, dust 0.01, film 10": "1 % dust",
                "μ, dust 0.05, film 10": "5 % dust",
                "μ, dust 0.2, film 300": "20 % dust, film of 300 nm",
                "μ, uniform start": "uniform start",
            },
            "size of a piece": {
                "μ, d* 20, t 0.3": "d* 20, t 0.3 µm",
                "μ, d* 40, t 1.2": "d* 40, t 1.2 µm",
                "μ, d* 130, t 0.6": "d* 130, t 0.6 µm",
            },
            "load, Ra, mesh": {
                "μ, load 4 N": "4 N",
                "μ, load 16 N": "16 N",
                "μ, Ra 1": "Ra 1 µm",
                "μ, half step": "half the step",
                "μ, 2.5 µm cells": "cells of 2.5 µm",
                "μ, track of 30 mm": "track of 30 mm",
            },
        },
        [f"μ, seed {seed}" for seed in range(1, 6)],
    ),
    "area": (
        {
            "Ra 0.3 µm, no film": {
                "Ra 0.3, all dust": "dust, no pieces",
                "Ra 0.3, dust 0.2": "20 % dust",
                "Ra 0.3, dust 0.05": "5 % dust",
                "Ra 0.3, dents kept": "dents kept",
                "Ra 0.3, uniform start": "uniform start",
                "Ra 3, all dust": "Ra 3 µm, dust, no pieces",
                "Ra 3, to 2400 mm": "Ra 3 µm, to 2400 mm",
            },
            "dust, Ra 3 µm": {
                "Ra 3, seed 1": "no dust",
                "Ra 3, dust 0.01": "1 % dust",
                "Ra 3, dust 0.05": "5 % dust",
                "Ra 3, dust 0.2": "20 % dust",
            },
            "size of a piece": {
                "Ra 0.3, d* 20, t 0.1": "d* 20, t 0.1 µm",
                "Ra 0.3, d* 20, t 0.3": "d* 20, t 0.3 µm",
                "Ra 0.3, d* 40, t 0.6": "d* 40, t 0.6 µm",
                "Ra 0.3, d* 40, t 1.2": "d* 40, t 1.2 µm",
            },
            "load, H, Ra, mesh": {
                "Ra 0.3, load 4 N": "4 N",
                "Ra 0.3, load 16 N": "16 N",
                "Ra 0.3, H 1200 MPa": "H 1200 MPa",
                "Ra 1, seed 1": "Ra 1 µm",
                "Ra 0.3, half step": "half the step",
                "Ra 0.3, 2.5 µm cells": "cells of 2.5 µm",
            },
        },
        [f"Ra 0.3, seed {seed}" for seed in range(1, 6)],
    ),
}


class Course(NamedTuple):
    """What a case came to."""

    areas: dict[float, float]  # end of a pass [mm] -> mean area [mm²]
    last: float  # area of the last step [mm²]
    fully: float  # F/H [mm²]
    pending: float  # part of what the ball was to lose, after 100 mm or at the end
    slope: float  # rms, of the ball in the scar's middle, along and across, form removed
    conservation: float  # largest residual of worn and pending volumes, relative
    transforms: float  # pairs a step
    seconds: float
    steps: int
    friction: dict[float, float]  # end of a pass [mm] -> mean coefficient
    bare: dict[float, float]  # mean bare fraction; empty without a film
    mixture: float  # largest error of the formula of mixtures, relative
    length: float  # over which the film wears through [mm], as fitted

    def at(self, end: float) -> float:
        return self.areas.get(end, np.nan)


def case(distance: float, ra: float = 0.3, seed: int = 1, **changes: Any) -> dict[str, Any]:
    """The keys of a case that slides so far [mm] on a disc of this Ra [µm]; changes with __ for the dot."""
    dotted = {name.replace("__", "."): value for name, value in changes.items()}
    about = {"sliding.distance": f"{distance} mm", "disc.synthetic.ra": f"{ra} um"}
    return QUIET | BARE | about | {"disc.synthetic.seed": seed} | dotted


def friction_cases() -> dict[str, dict[str, Any]]:
    """Cases with a film and growing junctions by name."""

    def with_film(distance: float, **changes: Any) -> dict[str, Any]:
        dotted = {name.replace("__", "."): value for name, value in changes.items()}
        return {key: value for key, value in case(distance, 3.0).items() if key not in BARE} | dotted

    found = {f"μ, seed {seed}": with_film(900.0, disc__synthetic__seed=seed) for seed in SEEDS}
    found |= {
        "μ, half step": with_film(480.0, sliding__shift=2),
        "μ, 2.5 µm cells": with_film(90.0, grid__cell="2.5 um", sliding__shift=8),
        "μ, track of 30 mm": with_film(90.0, sliding__track="full", disc__synthetic__period="10 mm"),
        "μ, film of 100 nm": with_film(240.0, friction__film__thickness="100 nm"),
        "μ, uniform start": with_film(480.0, wear__pending_start="uniform"),
        "μ, dents kept": with_film(900.0, sliding__plastic="keep"),
        "μ, to 2400 mm": with_film(2400.0),
        "μ, to 2400 mm, dents kept": with_film(2400.0, sliding__plastic="keep"),
        "μ, Ra 1": with_film(480.0, disc__synthetic__ra="1 um"),
        "μ, load 4 N": with_film(480.0, contact__load="4 N"),
        "μ, load 16 N": with_film(480.0, contact__load="16 N"),
        "μ, all dust": with_film(480.0) | CLASSICAL,
        "μ, no growth": with_film(480.0, friction__junction_growth=0.0),
    }
    for dust, film in DUST_FRICTION:
        keys = {"wear.dust_fraction": dust, "friction.film.thickness": f"{film} nm"}
        found[f"μ, dust {dust:g}, film {film:g}"] = with_film(240.0) | keys
    for diameter, thickness in ((40.0, 1.2), (130.0, 0.6), (20.0, 0.3)):
        keys = {"wear.particle": f"{diameter} um", "wear.particle_thickness": f"{thickness} um"}
        found[f"μ, d* {diameter:g}, t {thickness:g}"] = with_film(900.0) | keys
    return found


def cases() -> dict[str, dict[str, Any]]:
    """Every case by name."""
    found = {f"Ra 0.3, seed {seed}": case(360.0, seed=seed) for seed in SEEDS}
    found |= {f"Ra 3, seed {seed}": case(480.0, 3.0, seed) for seed in SEEDS[:3]}
    found |= {f"Ra 1, seed {seed}": case(480.0, 1.0, seed) for seed in SEEDS[:1]}
    for ra in (0.3, 3.0):
        found |= {
            f"Ra {ra:g}, half step": case(240.0, ra, sliding__shift=2),
            f"Ra {ra:g}, 2.5 µm cells": case(90.0, ra, grid__cell="2.5 um", sliding__shift=8),
            f"Ra {ra:g}, uniform start": case(240.0, ra, wear__pending_start="uniform"),
            f"Ra {ra:g}, dents kept": case(240.0, ra, sliding__plastic="keep"),
            f"Ra {ra:g}, load 4 N": case(240.0, ra, contact__load="4 N"),
            f"Ra {ra:g}, load 16 N": case(240.0, ra, contact__load="16 N"),
            f"Ra {ra:g}, H 1200 MPa": case(240.0, ra, contact__hardness="1200 MPa"),
            f"Ra {ra:g}, all dust": case(480.0, ra) | CLASSICAL,
        }
        for dust in (0.01, 0.05, 0.2):
            found[f"Ra {ra:g}, dust {dust:g}"] = case(240.0, ra, wear__dust_fraction=dust)
        for diameter, thickness in ((40.0, 1.2), (20.0, 0.3), (20.0, 0.1), (40.0, 0.6)):
            keys = {"wear.particle": f"{diameter} um", "wear.particle_thickness": f"{thickness} um"}
            found[f"Ra {ra:g}, d* {diameter:g}, t {thickness:g}"] = case(240.0, ra) | keys
    found["smooth ball, dust alone"] = case(600.0) | CLASSICAL | SMOOTH
    found["smooth ball, dust 1"] = case(600.0, wear__dust_fraction=1.0) | SMOOTH
    found["Ra 3, to 2400 mm"] = case(2400.0, 3.0)
    found["Ra 3, to 2400 mm, dents kept"] = case(2400.0, 3.0, sliding__plastic="keep")
    return found


def course_of(changes: dict[str, Any]) -> Course:
    """Run a case."""
    study = Study.load(PRESET).replace(changes)
    began = time.perf_counter()
    with warpwear.run(study, threads=1, progress=False) as result:
        history = result.history
        slid, area = history["distance"], history["area_contact"]
        weights = history["increment"]

        def means(values: Any) -> dict[float, float]:
            within = {end: (slid > end - PASS + 1e-6) & (slid < end + 1e-6) for end in ENDS}
            reached = {end: steps for end, steps in within.items() if slid[-1] > end - 1e-6}
            return {end: float(np.average(values[s], weights=weights[s])) for end, s in reached.items()}

        mixed, fit = 0.0, {}
        if study.film is not None:
            bare, caps = history["bare_fraction"], (study.film.part_filmed, study.film.part_bare)
            tau_f, tau_m = study.friction.film.shear_strength, study.friction.shear_strength
            mixture = (1 - bare) * tau_f + bare * tau_m
            mixture /= study.hardness * ((1 - bare) * caps[0] + bare * caps[1])
            mixed = float(np.max(np.abs(mixture / history["cof"] - 1.0)[slid > PASS]))
            fit = result.summary["film"].get("fit") or {}
        off = [0.0]
        for body in ("sphere", "disc"):
            asked = history[f"archard_volume_{body}"]
            worn = history[f"wear_volume_{body}"] + history.get(f"pending_volume_{body}", 0.0)
            off.append(float(np.max(np.abs(worn - asked) / np.where(asked > 0.0, asked, 1.0))))
        after = min(int(np.searchsorted(slid, 100.0)), slid.size - 1)
        pending = history.get("pending_volume_sphere", np.zeros_like(slid))[after]
        return Course(
            means(area),
            float(area[-1]),
            study.contact.load / study.hardness,
            float(pending / history["archard_volume_sphere"][after]),
            # of one direction
            float(result.surface_evolution.table["sdq_sphere"][-1]) / np.sqrt(2.0),
            max(off),
            float(history["evaluations"].mean()),
            time.perf_counter() - began,
            int(slid.size),
            means(history["cof"]),
            means(history["bare_fraction"]) if study.film is not None else {},
            mixed,
            float(fit.get("e_folding_mm", np.nan)) if isinstance(fit, dict) else np.nan,
        )


def known(found: dict[str, Course]) -> list[str]:
    """Say of each figure that is known how it compares, where its cases were run."""
    lines = []

    def say(what: str, names: Sequence[str], value: Callable[[], float], low: float, high: float) -> None:
        if all(name in found for name in names):
            got = value()
            lines.append(
                f"{'ok  ' if low <= got <= high else 'OFF '} {what}: {got:.4g} ({low:.4g} … {high:.4g})"
            )

    seeds = [f"Ra 0.3, seed {seed}" for seed in SEEDS]

    def mean(end: float) -> float:
        return float(np.mean([found[name].at(end) for name in seeds]))

    say("Ra 0.3, five seeds: A(240 mm), mm²", seeds, lambda: mean(240.0), 0.0152 * 0.97, 0.0152 * 1.03)
    say("Ra 0.3, five seeds: A(360 mm)/A(30 mm)", seeds, lambda: mean(360.0) / mean(30.0), 1.04, 1.12)
    for name in (f"Ra 3, seed {seed}" for seed in SEEDS):
        say(f"{name}: largest A over F/H", [name], lambda n=name: largest(found[n]), 0.9, 1.1)
    for ra in ("0.3", "3"):
        pair = [f"Ra {ra}, half step", f"Ra {ra}, seed 1"]
        for end in (90.0, 240.0):
            say(
                f"Ra {ra}: A({end:g} mm) of the half step over the step's",
                pair,
                lambda p=pair, e=end: found[p[0]].at(e) / found[p[1]].at(e),
                0.985,
                1.015,
            )
        name = f"Ra {ra}, seed 1"
        say(f"{name}: slope of the ball over t/d*", [name], lambda n=name: found[n].slope / 0.03, 0.8, 1.2)
        say(f"{name}: pending after 100 mm", [name], lambda n=name: found[n].pending, 0.0, 0.05)
    for name in ("smooth ball, dust alone", "smooth ball, dust 1"):
        exact = 0.4073
        say(
            f"{name}: A(600 mm), mm²", [name], lambda n=name: found[n].at(600.0), exact * 0.995, exact * 1.005
        )
        say(
            f"{name}: A at the end, mm²", [name], lambda n=name: found[n].last, 0.4125 * 0.995, 0.4125 * 1.005
        )
    lines += known_friction(found)
    worst = max((course.conservation for course in found.values()), default=0.0)
    lines.append(
        f"{'ok  ' if worst <= 1e-10 else 'OFF '} worn + pending − K F L, relative, at most: {worst:.1e}"
    )
    return lines


def known_friction(found: dict[str, Course]) -> list[str]:
    """Compare friction with a film and growing junctions with what is known of it."""
    lines = []

    def say(what: str, got: float, low: float, high: float) -> None:
        lines.append(f"{'ok  ' if low <= got <= high else 'OFF '} {what}: {got:.4g} ({low:.4g} … {high:.4g})")

    def ratio(name: str, other: str, end: float, allowed: float) -> None:
        if name in found and other in found:
            got = found[name].friction[end] / found[other].friction[end]
            say(f"{name}: μ({end:g} mm) over that of {other}", got, 1.0 - allowed, 1.0 + allowed)

    seeds = [found[name] for name in (f"μ, seed {seed}" for seed in SEEDS) if name in found]
    if seeds:
        mean = {end: float(np.mean([course.friction[end] for course in seeds])) for end in FRICTION}
        for end, wanted in FRICTION.items():
            allowed = 0.1 if end <= 150.0 else 0.06
            what = f"μ({end:g} mm), mean of {len(seeds)} seeds"
            say(what, mean[end], wanted * (1.0 - allowed), wanted * (1.0 + allowed))
        say("μ(900 mm)/μ(480 mm)", mean[900.0] / mean[480.0], 0.0, 1.06)
    for end in (90.0, 150.0, 240.0, 480.0):
        ratio("μ, half step", "μ, seed 1", end, 0.02)
    if seeds and "μ, track of 30 mm" in found:  # a surface of its own
        got = found["μ, track of 30 mm"].friction[90.0] / mean[90.0]
        say("μ, track of 30 mm: μ(90 mm) over the mean of the seeds", got, 0.97, 1.03)
    ratio("μ, 2.5 µm cells", "μ, seed 1", 90.0, 0.03)
    if "μ, film of 100 nm" in found and "μ, seed 1" in found:
        off = found["μ, film of 100 nm"].bare[240.0] - found["μ, seed 1"].bare[240.0]
        say("bare fraction at 240 mm, film of 100 nm less 10 nm", off, -0.04, 0.04)
    for (dust, film), wanted in DUST_FRICTION.items():
        name = f"μ, dust {dust:g}, film {film:g}"
        for end, value in zip((30.0, 90.0, 150.0), wanted, strict=True):
            if name in found:
                say(f"{name}: μ({end:g} mm)", found[name].friction[end], 0.9 * value, 1.1 * value)
    for name, wanted in LENGTHS.items():
        if name in found:
            say(f"{name}: length of the film's wear, mm", found[name].length, 0.8 * wanted, 1.2 * wanted)
    if seeds:
        say("formula of mixtures, largest error, relative", max(c.mixture for c in seeds), 0.0, 0.05)
    return lines


def largest(course: Course) -> float:
    """The area that is furthest from F/H, over it."""
    ratios = [area / course.fully for area in course.areas.values()]
    return max(ratios, key=lambda ratio: abs(ratio - 1.0))


def write_csv(path: Path, found: dict[str, Course]) -> None:
    """Write a row a case: means of areas [mm²], of friction and of bare fractions, and what else is told."""
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        columns = [f"{what} at {end:g} mm" for what in ("area [mm^2]", "friction", "bare") for end in ENDS]
        writer.writerow(["case", *columns, "slope", "pending", "length [mm]"])
        for name, course in found.items():
            tables = course.areas, course.friction, course.bare
            values = [table.get(end, np.nan) for table in tables for end in ENDS]
            writer.writerow([name, *values, course.slope, course.pending, course.length])


def read_csv(path: Path) -> dict[str, dict[str, dict[float, float]]]:
    """Case -> "area" [mm²] or "friction" -> end of a pass [mm] -> mean, as `write_csv` wrote them."""
    found: dict[str, dict[str, dict[float, float]]] = {}
    with path.open(newline="") as file:
        for row in csv.DictReader(file):
            found[row["case"]] = {
                what: {
                    end: value
                    for end in ENDS
                    if np.isfinite(value := float(row[f"{what}{unit} at {end:g} mm"]))
                }
                for what, unit in (("area", " [mm^2]"), ("friction", ""))
            }
    return found


def draw(tables: dict[str, dict[str, dict[float, float]]]) -> Figure:
    """All courses in one picture: friction above, areas over F/H below, each beside its reference's seeds."""
    figure = Figure(figsize=(13.0, 7.6), layout="constrained")
    axes = figure.subplots(2, 4, sharex=True)
    for row, what in zip(axes, ("friction", "area"), strict=True):
        panels, seeds = PANELS[what]
        for panel, (title, names) in zip(row, panels.items(), strict=True):
            for number, (name, label) in enumerate(names.items()):
                if name in tables and tables[name][what]:
                    slid, values = course_in(tables[name], what, name)
                    line = {"color": COLOURS[number % len(COLOURS)], "ls": LINES[number // len(COLOURS)]}
                    panel.plot(slid, values, marker=".", ms=4, lw=1.2, label=label, **line)
            known = [course_in(tables[name], what, name) for name in seeds if name in tables]
            if known:  # the distances that all have
                ends = sorted(set.intersection(*(set(slid) for slid, _ in known)))
                each = np.array([np.interp(ends, *course) for course in known])
                label = f"{REFERENCE[what]}, {len(known)} seed{'s' * (len(known) > 1)}"
                panel.fill_between(ends, each.min(axis=0), each.max(axis=0), color="#BBBBBB", lw=0.0)
                panel.plot(ends, each.mean(axis=0), color="#000000", lw=1.6, label=label)
            panel.set_title(title, fontsize=10)
            panel.set_xscale("log")
            panel.set_xticks([30, 90, 240, 600, 2400], ["30", "90", "240", "600", "2400"])
            panel.minorticks_off()
            panel.set_xlim(25.0, 2900.0)
            panel.spines[["top", "right"]].set_visible(False)
            if panel.get_legend_handles_labels()[0]:
                panel.legend(fontsize=7, frameon=False, loc="upper left")
        for panel in row:
            panel.set_ylim(0.0, 1.05 if what == "friction" else None)
    axes[0, 0].set_ylabel("coefficient of friction, mean of 30 mm, –")
    axes[1, 0].set_ylabel("area in contact over F/H, –")
    for panel in axes[1]:
        panel.set_xlabel("sliding distance, mm")
        panel.set_ylim(0.9, 1.8)
        panel.axhline(1.0, color="#999999", lw=0.6)
    axes[1, 0].set_yscale("log")
    axes[1, 0].set_ylim(0.8, 80.0)  # dust, and the legend over it
    axes[1, 0].set_yticks([1, 2, 5, 10, 20], ["1", "2", "5", "10", "20"])
    axes[1, 0].minorticks_off()
    return figure


def course_in(table: dict[str, dict[float, float]], what: str, name: str) -> tuple[Any, Any]:
    """Distances [mm] and friction, or areas over F/H, of a case."""
    slid, values = (np.array(part) for part in zip(*sorted(table[what].items()), strict=True))
    load = next((load for load in (4.0, 16.0) if f"load {load:g} N" in name), 8.0)
    hardness = 1200.0 if "H 1200" in name else 590.0
    return slid, values if what == "friction" else values * hardness / load


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--jobs", type=int, default=1, help="runs at a time")
    parser.add_argument("--only", nargs="+", default=[""], help="run the cases whose name has one of these")
    parser.add_argument("--csv", type=Path, help="write the courses there")
    parser.add_argument("--draw", type=Path, help="draw the courses there")
    parser.add_argument("--read", type=Path, help="run nothing: take the courses of this table of --csv")
    asked = parser.parse_args(arguments)
    if asked.read is not None:
        draw(read_csv(asked.read)).savefig(asked.draw, dpi=150)
        return 0
    every = cases() | friction_cases()
    chosen = {name: keys for name, keys in every.items() if any(part in name for part in asked.only)}
    longest_first = sorted(chosen, key=lambda name: -float(chosen[name]["sliding.distance"].split()[0]))
    found: dict[str, Course] = {}
    print(
        f"{'case':34s}", *(f"{end:7g}" for end in ENDS), " mm; slope, pending, transforms, ms a step", sep=""
    )
    with ProcessPoolExecutor(asked.jobs, mp_context=get_context("spawn")) as pool:
        waiting = {name: pool.submit(course_of, chosen[name]) for name in longest_first}
        for name in chosen:
            try:
                course = found[name] = waiting[name].result()
            except warpwear.InputError as error:  # such as a scar that outgrows its domain
                print(f"{name:34s} {error}", flush=True)
                continue
            shown = {end: f"{value * 1e4:7.1f}" for end, value in course.areas.items()}
            if course.bare:
                shown = {end: f"{value:7.3f}" for end, value in course.friction.items()}
            values = (shown.get(end, "      ·") for end in ENDS)
            ms = 1e3 * course.seconds / course.steps
            rest = f"  {course.slope:.4f} {course.pending:6.3f} {course.transforms:5.1f} {ms:6.1f}"
            print(f"{name:34s}", *values, rest, sep="", flush=True)
    print("areas in 1e-4 mm² or coefficients of friction, means of the 30 mm before", *known(found), sep="\n")
    if asked.csv is not None:
        write_csv(asked.csv, found)
    if asked.draw is not None:
        tables = {name: {"area": course.areas, "friction": course.friction} for name, course in found.items()}
        draw(tables).savefig(asked.draw, dpi=150)
    return 0


if __name__ == "__main__":
    sys.exit(main())
