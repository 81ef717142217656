"""Films of a contact's bodies say which cells are bare as a step begins, and what cap that leaves them."""

import math
from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np

from warpwear.engine.executor import Field, arguments
from warpwear.engine.program import Program
from warpwear.engine.state import InFrame
from warpwear.grid import FloatArray
from warpwear.kernels.cells import Coat, Films
from warpwear.kernels.running_in import film as kernels
from warpwear.laws.archard import BODIES
from warpwear.laws.film import Film
from warpwear.models.features.feature import Feature, Place, Site

#: What is kept of every cell of a body whose film forms anew.
KEPT = ("whole", "seen", "rubbed")
#: Whose film of a contact it is; that of bodies which wear in one proportion does not move, as the ball's.
AS = {"counter": "counter", "disc": "disc", "both": "counter"}


class BareCells(Feature, name="film"):
    """Keeps track of the cells that wear has bared, of bodies one of which may move under the other.

    Of bodies that wear in one proportion, `worn` of a site, one film is as thick as both have worn then.
    """

    STATE: ClassVar = {
        "healing": {"counter": InFrame("counter"), "disc": InFrame("disc"), "both": InFrame("contact")}
    }
    SCRATCH: ClassVar = ("bare",)

    def __init__(self, film: Film, site: Site) -> None:
        task, executor, thickness = site.task, site.executor, film.thickness
        if "worn" in site.bodies:
            least = min(part for part, on in zip(task.wear_fractions, film.on, strict=True) if on)
            thickness = film.thickness / least if least else math.inf
            wear = {"both": site.bodies["worn"]}
        else:
            wear = {b: site.bodies[f"wear_{b}"] for b, on in zip(BODIES, film.on, strict=True) if on}
        self._executor = executor
        #: Whether the tiles listed have all that a step wears.
        self._listed = "worn" not in site.bodies and task.pieces is None and not task.half_space
        #: 1 where a cell was bare as the last step began, else 0: of the cells listed, or of all.
        self.bare = executor.zeros()
        self.properties = {"material": self.bare}
        filmed = {"cap_ratio": film.cap_ratio_filmed} if film.changes_caps else {}
        filmed |= {"shear_ratio": film.shear_ratio} if task.shears and "worn" not in site.bodies else {}
        for name, ratio in filmed.items():
            self.properties[name] = executor.field(np.full(executor.grid.shape, ratio), padding=ratio)
        self._heals = math.isfinite(film.regrowth)
        #: Of films that form anew: see `Coat`.
        self.healing: dict[str, dict[str, Field]] = {
            body: {name: executor.zeros(field.shape[0] if self._heals else 0) for name in KEPT}
            for body, field in wear.items()
        }
        films = arguments(
            Films,
            thickness=thickness,
            regrowth=film.regrowth,
            cap_filmed=film.cap_ratio_filmed,
            cap_bare=film.cap_ratio_bare,
            shear_filmed=film.shear_ratio,
        )
        for body, field in wear.items():
            setattr(films, AS[body], arguments(Coat, wear=field, **self.healing[body]))
        self.sources = {"films": films}

    def make_all(self, program: Program, place: Place) -> None:
        """Add a look at which of all cells are bare as a step begins."""
        program.launch(kernels.look, place.slides, place.sources, place.cells)

    def after_part(self, program: Program, place: Place) -> None:
        """Add a note of what the step has worn."""
        if not self._heals:
            return
        if self._listed and place.listed:  # patches have no list
            program.launch(kernels.rub_tiles, *place.listed, place.slides, place.sources)
        else:
            program.launch(kernels.rub, place.slides, place.sources, self._executor.grid.nx)

    def enter(self, columns: Mapping[str, FloatArray], total: dict[str, Any], most: dict[str, Any]) -> None:
        """Enter the bare cells in contact."""
        total["bare"] = columns["bare"]

    def fields(self, pressure: FloatArray) -> dict[str, FloatArray]:
        """Return which cells were bare as the last step began."""
        return {"bare": self._executor.to_numpy(self.bare)}
