"""Press measured surfaces on each other: what their joint conducts over the load, and all of one contact."""

import math
import re
import sys
import time
import tomllib
import warnings
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from importlib.resources import files
from pathlib import Path
from typing import Any, Unpack

import numpy as np

from warpwear import lazy
from warpwear.clock import lasting
from warpwear.contact.array.arguments import FORM_KEYS, counter_of, shown
from warpwear.contact.array.contact import ArrayContact
from warpwear.contact.array.solve import solve_contact
from warpwear.errors import InputError, named_in_python
from warpwear.figures import describe
from warpwear.figures.describe import Axis, Chart, Ends, Figure, Level, Line, Look, Map, Scale
from warpwear.grid import FloatArray, Grid, box_of
from warpwear.history.verdict import OF_PERIMETER, sides_of
from warpwear.laws.elastic import Hertz, asperities, effective_modulus, joint_laws
from warpwear.laws.form import Form
from warpwear.measured.options import quantity
from warpwear.measured.report import FileReport, FolderReport, paged
from warpwear.measured.surface import HowToRead, read_surface
from warpwear.measured.surface_report import MeasuredSurface
from warpwear.results.report import Row, aligned, finite, lines
from warpwear.study.materials import Material
from warpwear.study.materials import material as known_material
from warpwear.study.units import Range
from warpwear.surfaces.roughness import rms_slope

ndimage, pressing = lazy.module("scipy.ndimage"), lazy.module("warpwear.contact.stress.stresses")

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
#: Part of the cells beyond which none are shown where they would take more than half of an axis.
COMMON = 0.999
#: Seconds of a table from which it is told how long it takes; over those of cells twice as wide, about.
LONG, FINER = 60.0, 8.0
#: Units of columns, figures, and what the page says.
DECLARED = tomllib.loads((files("warpwear.measured") / "joint.toml").read_text(encoding="utf-8"))
FLOWS = [name for name in DECLARED["columns"] if "flow" in name]
HEADS = {name: f"{name} [{unit}]" for name, unit in DECLARED["columns"].items()}

#: Lengths of a counter-body: a sharp edge has none, a flat an infinite one.
RADII = Range(or_equal=True, infinite=True)
#: Numbers in the order in which they are told, declared as the file says.
SHOWN = DECLARED["contact"]["rows"]
#: Depths below the surface at which stresses are computed, down to radii of the largest spot; rows of a map.
DEPTHS, DEEPEST, ROWS = 32, 3.0, 200

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

    def _declared(self) -> Figure:
        return next(iter(self.figures.values()))

    def write_table(self, path: str | Path) -> None:
        """Write the table as CSV, a row a load, units in the header.

        Parameters
        ----------
        path : path
            Of the file, which is replaced where it is there.
        """
        rows = np.column_stack([*self.table.values()])
        heads = ",".join(HEADS.get(name, name) for name in self.table)
        np.savetxt(path, rows, "%.9g", delimiter=",", header=heads, comments="")

    def _parts(self, folder: Path) -> dict[str, Any]:
        page = DECLARED[self.MARK.removesuffix(".json")]
        name, *told = self.text.split("\n")
        sections, how = page["sections"], page["how"]
        return paged(self, self.figures, sections, self.write_table, name=name, lines=told, how=how)


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class MeasuredContact(JointCurve):
    """A contact of a measured surface has pressures and gaps, and numbers of them; `print` shows some.

    Attributes
    ----------
    contact : ArrayContact
        As `solve_contact` returned it, in mm, N and MPa.
    table : dict
        Name, its unit at the end -> value, (1,), NaN where it is not known.
    figures : dict
        Name -> what it shows.
    """

    MARK = "contact.json"
    WHAT = "a contact"
    contact: ArrayContact


