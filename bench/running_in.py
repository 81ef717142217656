"""Courses of contact area and friction of bodies that wear in pieces, all variants in one picture.

    python bench/running_in.py --jobs 16 --out courses.json
    python bench/running_in.py --jobs 16 --only seed --only half
    python bench/running_in.py --read courses.json --draw bench/pictures/running_in.png

Every case is a run of the reference of wear in pieces (a ball on a self-affine disc of 1.2 mm, half-space,
5 µm cells) with a few keys changed, in a process of its own with one thread. The table has means over the
30 mm before some distances: of the coefficient of friction where there is a film, else of the area in
contact over F/H. With --read the courses are those of a file of --out, and nothing is run.
"""

import json
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import click
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import warpwear
from warpwear import Study

#: Distance over which means are taken [mm], and the distances at which that ends.
PASS = 30.0
ENDS = (30.0, 90.0, 150.0, 240.0, 360.0, 480.0, 600.0, 900.0, 1200.0, 2400.0)
#: Left out of every case, and of those without friction.
QUIET: dict[str, Any] = {"output.snapshots": [], "run.checkpoint": "inf s"}
BARE: dict[str, Any] = {"friction.film": None, "friction.junction_growth": 0.0}
DUST_ALONE = {"wear.particle": None, "wear.particle_thickness": None}
FINE = {"grid.cell": "2.5 um", "sliding.shift": 8}
HALF_STEP = {"sliding.shift": 2}
KEPT = {"sliding.plastic": "keep"}
UNIFORM = {"wear.pending_start": "uniform"}
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
LINES = ("-", "--", ":")
Keys = dict[str, Any]
Course = dict[float, float]  # end of a pass [mm] -> mean


def dust(part: float) -> Keys:
    return {"wear.dust_fraction": part}


def film(thickness: float) -> Keys:
    return {"friction.film.thickness": f"{thickness} nm"}


def load(force: float) -> Keys:
    return {"contact.load": f"{force} N"}


def ra(height: float) -> Keys:
    return {"disc.synthetic.ra": f"{height} um"}


def piece(diameter: float, thickness: float) -> Keys:
    return {"wear.particle": f"{diameter} um", "wear.particle_thickness": f"{thickness} um"}


#: Title of a panel -> label -> distance [mm] and changed keys, beside those of its picture in `PICTURES`.
FRICTION: dict[str, dict[str, tuple[float, Keys]]] = {
    "ingredients": {
        "dust, no pieces": (480.0, DUST_ALONE),
        "junctions do not grow": (480.0, {"friction.junction_growth": 0.0}),
        "film of 100 nm": (240.0, film(100.0)),
        "dents kept": (900.0, KEPT),
        "to 2400 mm": (2400.0, {}),
        "to 2400 mm, dents kept": (2400.0, KEPT),
    },
    "dust and start": {
        "1 % dust": (240.0, dust(0.01) | film(10.0)),
        "5 % dust": (240.0, dust(0.05) | film(10.0)),
        "20 % dust, film of 300 nm": (240.0, dust(0.2) | film(300.0)),
        "uniform start": (480.0, UNIFORM),
    },
    "size of a piece": {
        f"d* {diameter:g}, t {thickness:g} µm": (900.0, piece(diameter, thickness))
        for diameter, thickness in ((20.0, 0.3), (40.0, 1.2), (130.0, 0.6))
    },
    "load, Ra, mesh": {
        "4 N": (480.0, load(4.0)),
        "16 N": (480.0, load(16.0)),
        "Ra 1 µm": (480.0, ra(1.0)),
        "half the step": (480.0, HALF_STEP),
        "cells of 2.5 µm": (90.0, FINE),
        "track of 30 mm": (90.0, {"sliding.track": "full", "disc.synthetic.period": "10 mm"}),
    },
}
AREA: dict[str, dict[str, tuple[float, Keys]]] = {
    "Ra 0.3 µm, no film": {
        "dust, no pieces": (480.0, DUST_ALONE),
        "20 % dust": (240.0, dust(0.2)),
        "5 % dust": (240.0, dust(0.05)),
        "dents kept": (240.0, KEPT),
        "uniform start": (240.0, UNIFORM),
        "Ra 3 µm, dust, no pieces": (480.0, ra(3.0) | DUST_ALONE),
        "Ra 3 µm, to 2400 mm": (2400.0, ra(3.0)),
    },
    "dust, Ra 3 µm": {
        "no dust": (480.0, ra(3.0)),
        **{f"{100 * part:g} % dust": (240.0, ra(3.0) | dust(part)) for part in (0.01, 0.05, 0.2)},
    },
    "size of a piece": {
        f"d* {diameter:g}, t {thickness:g} µm": (240.0, piece(diameter, thickness))
        for diameter, thickness in ((20.0, 0.1), (20.0, 0.3), (40.0, 0.6), (40.0, 1.2))
    },
    "load, H, Ra, mesh": {
        "4 N": (240.0, load(4.0)),
        "16 N": (240.0, load(16.0)),
        "H 1200 MPa": (240.0, {"contact.hardness": "1200 MPa"}),
        "Ra 1 µm": (480.0, ra(1.0)),
        "half the step": (240.0, HALF_STEP),
        "cells of 2.5 µm": (90.0, FINE),
    },
}
#: What is drawn: its panels, keys of all of its cases, distance [mm] and label of the seeds of its reference.
PICTURES = {
    "friction": (FRICTION, ra(3.0), 900.0, "reference"),
    "area": (AREA, BARE | ra(0.3), 360.0, "pieces alone, Ra 0.3 µm"),
}
SEEDS = range(1, 6)


