"""A result as a notebook shows it: a small table and two figures."""

import base64
import io
from html import escape
from typing import Any

from warpwear import figure_style
from warpwear.results import Result

#: Figures shown, as far as the run has them; pixels an inch.
FIGURES, DPI = ("cof", "pressure_map"), 110


def to_html(result: Result) -> str:
    """A fragment of HTML with the images inside, so that it needs no files."""
    left = "style='text-align:left'"
    rows = "".join(
        f"<tr><th {left}>{escape(label)}</th><td {left}>{escape(value)}</td></tr>"
        for label, value in _rows(result.summary)
    )
    plot = result.plot
    images = "".join(_image(name, getattr(plot, name)()) for name in FIGURES if plot.reason(name) is None)
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
        friction = f"{s['cof']['end']:.3g} from the area {s['cof_area']}"
        rows.append(("coefficient of friction at the end", friction))
    if s["assumptions"]:
        rows.append(("assumptions", f"{len(s['assumptions'])}, see .summary['assumptions']"))
    return rows


def _image(name: str, figure: Any) -> str:
    written = io.BytesIO()
    with figure_style.style():
        figure.savefig(written, format="png", dpi=DPI)
    text = base64.b64encode(written.getvalue()).decode("ascii")
    return f"<img alt='{name}' src='data:image/png;base64,{text}'>"
