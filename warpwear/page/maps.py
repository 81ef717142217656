"""Maps of a run's page under a slider over its snapshots: pressure and state of contact, film, load "
"shares."""

import math

import numpy as np

from warpwear.figures.data import FigureData
from warpwear.figures.table import Plotter
from warpwear.page.parts import WIDE, Coded, Map, Section, after, chosen, is_wide

#: Most snapshots under a slider, and points along a side of a map.
SNAPSHOTS, SIDE = 12, 500
#: Snapshots whose maps may have the full number of points: more of them get coarser.
FULL_MAPS = 6
#: Largest span of a logarithmic scale of pressures, and the percentage of places that may lie below it.
SPAN, BELOW = 1e3, 2.0
STATES = (
    ("never touched", "clear"),
    ("touched before", "TOUCHED"),
    ("in contact", "CONTACT"),
    ("at hardness", "HARDNESS"),
)
FILMS = (
    ("elsewhere", "clear"),
    ("bare beside", "SUM"),
    ("on film", "TOUCHED"),
    ("on metal", "DISC"),
)


def maps(plot: Plotter, data: FigureData) -> Section:
    """Pressure and state of contact over the snapshots, in the window of the scar."""
    if plot.reason("pressure_map"):
        return Section("Contact and pressure", [])
    indices = chosen(data.result.snapshot_distances.size, SNAPSHOTS)
    side = int(SIDE * min(1.0, math.sqrt(FULL_MAPS / len(indices))))
    kept = dict(zip(data.shown, data.views, strict=True)) if side == SIDE else {}
    views = [kept.get(index) or data.view(index, most=side) for index in indices]
    history, labels = data.history, [after(view.distance) for view in views]
    means, scatter, area = (history[name] for name in ("pressure_mean", "pressure_std", "area_contact"))
    most = max(float(view.pressure.max()) for view in views) or 1.0
    log = most > WIDE * min(float(means[view.row]) for view in views)
    low = 0.0
    if log:
        seen = [v.pressure[v.pressure > 0.0] for v in views if v.pressure.any()]
        low = max(0.8 * min(float(np.percentile(values, BELOW)) for values in seen), most / SPAN)
    pressures = [Coded.of(np.where(v.pressure > 0.0, v.pressure, np.nan), low, most, log=log) for v in views]
    window = data.window_of(side)
    caption = "A point is a cell."
    if window.factor > 1:
        caption = (
            f"A point is {window.factor} × {window.factor} cells and shows the largest of them, so that "
            "areas look larger than the numbers say."
        )
    shown = [
        Map(
            "pressure_map",
            "Pressure in contact",
            labels,
            window.extent,
            pressures,
            [f"mean {means[v.row]:.4g}, standard deviation {scatter[v.row]:.3g} MPa" for v in views],
            unit="MPa",
            static="pressure_map",
        ),
        Map(
            "contact_map",
            "State of contact",
            labels,
            window.extent,
            [Coded(view.state, 0.0, 1.0) for view in views],
            [f"{area[v.row]:.4g} mm² in contact" for v in views],
            states=STATES,
            static="contact_map",
        ),
    ]
    if "bare_fraction" in history:
        shown.append(
            Map(
                "bare_map",
                "Where the film is gone",
                labels,
                window.extent,
                [Coded(view.film, 0.0, 1.0) for view in views if view.film is not None],
                [f"{100.0 * history['bare_fraction'][v.row]:.3g} % of the contact is bare" for v in views],
                states=FILMS,
                static="bare_map",
            )
        )
    return Section("Contact and pressure", shown, "maps", caption, labels)


def loads(plot: Plotter, data: FigureData) -> Section:
    """Loads of the patches over their area, beside those of a smooth contact."""
    if plot.reason("load_share"):
        return Section("Load shares", [])
    loads, labels = data.loads, [after(distance) for distance in data.distances]
    most, log = max(float(of.max()) for of in loads.of.values()), is_wide(*loads.of.values())
    least = min(float(of[of > 0.0].min(initial=most)) for of in loads.of.values())
    low = max(least, most / SPAN) if log else 0.0
    apart = ["as prescribed"] * len(labels)
    if loads.apart and not loads.prescribed:
        apart = [f"{100.0 * part:.2g} % of the load on other patches" for part in loads.apart]
    maps = [
        Map(
            f"load_{number}",
            f"Load over area: {name}",
            labels,
            loads.window.extent,
            [Coded.of(np.where(of > 0.0, of, np.nan), low, most, log=log) for of in fields],
            apart if number else [""] * len(labels),
            unit="MPa",
            static="" if number else "load_share",
        )
        for number, (name, fields) in enumerate(loads.of.items())
    ]
    return Section("Load shares of the patches", maps, "loads", "", labels)