@named_in_python()
def joint_curve(
    path: str | Path,
    *,
    load: str | float,
    material: str,
    against: str | Path | None = None,
    against_material: str | None = None,
    hardness: str | float | None = None,
    flow: bool = True,
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
    flow
        Whether to find what flows through the gap, which takes most of the time.
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
    loads, pair = loads_of(load), [known(material)]
    pair.append(known(against_material, "--against-material") if against_material else pair[0])
    surfaces = [read_surface(file, **how) for file in ([path] if against is None else [path, against])]
    rows, table, coarse, last = pressed(surfaces, loads, pair, hardness, flow=flow, device=device)
    cells = [[f"{at:.3g}" for at in row] for row in zip(*table.values(), strict=True)]
    heads = [*HEADS.values()]
    rows.insert(-1, Row("residual", "residual_largest", float(table["residual"].max()), note="at most"))
    rows.append(Row("", "table", dict(zip(heads, map(list, table.values()), strict=True))))
    other = Path(str(against)).name if against else "a smooth plane"
    shown = [row[:PRINTED] for row in [heads, *cells]] if len(cells) > 1 else zip(heads, *cells, strict=True)
    of_loads = [f"  {line}" for line in aligned([*shown])]
    text = "\n".join([f"joint of {Path(path).name} and {other}", *lines(rows), *of_loads])
    figures = figures_of(table, coarse, last)
    return JointCurve(text=text, rows=rows, table=table, figures=figures)


@named_in_python()
def measured_contact(
    path: str | Path,
    *,
    load: float | str,
    material: str,
    counter: Mapping[str, Any] | None = None,
    against: str | Path | None = None,
    hardness: str | float | None = None,
    flow: bool = False,
    stresses: bool = False,
    device: str = "cpu",
    **how: Unpack[HowToRead],
) -> MeasuredContact:
    """Press a measured surface on a plane, another one or a counter-body, and return all of that contact.

    Parameters
    ----------
    path
        File of a measured surface.
    load
        A force [N], or text, "5 N"; on a plane and another surface a mean pressure, "10 MPa", too.
    material
        Name of a known material, see `materials`.
    counter
        Keys of a study's [counter]: its form, shape, radius, radius_along, radius_across and edge_radius,
        without which it is a plane; and its material, by default the same.
    against
        File of another surface instead, turned over about x.
    hardness
        Largest pressure of a cell [MPa], or text; by default that of the softer material.
    flow
        Whether to find what flows through the gap of a surface that repeats.
    stresses
        Whether to find the stresses below the surface.
    device
        "cpu" or "cuda:0".
    **how
        How the files are read, as for `read_surface`.

    Returns
    -------
    MeasuredContact
        Areas, pressures, gaps, stiffness, what it conducts, and figures.

    Raises
    ------
    InputError
        For a file, load, material or counter-body that is not possible.

    Examples
    --------
    >>> np.save("lapped.npy", np.random.default_rng(0).normal(0.0, 0.1, (64, 64)))
    >>> lapped = {"pixel": "2 um", "height_unit": "um", "s_filter": 0.016}
    >>> ball = {"radius": "3 mm", "material": "AISI 52100"}
    >>> under = warpwear.measured_contact("lapped.npy", load=0.01, material="PEEK", counter=ball, **lapped)
    >>> round(under.numbers["hertz_radius_um"], 2), under.contact.boundary
    (16.89, 'free')
    """
    if not isinstance(counter or {}, Mapping):
        raise InputError(f"counter = {shown(counter)}: keys of a study's [counter] are allowed, in a dict")
    keys = dict(counter or {})
    pair = [known(material), known(keys.pop("material", material), "counter.material")]
    radii = {k: quantity(f"counter.{k}", keys[k], "mm", allowed=RADII) for k in FORM_KEYS if k in keys}
    form: Any = counter_of(keys | radii or None, counter_radius=None, shape=(0, 0))
    by, amount = load_of(load, plane=form is None)
    given: dict[str, Any] = {"by": by, "flow": flow, "device": device}
    other = Path(str(against)).name if against else "a smooth plane"
    if form is not None:
        if flow or against is not None:
            raise InputError(f"{'--flow' if flow else '--against'} and a counter-body exclude each other")
        given |= {"counter": keys | radii, "boundary": "line" if form.rises == (True, False) else "free"}
        shape = keys.get("shape", "ball").replace("crowned", "crowned body")
        other = f"a {shape}, {', '.join(f'{key} {mm:g} mm' for key, mm in radii.items())}"
    surfaces = [read_surface(file, **how) for file in ([path] if against is None else [path, against])]
    rows, columns, _, contact = pressed(surfaces, np.array([amount]), pair, hardness, **given)
    values = numbers_of(contact, {name: float(column[0]) for name, column in columns.items()}, form)
    drawn, below = stresses_of(contact, pair[0]) if stresses else ({}, {})
    figures, values = fields_of(contact) | drawn, values | below
    told = {name: finite(value) for name, value in values.items()}
    own = [
        Row(said["label"], key, told.get(key), unit=said.get("unit"), note=said.get("note", ""))
        for key, said in SHOWN.items()
    ]
    own[0] = replace(own[0], error=told["area_corrected_error_mm2"])
    undefined = [text for key, text in DECLARED["undefined"].items() if told.get(key) is None]
    rows = [*own, *rows[:-1], Row("has no meaning", "undefined", undefined or None), rows[-1]]
    text = "\n".join([f"contact of {Path(path).name} and {other}", *lines(rows)])
    table = {name: np.array([value]) for name, value in values.items()}
    return MeasuredContact(text=text, rows=rows, table=table, figures=figures, contact=contact)


def known(name: str, option: str = "--material") -> Material:
    """Return the known material of an option. Raises InputError."""
    try:
        return known_material(str(name))
    except ValueError as error:
        raise InputError(f"{option}: {error}") from None


def loads_of(said: str | float) -> FloatArray:
    """Return the mean pressures [MPa] that a text says, or a number. Raises InputError."""
    text = said if isinstance(said, str) else f"{said} MPa"
    unit, is_range = "".join(re.findall(r"[^\d\s.,:eE+-]\S*$", text.strip())), ":" in text
    numbers = [part.replace(unit, "").strip() for part in text.split(":" if is_range else ",")]
    values = [quantity("--load", f"{number} {unit}".strip(), "MPa") for number in numbers]
    if sorted({*values}) != values or (is_range and len(values) != 2):
        raise InputError(f"--load = {text!r}: allowed are '0.1:100 MPa', or loads that rise, '1, 5, 20 MPa'")
    return np.geomspace(values[0], values[1], LOADS) if is_range else np.array(values)


def pressed(
    surfaces: list[MeasuredSurface], loads: FloatArray, pair: list[Material], hardness: Any, **given: Any
) -> tuple[list[Row], Table, Table, ArrayContact]:
    """Press surfaces: return rows, the columns of `press`, those of cells twice as wide, and the contact.

    given: what `press` takes.
    """
    softer = min(body.hardness for body in pair)
    limit = softer if hardness is None else quantity("--hardness", hardness, "MPa")
    heights, cell = rough(*surfaces)
    most, unit = (limit * heights.size * cell**2, "N") if given.get("by") == "load" else (limit, "MPa")
    if loads[-1] > most:
        raise InputError(f"--load = {loads[-1]:g} {unit}: at most {most:g} {unit}, all at the hardness")
    modulus = effective_modulus(*((body.young, body.poisson) for body in pair))
    doubts = [doubt for body in surfaces for doubt in body.numbers["doubts"]]
    wide = heights.reshape(heights.shape[0] // 2, 2, -1, 2).mean(axis=(1, 3))
    given |= {"modulus": modulus, "hardness": limit}
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        coarse, _ = press(wide, loads, pair, cell=2.0 * cell, finer=FINER, **given)
        told.clear()
        table, last = press(heights, loads, pair, cell=cell, **given)
    slope = rms_slope(heights, pixel=(cell, cell))
    laws = joint_laws(loads, sq=float(heights.std()), slope=slope, hardness=limit, modulus=modulus)
    coarse = {**coarse, **laws}
    steep = ": half-spaces are for small slopes" if slope > STEEP else ""
    ratio, mode = asperities(limit, modulus, slope)
    changes = []
    with np.errstate(invalid="ignore", divide="ignore"):  # infinite where all is in contact, 0 where no flow
        for name in CHANGED:
            change = 100.0 * (coarse[name] / table[name] - 1.0)
            change = change[np.isfinite(change)]
            changes.append(Row(name, name, float(change.mean()) if change.size else None, 3))
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
        Row("warning", "warnings", [*doubts, *dict.fromkeys(str(one.message) for one in told)] or None),
    ]
    return rows, table, coarse, last


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
    heights: FloatArray, loads: FloatArray, pair: list[Material], *, by: str = "mean_pressure", **given: Any
) -> tuple[Table, ArrayContact]:
    """Return the columns of all loads, NaN where it is not known what conducts, and the last contact.

    by: what the loads are to `solve_contact`, which takes what is given. flow: whether there is any. finer:
    how much longer all takes, finer cells too, of which it is told; 0 for nothing. The first load compiles.
    """
    begun, finer = time.monotonic(), given.pop("finer", 0.0)
    flow, on, rows = given.pop("flow", True), {"device": given.pop("device")}, []
    k, rho = ([getattr(body, name) or math.nan for body in pair] for name in ("conductivity", "resistivity"))
    for load in loads:
        contact = solve_contact(heights, **{by: load}, **on, **given)
        area, length, flows = contact.nominal_area, contact.conductance(**on), [math.nan] * len(FLOWS)
        try:
            if flow:
                of = contact.flow_factors()
                flows = [of.along, of.across, of.shear, *(of.nominal or flows[:2])]
        except InputError as error:  # of too many cells
            warnings.warn(f"flow is not known: {error}", stacklevel=2)
        row = {
            "pressure": contact.mean_pressure if by == "load" else load,
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
            "residual": contact.residual,
        }
        rows.append([row[name] for name in DECLARED["columns"]])
        lasts, begun = finer * len(loads) * (time.monotonic() - begun), time.monotonic()
        if len(rows) == 2 and finer and lasts > LONG:
            cure = "most for what flows; less by --no-flow, or --crop" if flow else "less by --crop"
            print(f"joint: about {lasting(lasts)}, {cure}", file=sys.stderr)
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
    return figures | fields_of(last)


