"""Heights that a user gives as an array, instead of a file or a synthetic surface named in the study."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.engine.executor import require_memory
from warpwear.errors import OTHER_FOLDER, InputError, sentences
from warpwear.grid import FloatArray
from warpwear.results.file import SURFACE_FILE
from warpwear.study.bodies import Disc
from warpwear.study.study import Study
from warpwear.study.units import text
from warpwear.surfaces.base import Surface
from warpwear.surfaces.measured import Measured
from warpwear.surfaces.preparation import Preparation, prepare
from warpwear.surfaces.reading import Reading

arguments = lazy.module("warpwear.contact.array.arguments")

say = sentences("runs")
#: What the study of a run in memory names in the place of a file.
NO_FILE = "array given to run"
#: Keys of [disc] that do not say what its surface is.
OF_THE_BODY = ("material", "young", "poisson", "hardness")


@dataclass(frozen=True, eq=False)
class ArraySurface:
    """Hold an array of heights, and the study that names it."""

    study: Study
    surface: Surface
    heights: FloatArray  # [mm], as they were given

    def save(self, folder: Path) -> None:
        """Write the heights into a folder, from where the study's name for them leads to the same surface."""
        np.save(folder / SURFACE_FILE, self.heights)

    def refuse_others(self, folder: Path) -> None:
        """Raise InputError unless the heights that a finished run's folder holds are these."""
        path = folder / SURFACE_FILE
        if not (path.is_file() and np.array_equal(np.load(path), self.heights)):
            raise InputError(f"out = {folder} holds a run on another surface; {OTHER_FOLDER}.")


def take_surface(study: Study, surface: Any, folder: Path | None) -> ArraySurface:
    """Return the study on heights [mm] of its domain, or of its track, and what it takes them for.

    surface: an array of the shape of `study.cells`, (rows, ny) of a swept study's track; or an object with
    the methods of `Surface`, which is sampled there; what a `Measured` filled is known as such. Heights count
    from their mean, as measured ones do: an approach is over their mean plane. folder: where `save` is to put
    them; None for a run in memory.

    Raises InputError for another shape, for values that are no finite real numbers or are masked, and for the
    macro model.
    """
    if study.study.model == "macro":
        raise InputError(say("smooth_disc"))
    (x, y), cell = study.places, study.grid.cell
    filled = surface.filled_at(x, y) if isinstance(surface, Measured) else None
    if callable(getattr(surface, "heights", None)):
        what = f"grid.cell = {1e3 * cell:g} µm makes {x.size} × {y.size} cells of the disc"
        require_memory("cpu", 8.0 * x.size * y.size, what, "larger cells or a smaller domain are needed.")
        surface = surface.heights(x, y)
    if not hasattr(surface, "__array__") and not isinstance(surface, list | tuple):
        raise InputError(say("no_heights", kind=type(surface).__name__))
    heights = arguments.checked_heights(surface, 1, name="surface")[0].copy()
    shape = (x.size, y.size)
    if heights.shape != shape:
        where = "track" if study.is_swept else "domain"
        raise InputError(say("other_shape", given=heights.shape, shape=shape, cell=1e3 * cell, where=where))
    path = NO_FILE if folder is None else str(folder.resolve() / SURFACE_FILE)
    reading = Reading(heights, (cell, cell), format="npy", unit="mm", pixel_given=True, unit_given=True)
    prepared = prepare(reading, Preparation(level="none"), name=SURFACE_FILE if folder else NO_FILE)
    details: dict[str, Any] = {"file": Path(path).name, "format": "npy", "unit": "mm", "level": "none"}
    details["operations"] = prepared.record["operations"]
    if filled is not None:
        details["filled_percent"] = 100.0 * float(filled.mean())
    return ArraySurface(
        _on_file(study, path),
        Measured(levelled=prepared.heights, pixel=(cell, cell), filled=filled, details=details),
        heights,
    )


def _on_file(study: Study, path: str) -> Study:
    """Return the study with the disc that a file of one height a cell describes."""
    cell = text(study.grid.cell, "mm")
    named = {"surface": path, "pixel": [cell, cell], "height_unit": "mm", "level": "none"}
    other = study.disc.model_fields_set - {*named, *OF_THE_BODY, "synthetic"}
    named |= {key: Disc.model_fields[key].default for key in other}
    return study.replace({f"disc.{key}": value for key, value in named.items()})
