"""A draft is the text of a commented study of one rig, filled in from a measured surface and from changes."""

import math
import os
from collections.abc import Mapping
from dataclasses import replace
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit

from warpwear.study.loading import change
from warpwear.study.rules_track import worn_widths
from warpwear.study.study import Study
from warpwear.study.surface import surface_of
from warpwear.surfaces.measured import Measured

#: Extent of the domain over the width of the contact that smooth bodies are expected to have.
MARGIN = 1.3
#: Fewest and most cells over the width of that contact, between which a file's pixel is taken as the cell.
CELLS = (20, 400)


def kinds() -> list[str]:
    """Return the names of the rigs that there is a draft of."""
    folder = resources.files(__package__)
    return sorted(file.name.removesuffix(".toml") for file in folder.iterdir() if file.name.endswith(".toml"))


def draft(
    kind: str,
    *,
    name: str,
    folder: Path,
    surface: Path | None = None,
    changes: Mapping[str, Any] | None = None,
) -> str:
    """Return the text of a study of a kind of rig.

    folder: where it will lie, to which the measured surface's path is relative. changes: dotted keys to
    values, which replace those of the draft. Cell and extent follow from the surface's pixel and the
    contact's width where they are not among the changes. Raises InputError for what is no study.
    """
    text = (resources.files(__package__) / f"{kind}.toml").read_text(encoding="utf-8")
    document: Any = tomlkit.parse(text)
    wanted = {"study.name": name, **(changes or {})}
    if surface is not None:
        document["disc"].pop("synthetic", None)
        wanted["disc.surface"] = os.path.relpath(surface, folder)
    change(document, wanted)
    if not {"grid.cell", "grid.extent"} <= set(wanted):
        change(document, _grid(document, wanted, folder, of_file=surface is not None))
    _study(document, folder)  # what is no study is refused before anything is written
    return tomlkit.dumps(document)


def _study(document: Any, folder: Path) -> Study:
    """Return the study of a document that will lie in a folder. Raises InputError."""
    sections = document.unwrap()
    if sections["disc"].get("surface"):
        sections["disc"]["surface"] = str(folder / sections["disc"]["surface"])
    return Study(**sections)


def _grid(document: Any, wanted: Mapping[str, Any], folder: Path, *, of_file: bool) -> dict[str, Any]:
    """Return cell and extent, where they are not wanted otherwise, and how a small file goes on."""
    study = _study(document, folder)
    grid, surface = study.cells, surface_of(study.disc)
    if isinstance(surface, Measured):
        surface = replace(surface, extend="mirror")
    peak = float(np.ptp(surface.heights(grid.x, grid.y)))
    widths = np.array([_width(study, axis, peak) for axis in (0, 1)])
    cell, change_of = grid.cell, dict[str, Any]()
    if isinstance(surface, Measured):
        if "grid.cell" not in wanted:
            widest = widths.max()
            cell = float(f"{min(max(*surface.pixel, widest / CELLS[1]), widest / CELLS[0]):.2g}")
            change_of["grid.cell"] = f"{1e3 * cell:.6g} um"
        if "disc.extend" not in wanted:
            change_of["disc.extend"] = "mirror"  # a track is longer than most measurements
    if "grid.extent" not in wanted:
        sides = [8 * math.ceil(MARGIN * width / cell / 8) * cell if width else cell for width in widths]
        line = isinstance(study.grid.extent, tuple)
        change_of["grid.extent"] = [f"{s:.6g} mm" for s in sides] if line else f"{max(sides):.6g} mm"
    return change_of


def _width(study: Study, axis: int, peak: float) -> float:
    """Return the width [mm] that the contact may have along an axis; peak: height of the roughness [mm]."""
    if not study.counter.form.rises[axis]:
        return 0.0
    smooth = worn_widths(study)[axis]
    if study.hertz is not None:
        smooth = max(smooth, 2.0 * study.hertz.semi_axes[axis])
    lap = study.sliding.lap if study.is_swept else None
    if axis == 0 and lap is not None and lap < smooth:  # a stroke that the contact does not leave widens it
        smooth += lap
    # Where a paraboloid as high as this would cut through the roughness.
    curvature = (study.counter.form.along, study.counter.form.across)[axis]
    return math.hypot(smooth, math.sqrt(8.0 * peak / curvature) if curvature else 0.0)
