"""Press measured surfaces on each other over a range of loads: what their joint conducts, how stiff it is."""

import math
import tomllib
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib.resources import files
from pathlib import Path
from typing import Any, Unpack

import numpy as np

from warpwear.contact.array.contact import ArrayContact
from warpwear.contact.array.solve import solve_contact
from warpwear.errors import InputError, named_in_python
from warpwear.figures import describe
from warpwear.figures.describe import Axis, Chart, Figure, Line, Look, Map, Scale
from warpwear.grid import FloatArray, Grid
from warpwear.laws.elastic import asperities, effective_modulus, joint_laws
from warpwear.measured.options import quantity
from warpwear.measured.report import FileReport, FolderReport, paged
from warpwear.measured.surface import HowToRead, read_surface
from warpwear.measured.surface_report import MeasuredSurface
from warpwear.results.report import Row, aligned, lines
from warpwear.study.materials import Material
from warpwear.study.materials import material as known_material
from warpwear.surfaces.roughness import rms_slope

#: Loads of a range, and columns that are printed.
LOADS, PRINTED = 13, 6
#: What is told of cells twice as wide; bins of a histogram.
CHANGED = ("conductance", "stiffness_unloading", "area", "flow_along")
BINS = 40
#: Cells each way from which on there is a joint to speak of: four waves of four cells.
FEWEST = 16
#: Rms slope from which it is told: the surface is 4 % larger than its nominal area.
STEEP = 0.3
#: Lines that are drawn beside, other than that of wider cells.
LAWS = {"plastic": Look(describe.NOMINAL, "dash", 0.8), "elastic": Look(describe.NOMINAL, "dashdot", 0.8)}
#: Units of columns, figures, and what the page says.
DECLARED = tomllib.loads((files("warpwear.measured") / "joint.toml").read_text(encoding="utf-8"))
FLOWS = [name for name in DECLARED["columns"] if "flow" in name]
HEADS = [f"{name} [{unit}]" for name, unit in DECLARED["columns"].items()]

Table = Mapping[str, FloatArray]


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class JointCurve(FileReport, FolderReport):
    """A joint has a table over its loads of what it conducts and how stiff it is; `print` shows some of it.

    Attributes
    ----------
    table : dict
        Column -> values, one a load, NaN where not known.
    figures : dict
        Name -> what it shows.
    """

    MARK = "joint.json"
    WHAT = "a joint"
    table: Table
    figures: Mapping[str, Figure]

    def write_table(self, path: str | Path) -> None:
        """Write the table as CSV, a row a load, units in the header.

        Parameters
        ----------
        path : path
            Of the file, which is replaced where it is there.
        """
        rows = np.column_stack([*self.table.values()])
        np.savetxt(path, rows, "%.9g", delimiter=",", header=",".join(HEADS), comments="")

    def _parts(self, folder: Path) -> dict[str, Any]:
        name, said = self.text.partition("\n")[0], {"lines": lines(self.rows), "how": DECLARED["page"]["how"]}
        return paged(self, self.figures, DECLARED["page"]["sections"], self.write_table, name=name, **said)