def view(contact: ArrayContact) -> tuple[tuple[slice, slice], Ends]:
    """Return the cells that are shown, and their place [mm]: those around a contact that does not repeat."""
    shape, cell = contact.pressure.shape, contact.cell
    box = None if contact.boundary == "periodic" else box_of(contact.pressure > 0.0)
    i, last_i, j, last_j = box or (0, shape[0], 0, shape[1])
    beside = 2 + max(last_i - i, last_j - j) // 2
    x = slice(max(i - beside, 0), min(last_i + beside, shape[0]))
    y = slice(max(j - beside, 0), min(last_j + beside, shape[1]))
    return (x, y), (x.start * cell, x.stop * cell, y.start * cell, y.stop * cell)


def fields_of(contact: ArrayContact) -> dict[str, Figure]:
    """Declare the figures of the pressures and gaps of a contact."""
    part, extent = view(contact)
    pressure, gap = contact.pressure[part], 1e3 * np.maximum(contact.gap[part], 0.0)
    touches, beyond = pressure > 0.0, np.isinf(gap)
    gap[beyond] = np.nan
    at = f" at a mean of {contact.mean_pressure:.3g} MPa"
    at = at if contact.boundary == "periodic" else f" under {contact.load:.3g} N"
    figures, fields = {}, {"pressure": (pressure, touches), "gap": (gap, ~(touches | beyond))}
    for name, (field, where) in fields.items():
        said = DECLARED["fields"][name]
        values = field[where]
        if not values.size:
            continue
        top, common = float(values.max()) or 1.0, float(np.quantile(values, COMMON))
        high = common if 0.0 < common < 0.5 * top else top
        further = float(np.mean(values > high))
        label = said["label"] + (f"; {further:.2g} of the area lies beyond" if further else "")
        end: Any = "max" if further else "neither"
        scale = Scale(said["label"], 0.0, high, colours=said["colours"], beyond=end)
        title, hidden = name.capitalize() + at, beyond if beyond.any() else None
        drawn_map = Map(title, [field], extent, scale, hidden=hidden, x="x, mm", y="y, mm")
        counts, edges = np.histogram(values, BINS, (0.0, high))
        places, heights = np.repeat(edges, 2)[1:-1], np.repeat(counts / values.size, 2)
        share = Axis(f"share of the area {said['cells']}, –", low=0.0)
        bars = Line(places, heights, look=Look(describe.TOUCHED, ""), low=0.0 * heights, high=heights)
        chart = Chart(title, Axis(label), share, [bars])
        figures[f"{name}_map"] = Figure([drawn_map], 1, width=describe.COLUMN)
        figures[f"{name}_histogram"] = Figure([chart], 1, width=describe.COLUMN)
    return figures


