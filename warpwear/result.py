"""A run as a user holds it: its numbers, its pictures, its summary, and how a notebook shows it."""

import base64
from functools import cached_property
from html import escape
from pathlib import Path
from typing import Any

from warpwear.lazy import resolve
from warpwear.results.evolution import SurfaceEvolution, surface_evolution
from warpwear.results.file import ResultFile
from warpwear.results.frames import to_dataframe, to_xarray
from warpwear.results.summary import summarise
from warpwear.results.summary_text import INPUT

#: Draws the figures; Matplotlib takes as long to import as everything else together.
PLOTTER = "warpwear.figures.table:Plotter"
#: Writes files for other software.
EXPORT = "warpwear.results.export:export"
#: Figures shown, as far as the run has them; pixels an inch.
FIGURES, DPI = ("cof", "pressure_map"), 110


class Result(ResultFile):
    """A run: its history, its snapshots, its figures. Open one with `Result.open(path)`."""

    @cached_property
    def summary(self) -> dict[str, Any]:
        """What `summary.json` says: scar, depths, volumes, areas, residuals, conservation, assumptions."""
        return summarise(self)

    @property
    def surface_evolution(self) -> SurfaceEvolution:
        """Roughness inside the scar and islands of contact at every snapshot."""
        return surface_evolution(self)

    def to_dataframe(self) -> Any:
        """The history as a pandas.DataFrame, a row a step; units in `.attrs["units"]`."""
        return to_dataframe(self)

    def to_xarray(self) -> Any:
        """History, patches and all snapshots as an xarray.Dataset, read into memory.

        Dimensions step, distance (of the snapshots), x, y, track_x, patch; units in the attributes.
        """
        return to_xarray(self)

    def export(self, folder: str | Path, **options: Any) -> list[Path]:
        """Write worn bodies and fields into a folder for other software; returns the paths.

        options: formats, such as ["vti", "x3p"]; snapshot, bodies, fields, points, exaggeration, overwrite,
        as `warpwear export` has them. Raises InputError.
        """
        paths: list[Path] = resolve(EXPORT)(self, folder, **options)
        return paths

    @cached_property
    def plot(self) -> Any:
        """Figures: `result.plot.cof()` and so on return a matplotlib figure."""
        return resolve(PLOTTER)(self)

    def _repr_html_(self) -> str:
        """A notebook's view of the result."""
        return _to_html(self)


def _to_html(result: Result) -> str:
    """A fragment of HTML with the images inside, so that it needs no files."""
    left = "style='text-align:left'"
    rows = "".join(
        f"<tr><th {left}>{escape(label)}</th><td {left}>{escape(value)}</td></tr>"
        for label, value in _rows(result.summary)
    )
    plot = result.plot
    images = "".join(_image(name, plot.png(name, dpi=DPI)) for name in FIGURES if plot.reason(name) is None)
    return f"<div><b>{escape(result.study.study.name)}</b><table>{rows}</table>{images}</div>"


def _rows(summary: dict[str, Any]) -> list[tuple[str, str]]:
    s = summary
    state = "" if s["finished"] else ", interrupted"
    of_pass = ", last pass" if "track" in s else ""
    rows = [
        ("sliding distance", f"{s['distance_mm']:g} mm in {s['steps']} steps{state}"),
        ("scar, along × across", f"{s['scar_mm']['along']:.4g} × {s['scar_mm']['across']:.4g} mm"),
        (f"area in contact{of_pass}", f"{s['area_mm2']['contact']:.4g} mm²"),
        (
            f"pressure, mean and largest{of_pass}",
            f"{s['pressure_MPa']['mean']:.4g}, {s['pressure_MPa']['max']:.4g} MPa",
        ),
    ]
    for what, values, unit in (
        ("deepest wear", s["depth_um"], "µm"),
        ("worn volume", s["volume_mm3"], "mm³"),
    ):
        rows.append((f"{what}, sphere and disc", f"{values['sphere']:.4g}, {values['disc']:.4g} {unit}"))
    if s["cof"]["end"] is not None:
        given = INPUT if s["cof_input"] == "end" else ""
        friction = f"{s['cof']['end']:.3g}{given} from the area {s['cof_area']}"
        rows.append(("coefficient of friction at the end", friction))
    if s["assumptions"]:
        rows.append(("assumptions", f"{len(s['assumptions'])}, see .summary['assumptions']"))
    return rows


def _image(name: str, png: bytes) -> str:
    text = base64.b64encode(png).decode("ascii")
    return f"<img alt='{name}' src='data:image/png;base64,{text}'>"