@named_in_python()
def joint_curve(
    path: str | Path,
    *,
    load: str | float,
    material: str,
    against: str | Path | None = None,
    against_material: str | None = None,
    hardness: str | float | None = None,
    device: str = "cpu",
    **how: Unpack[HowToRead],
) -> JointCurve:
    """Press a measured surface on a plane or another one, and return what their joint does over the load.

    Parameters
    ----------
    path
        File of a measured surface.
    load
        Mean pressures: "0.1:100 MPa" is 13 of them, evenly in their logarithm; or "1, 5, 20 MPa"; or one
        [MPa], or text.
    material
        Name of a known material, see `materials`.
    against
        File of the other surface, turned over about x; without, it is a smooth plane.
    against_material
        Of the other body; by default the same.
    hardness
        Largest pressure of a cell [MPa], or text; by default that of the softer material.
    device
        "cpu" or "cuda:0".
    **how
        How the files are read, as for `read_surface`.

    Returns
    -------
    JointCurve
        A table over the loads, figures, and what wider cells change.

    Raises
    ------
    InputError
        For a file, load or material that is not possible.

    References
    ----------
    J. R. Barber, Proc. R. Soc. A 459 (2003) 53.

    Examples
    --------
    >>> np.save("lapped.npy", np.random.default_rng(0).normal(0.0, 0.1, (64, 64)))
    >>> lapped = {"pixel": "2 um", "height_unit": "um", "s_filter": 0.016}
    >>> joint = warpwear.joint_curve("lapped.npy", load="1, 10 MPa", material="AISI 304", **lapped)
    >>> joint.table["pressure"]
    array([ 1., 10.])
    """
    pressures, pair = loads_of(load), [_known(material)]
    pair.append(_known(against_material, "--against-material") if against_material else pair[0])
    softer = min(body.hardness for body in pair)
    limit = softer if hardness is None else quantity("--hardness", hardness, "MPa")
    if pressures[-1] > limit:
        raise InputError(f"--load = {pressures[-1]:g} MPa: up to the hardness, {limit:g} MPa, is allowed")
    modulus = effective_modulus(*((body.young, body.poisson) for body in pair))
    surfaces = [read_surface(file, **how) for file in (path, against) if file is not None]
    doubts = [doubt for body in surfaces for doubt in body.numbers["doubts"]]
    heights, cell = rough(*surfaces)
    wide = heights.reshape(heights.shape[0] // 2, 2, -1, 2).mean(axis=(1, 3))
    given: dict[str, Any] = {"modulus": modulus, "hardness": limit, "device": device}
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        coarse, _ = press(wide, pressures, pair, cell=2.0 * cell, **given)
        told.clear()
        table, last = press(heights, pressures, pair, cell=cell, **given)
    slope = rms_slope(heights, pixel=(cell, cell))
    laws = joint_laws(pressures, sq=float(heights.std()), slope=slope, hardness=limit, modulus=modulus)
    coarse = {**coarse, **laws}
    steep = ": half-spaces are for small slopes" if slope > STEEP else ""
    ratio, mode = asperities(limit, modulus, slope)
    cells = [[f"{at:.3g}" for at in row] for row in zip(*table.values(), strict=True)]
    changes = []
    with np.errstate(invalid="ignore", divide="ignore"):  # infinite where all is in contact, 0 where no flow
        for name in CHANGED:
            change = 100.0 * (coarse[name] / table[name] - 1.0)
            known = change[np.isfinite(change)]
            changes.append(Row(name, name, float(known.mean()) if known.size else None, 2))
    missing = [
        f"{name} of {body.name}"
        for body in {body.name: body for body in pair}.values()
        for name in ("conductivity", "resistivity")
        if getattr(body, name) is None
    ]
    rows = [
        Row("E*", "modulus_MPa", modulus),
        Row("hardness", "hardness_MPa", limit),
        Row("rms slope", "rms_slope", slope, note=f"of cells of {1e3 * cell:.3g} µm{steep}"),
        Row("done", "operations", [one for body in surfaces for one in body.numbers["operations"]] or None),
        Row("asperities", "asperities", mode, note=f": H/(E* × rms slope) = {ratio:.3g}"),
        Row("twice the cell", "changes_percent", changes),
        Row("not known", "not_known", missing or None),
        Row("", "table", {head: list(at) for head, at in zip(HEADS, table.values(), strict=True)}),
        Row("warning", "warnings", [*doubts, *dict.fromkeys(str(one.message) for one in told)] or None),
    ]
    other = Path(against).name if against else "a smooth plane"
    shown = [row[:PRINTED] for row in [HEADS, *cells]] if len(cells) > 1 else zip(HEADS, *cells, strict=True)
    of_loads = [f"  {line}" for line in aligned([*shown])]
    text = "\n".join([f"joint of {Path(path).name} and {other}", *lines(rows), *of_loads])
    figures = figures_of(table, coarse, last)
    return JointCurve(
        text=text, rows=rows, draw=lambda: next(iter(figures.values())), table=table, figures=figures
    )


def _known(name: str, option: str = "--material") -> Material:
    try:
        return known_material(name)
    except ValueError as error:
        raise InputError(f"{option}: {error}") from None


def loads_of(said: str | float) -> FloatArray:
    """Return the mean pressures [MPa] that a text says, or a number. Raises InputError."""
    text = said if isinstance(said, str) else f"{said} MPa"
    numbers, _, unit = text.strip().rpartition(" ")
    is_range = ":" in numbers
    parts = [f"{one.strip()} {unit}".strip() for one in numbers.split(":" if is_range else ",")]
    values = [quantity("--load", part, "MPa") for part in parts]
    if sorted({*values}) != values or (is_range and len(values) != 2):
        raise InputError(f"--load = {text!r}: allowed are '0.1:100 MPa', or loads that rise, '1, 5, 20 MPa'")
    return np.geomspace(values[0], values[1], LOADS) if is_range else np.array(values)


def rough(surface: MeasuredSurface, *others: MeasuredSurface) -> tuple[FloatArray, float]:
    """Return the heights [mm] of surfaces together, on even numbers of cells, and the cell.

    Raises InputError.
    """
    bodies = [surface, *others]
    cell = max(pixel for body in bodies for pixel in body.pixel)
    least = np.min([body.surface.size for body in bodies], axis=0)
    nx, ny = (2 * int(0.5 * size / cell + 1e-9) for size in least)
    if min(nx, ny) < FEWEST:
        raise InputError(f"a joint of {nx} × {ny} cells is not possible: {FEWEST} each way are the least")
    grid = Grid(nx, ny, cell)
    heights = surface.surface.heights(grid.x, grid.y)
    return sum((one.surface.heights(grid.x, grid.y)[:, ::-1] for one in others), start=heights), cell


def press(
    heights: FloatArray, pressures: FloatArray, pair: list[Material], *, device: str, **given: Any
) -> tuple[Table, ArrayContact]:
    """Return the columns of all loads, NaN where it is not known what conducts, and the last contact."""
    rows, on = [], dict[str, Any](device=device)
    k, rho = ([getattr(body, name) or math.nan for body in pair] for name in ("conductivity", "resistivity"))
    for pressure in pressures:
        contact = solve_contact(heights, mean_pressure=pressure, **on, **given)
        area, length = contact.nominal_area, contact.conductance(**on)
        try:
            flow = contact.flow_factors()
            flows = [flow.along, flow.across, flow.shear, *(flow.nominal or [math.nan] * 2)]
        except InputError as error:  # of too many cells
            warnings.warn(f"flow is not known: {error}", stacklevel=2)
            flows = [math.nan] * len(FLOWS)
        row = {
            "pressure": pressure,
            "area": contact.area / area,
            "area_at_hardness": contact.area_at_hardness / area,
            "separation": 0.0 - 1e3 * contact.approach,
            "gap": 1e3 * float(np.maximum(contact.gap, 0.0).mean()),
            "stiffness_loading": contact.stiffness(**on) / area,
            "stiffness_unloading": contact.stiffness(unloading=True, **on) / area,
            "conductance": length / area,
            "heat_transfer": 2e3 * length / area / sum(1.0 / one for one in k),
            "resistance": 500.0 * area / length * sum(rho),
            **dict(zip(FLOWS, flows, strict=True)),
        }
        rows.append([row[name] for name in DECLARED["columns"]])
    return dict(zip(DECLARED["columns"], np.array(rows).T, strict=True)), contact


def figures_of(table: Table, beside: Table, last: ArrayContact) -> dict[str, Figure]:
    """Declare the figures of a joint. beside: columns of wider cells, and laws."""
    x, pressure, figures = Axis("mean pressure, MPa", "log"), table["pressure"], {}
    for name, said in DECLARED["figures"].items() if len(pressure) > 1 else ():
        if not np.isfinite([table[of] for of in said["lines"]]).any():
            continue
        drawn = [
            Line(pressure, table[of], label, replace(describe.look_of_group(n), marker="o"))
            for n, (of, label) in enumerate(said["lines"].items())
        ]
        for of, label in said.get("beside", {}).items():
            if of in beside:
                drawn.append(Line(pressure, beside[of], label, LAWS.get(of, Look(dash="dot"))))
        chart = Chart(said["title"], x, Axis(said["axis"], said.get("scale", "log")), drawn)
        figures[name] = Figure([chart], 1, legend=1, width=describe.COLUMN)
    at, touches = f" at a mean of {last.mean_pressure:.3g} MPa", last.pressure > 0.0
    extent = (0.0, touches.shape[0] * last.cell, 0.0, touches.shape[1] * last.cell)
    fields = {"pressure": (last.pressure, touches), "gap": (1e3 * np.maximum(last.gap, 0.0), ~touches)}
    for name, (field, where) in fields.items():
        said = DECLARED["fields"][name]
        scale = Scale(said["label"], 0.0, float(field.max()) or 1.0, colours=said["colours"])
        title = name.capitalize() + at
        drawn_map = Map(title, [field], extent, scale, x="x, mm", y="y, mm")
        counts, edges = np.histogram(field[where], BINS, (0.0, scale.high))
        places, heights = np.repeat(edges, 2)[1:-1], np.repeat(counts / max(counts.sum(), 1), 2)
        share = Axis(f"share of the area {said['cells']}, –", low=0.0)
        bars = Line(places, heights, look=Look(describe.TOUCHED, ""), low=0.0 * heights, high=heights)
        chart = Chart(title, Axis(said["label"]), share, [bars])
        figures[f"{name}_map"] = Figure([drawn_map], 1, width=describe.COLUMN)
        figures[f"{name}_histogram"] = Figure([chart], 1, width=describe.COLUMN)
    return figures