def load_of(text: float | str, *, plane: bool) -> tuple[str, float]:
    """Return what a load is to `solve_contact`, and how much [N, MPa]. Raises InputError."""
    for name, unit in (("load", "N"), ("mean_pressure", "MPa"))[: 1 + plane]:
        with suppress(InputError):
            return name, quantity("--load", text, unit)
    raise InputError(f"--load = {text!r}: allowed are a force, '5 N', and of a plane a pressure, '10 MPa'")


def numbers_of(contact: ArrayContact, at: Mapping[str, float], form: Form | None) -> dict[str, float]:
    """Return the numbers of a contact by name, NaN where one has none. at: its columns of `press`."""
    area, cell, curved = contact.nominal_area, contact.cell, form and (form.along or form.across)
    touches, approach = contact.pressure > 0.0, 1e3 * contact.approach
    # Towards the edge of a pin pressures do not fall to zero.
    over = math.nan if form and not curved else OF_PERIMETER * sides_of(touches) * cell**2
    values = {key: float(getattr(contact, said["of"])) for key, said in SHOWN.items() if "of" in said}
    values |= {key: area * at[name] * by for key, (name, by) in DECLARED["contact"]["totals"].items()}
    values |= {
        "area_corrected_mm2": contact.area - over,
        "area_corrected_error_mm2": 0.5 * over,
        "spots": float(ndimage.label(touches)[1]),
        "pressure_max_MPa": float(contact.pressure.max()),
        "approach_um": math.nan if contact.boundary == "line" else approach,
        "resistance_ohm": at["resistance"] / area,
        "energy_gap_relative": contact.certificate.relative_gap,
    }
    if contact.boundary == "periodic":
        values |= {"area_nominal_mm2": area, "gap_um": at["gap"]}
        values |= {head: at[name] for name, head in HEADS.items() if head in SHOWN}
    if form and curved:
        along, across = (1.0 / rise if rise else math.inf for rise in (form.along, form.across))
        length = cell * contact.pressure.shape[1 if form.along else 0]
        hertz = Hertz(contact.modulus or math.nan, along, contact.load, across, length)
        values |= {"hertz_radius_um": 1e3 * hertz.radius, "hertz_pressure_MPa": hertz.peak_pressure}
        values |= {"hertz_area_mm2": hertz.area, "hertz_approach_um": 1e3 * hertz.approach}
    return values


