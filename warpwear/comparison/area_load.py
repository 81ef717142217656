"""Area in contact against load of runs that differ in it, beside what theories say of it."""

import math
from collections import defaultdict
from dataclasses import replace

import numpy as np

from warpwear.comparison.groups import RunData
from warpwear.comparison.table import Comparison
from warpwear.ensembles.ensemble import Group
from warpwear.figures import describe
from warpwear.figures.describe import Axis, Chart, Figure, Line, Look
from warpwear.grid import FloatArray
from warpwear.laws.elastic import SpectralMoments, greenwood_williamson_area, persson_area
from warpwear.results.ensemble import band
from warpwear.study.study import Study
from warpwear.study.surface import surface_in

#: How far the axes reach beyond the smallest and the largest load, as a factor.
MARGIN = 1.5
#: Points of a line of theory.
LINES = 60
#: Points in a surface's shortest wave; with more than two the mean squares of its slopes are exact.
POINTS_PER_CUT_OFF = 2.5
#: Colour of each series.
COLOURS = (describe.CONTACT, describe.DISC, describe.COUNTER, describe.MEAN_PRESSURE)


def has_loads(comparison: Comparison) -> bool:
    """Tell whether runs differ in load."""
    return len({run.study.blocks[0].load for run in comparison.rows}) > 1


def area_load(comparison: Comparison) -> Figure:
    """Draw the area in contact after the first step over the load, a series for each law and hardness.

    Lines of theories are there where all runs have the same bodies: load over hardness; Hertz, of smooth
    bodies; Persson, and under a flat Greenwood and Williamson, of a surface whose spectrum is known.
    """
    forces, lines = [run.study.blocks[0].load for run in comparison.rows], []
    loads = np.geomspace(min(forces) / MARGIN, max(forces) * MARGIN, LINES)
    for number, (name, (force, area, low, high)) in enumerate(series_of(comparison).items()):
        look = Look(COLOURS[number % len(COLOURS)], marker=describe.MARKERS[number % len(COLOURS)], size=4.0)
        lines.append(Line(force, area, name, look))
        ends = ((load, pair) for load, *pair in zip(force, low, high, strict=True) if pair[0] < pair[1])
        bar = Look(look.colour, width=0.9)
        lines += [Line(np.full(2, load), np.array(pair), look=bar) for load, pair in ends]
    values = np.concatenate([line.y for line in lines])
    low, high = np.nanmin(values) / MARGIN, np.nanmax(values) * MARGIN
    theories = theories_of(comparison, loads)
    for (name, theory), dash in zip(theories.items(), describe.DASHES[1:], strict=False):
        if np.any((1e3 * theory > low) & (1e3 * theory < high)):
            lines.append(Line(loads, 1e3 * theory, name, Look(dash=dash, width=0.9)))
    along = Axis("normal load, N", "log", low=loads[0], high=loads[-1])
    up = Axis("area in contact at first, 10⁻³ mm²", "log", low=low, high=high)
    chart = Chart("Area in contact after the first step", along, up, lines)
    return Figure([chart], legend=1, height=3.4)


def series_of(comparison: Comparison) -> dict[str, FloatArray]:
    """Collect the groups by law and hardness: load [N], area at first and ends of its band [10⁻³ mm²].

    Each has shape (4, groups), its loads rising.
    """
    series: dict[str, list[Group[RunData]]] = defaultdict(list)
    for group in comparison.groups:
        series[_law(group)].append(group)
    return {name: np.transpose(sorted(_point(group) for group in groups)) for name, groups in series.items()}


def _point(group: Group[RunData]) -> tuple[float, float, float, float]:
    """Return a group's mean load [N] and area in contact at first [10⁻³ mm²]: mean, ends of its band."""
    areas = np.array([[1.0e3 * run.courses["area_contact"][1][0]] for run in group.rows])
    mean, low, high = (float(values[0]) for values in band(areas))
    return float(np.mean([run.study.blocks[0].load for run in group.rows])), mean, low, high


def _law(group: Group[RunData]) -> str:
    """Name the law and the hardness of the runs of a group, all of them where they differ."""
    laws = dict.fromkeys(run.study.contact.law for run in group.rows)
    capped = sorted({run.study.hardness for run in group.rows if np.isfinite(run.study.hardness)})
    cap = f"H = {', '.join(f'{hardness:g}' for hardness in capped)} MPa" if capped else "no hardness"
    return f"computed: {', '.join(laws)}, {cap}"


def theories_of(comparison: Comparison, load: FloatArray) -> dict[str, FloatArray]:
    """Find areas by theories: label -> area [mm²] at the loads [N]; none where the bodies differ."""
    studies = [run.study for run in comparison.rows]
    first = studies[0]
    areas: dict[str, FloatArray] = {}
    if any((s.counter, s.disc, s.grid) != (first.counter, first.disc, first.grid) for s in studies):
        return areas
    hardness = {s.hardness for s in studies if np.isfinite(s.hardness)}
    if len(hardness) == 1:
        areas["load over hardness"] = load / hardness.pop()
    modulus, moments = first.pair.effective_modulus, _moments(first)
    if modulus is None:
        return areas
    if first.hertz is not None:
        if moments is not None:
            # As long as erf(x) is 2x/√π it does not matter how the load is spread.
            areas["Persson, light loads"] = np.sqrt(8.0 / np.pi) * load / (modulus * moments.rms_slope)
        of_hertz = [replace(first.hertz, load=float(force)).area for force in load]
        areas["Hertz, smooth bodies"] = np.array(of_hertz)
    elif moments is not None and first.counter.form.is_flat:
        nominal, pressure = first.cells.area, load / first.cells.area
        areas["Persson"] = nominal * persson_area(pressure, modulus=modulus, rms_slope=moments.rms_slope)
        summits = nominal * greenwood_williamson_area(pressure, modulus=modulus, moments=moments)
        areas["Greenwood and Williamson"] = np.where(summits <= nominal, summits, np.nan)
    return areas


def _moments(study: Study) -> SpectralMoments | None:
    """Find the moments of a period of the disc, all its waves resolved; None of a disc without a period."""
    disc = study.disc.synthetic
    if disc is None or disc.kind not in ("self-affine", "profile"):
        return None
    points = math.ceil(POINTS_PER_CUT_OFF * disc.period / disc.cut_off)
    places = disc.period / points * np.arange(points, dtype=np.float64)
    return SpectralMoments.of(surface_in(study).heights(places, places), disc.period / points)