def cases() -> dict[str, tuple[str, Keys]]:
    """Name every case; return what its course is of, "friction" or "area", and the keys that it changes."""
    by_name: dict[str, tuple[str, Keys]] = {}
    for what, (panels, base, length, _) in PICTURES.items():
        rows = {f"seed {seed}": (length, {"disc.synthetic.seed": seed}) for seed in SEEDS}
        rows |= {f"{title}: {label}": row for title, panel in panels.items() for label, row in panel.items()}
        for label, (distance, changes) in rows.items():
            slid = {"sliding.distance": f"{distance} mm"}
            by_name[f"{what}, {label}"] = what, QUIET | base | slid | changes
    return by_name


def course_of(what: str, changes: Keys) -> Course:
    """Run a case; return the mean coefficient of friction, or area over F/H, by the end of a pass."""
    study = Study.load("running-in").replace(changes)
    with warpwear.run(study, threads=1, progress=False) as result:
        columns = ("distance", "increment", "cof" if what == "friction" else "area_contact")
        slid, weights, values = (np.array(result.history[name]) for name in columns)
    unit = 1.0 if what == "friction" else study.contact.load / study.hardness
    course = {}
    for end in (end for end in ENDS if slid[-1] > end - 1e-6):
        within = (slid > end - PASS + 1e-6) & (slid < end + 1e-6)
        course[end] = float(np.average(values[within], weights=weights[within])) / unit
    return course