def stresses_of(contact: ArrayContact, body: Material) -> tuple[dict[str, Figure], dict[str, float]]:
    """Declare figures of von Mises' stress below the surface, of the body with the heights, and its largest.

    Dashed: a third of the hardness, at which it yields (Tabor 1951).
    """
    cell, spots = contact.cell, ndimage.label(contact.pressure > 0.0)[0]
    deepest = DEEPEST * cell * math.sqrt(np.bincount(spots.ravel())[1:].max() / math.pi)
    depths = np.append(0.0, np.geomspace(0.5 * cell, deepest, DEPTHS))
    below = (pressing.stresses(contact, depth, poisson=body.poisson).mises[0] for depth in depths)
    mises = np.stack([stress.astype(np.float32) for stress in below])
    k, i, j = (int(at) for at in np.unravel_index(int(mises.argmax()), mises.shape))
    largest, limit, beside = mises.max(axis=(1, 2)), body.hardness / 3.0, math.ceil(0.7 * deepest / cell)
    low, high = max(i - beside, 0), min(i + beside + 1, mises.shape[1])
    levels = np.linspace(deepest, 0.0, ROWS)
    plane = np.array([np.interp(levels, depths, column) for column in mises[:, low:high, j].T])
    label, dashed = "von Mises' stress, MPa", Look(describe.HARDNESS, "dash", 0.8)
    regions = [(plane > limit, dashed)] if largest[k] > limit else []
    scale, extent = Scale(label, 0.0, float(largest[k])), (low * cell, high * cell, -deepest, 0.0)
    section = Map("Below the surface", [plane], extent, scale, regions=regions, x="x, mm", y="−z, mm")
    drawn = Line(depths, largest), Level(limit, look=dashed)
    chart = Chart("Largest of each depth", Axis("depth, mm", low=0.0), Axis(label, low=0.0), drawn)
    figures = [Figure([panel], 1, width=describe.COLUMN) for panel in (section, chart)]
    numbers = {"mises_max_MPa": largest[k], "mises_depth_um": 1e3 * depths[k], "yield_MPa": limit}
    return dict(zip(("stress_map", "stress_depths"), figures, strict=True)), numbers