def draw(courses: Mapping[str, Course]) -> Figure:
    """Draw all courses: friction above, areas over F/H below, each beside the seeds of its reference."""
    figure = Figure(figsize=(13.0, 7.6), layout="constrained")
    axes = figure.subplots(2, 4, sharex=True)
    for row, what in zip(axes, PICTURES, strict=True):
        panels, _, _, reference = PICTURES[what]
        seeds = [courses[name] for seed in SEEDS if (name := f"{what}, seed {seed}") in courses]
        for panel, (title, labels) in zip(row, panels.items(), strict=True):
            for number, label in enumerate(labels):
                course = courses.get(f"{what}, {title}: {label}", {})
                style = {"color": COLOURS[number % len(COLOURS)], "ls": LINES[number // len(COLOURS)]}
                if course:
                    panel.plot([*course], [*course.values()], marker=".", ms=4, lw=1.2, label=label, **style)
            if seeds:
                _draw_band(panel, seeds, reference)
            _finish(panel, title)
    for panel in axes[0]:
        panel.set_ylim(0.0, 1.05)
    for panel in axes[1]:
        panel.set_xlabel("sliding distance, mm")
        panel.set_ylim(0.9, 1.8)
        panel.axhline(1.0, color="#999999", lw=0.6)
    axes[0, 0].set_ylabel("coefficient of friction, mean of 30 mm, –")
    axes[1, 0].set_ylabel("area in contact over F/H, –")
    axes[1, 0].set_yscale("log")
    axes[1, 0].set_ylim(0.8, 80.0)  # dust, and the legend over it
    axes[1, 0].set_yticks([1, 2, 5, 10, 20], ["1", "2", "5", "10", "20"])
    axes[1, 0].minorticks_off()
    return figure


def _draw_band(panel: Axes, seeds: list[Course], reference: str) -> None:
    """Draw mean and span of the reference at the distances that all of its seeds have."""
    ends = sorted(set.intersection(*(set(course) for course in seeds)))
    values = np.array([[course[end] for end in ends] for course in seeds])
    label = f"{reference}, {len(seeds)} seed{'s' * (len(seeds) > 1)}"
    panel.fill_between(ends, values.min(axis=0), values.max(axis=0), color="#BBBBBB", lw=0.0)
    panel.plot(ends, values.mean(axis=0), color="#000000", lw=1.6, label=label)


def _finish(panel: Axes, title: str) -> None:
    """Give a panel its title, its distances and its legend."""
    panel.set_title(title, fontsize=10)
    panel.set_xscale("log")
    panel.set_xticks([30, 90, 240, 600, 2400], ["30", "90", "240", "600", "2400"])
    panel.minorticks_off()
    panel.set_xlim(25.0, 2900.0)
    panel.spines[["top", "right"]].set_visible(False)
    if panel.get_legend_handles_labels()[0]:
        panel.legend(fontsize=7, frameon=False, loc="upper left")


def compute(names: list[str], jobs: int) -> dict[str, Course]:
    """Run the cases whose name has one of these words, the longest first, and print a line of each."""
    chosen = {
        name: case for name, case in cases().items() if not names or any(word in name for word in names)
    }
    longest_first = sorted(chosen, key=lambda name: -float(chosen[name][1]["sliding.distance"].split()[0]))
    courses = {}
    click.echo(f"{'case':52s}" + "".join(f"{end:7g}" for end in ENDS) + " mm")
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        running = {name: pool.submit(course_of, *chosen[name]) for name in longest_first}
        for name in chosen:
            try:
                courses[name] = running[name].result()
            except warpwear.InputError as error:  # such as a scar that outgrows its domain
                click.echo(f"{name:52s} {error}")
                continue
            click.echo(f"{name:52s}" + "".join(f"{value:7.3f}" for value in courses[name].values()))
    return courses


@click.command()
@click.option("--jobs", type=click.IntRange(1), default=1, show_default=True, help="Runs at a time.")
@click.option("--only", multiple=True, help="Run the cases whose name has this; may be given again.")
@click.option("--out", type=click.Path(path_type=Path), help="Write the courses there, as JSON.")
@click.option("--draw", "picture", type=click.Path(path_type=Path), help="Draw the courses there.")
@click.option("--read", type=click.Path(path_type=Path), help="Run nothing: take the courses of this --out.")
def main(jobs: int, only: tuple[str, ...], out: Path | None, picture: Path | None, read: Path | None) -> None:
    """Run, tabulate and draw the courses of bodies that wear in pieces."""
    if read is None:
        courses = compute([*only], jobs)
    else:
        stored = json.loads(read.read_text(encoding="utf-8"))
        courses = {name: {float(end): mean for end, mean in of.items()} for name, of in stored.items()}
    if out is not None:
        out.write_text(json.dumps(courses, indent=1, ensure_ascii=False), encoding="utf-8")
    if picture is not None:
        draw(courses).savefig(picture, dpi=150)


if __name__ == "__main__":
    main()
