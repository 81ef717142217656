"""Bodies have materials by worn depth: K and the cap of cells, and what each material bears and loses.

Where pressures or materials bound it, the shear of cells is booked too.
"""

import math
from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np
import warp as wp

from warpwear.engine.executor import Executor, Field
from warpwear.engine.program import Program
from warpwear.grid import FloatArray
from warpwear.kernels.running_in import materials as kernels
from warpwear.laws.archard import BODIES
from warpwear.laws.depth_profile import DepthProfile
from warpwear.laws.task import ContactTask
from warpwear.models.features.feature import Feature, Host, Place

#: Stands for no limit [1].
NONE = 1.0e300
#: K of both bodies, as cells and steps have it.
KS = ("k_counter", "k_disc")
#: Lines of the books, as the history has them.
COLUMNS = (
    *(f"{kind}_{body}_{m}" for body in BODIES for kind in kernels.BOOKS for m in range(kernels.BOOKED)),
    "shear_ratios",
)
#: Which lines of the books are depths, that add up over parts of a step; others are averaged.
IS_DEPTH = np.array(["lost" in name for name in COLUMNS])


def depth_numbers(profile: DepthProfile, hardness: float) -> FloatArray:
    """Return the numbers of a body's materials as kernels read them, one column each.

    hardness: of the task [MPa]. Rows are the depths at which materials begin [mm], K over that of the
    uppermost and its change by depth [1/mm], the same of the cap over the hardness, the shear strength over
    that of the body, the largest shear over the pressure, over that strength [1/MPa], and by how much K ΔL p
    of the uppermost the body was worn where they begin [mm].
    """
    materials, depths, top = profile.materials, np.array(profile.depths), profile.materials[0].wear
    strength = materials[-1].shear_strength

    def over(value: float, whole: float) -> float:
        return 1.0 if value == whole else min(value / whole, NONE)

    wear, caps = (
        [over(*p) for p in pairs]
        for pairs in ([(m.wear, top) for m in materials], [(m.hardness, hardness) for m in materials])
    )
    slopes = np.zeros((2, depths.size))
    if profile.graded:
        slopes[:, :-1] = np.diff([wear, caps]) / np.diff(depths)
    shear = [over(m.shear_strength, strength) for m in materials]
    bound = [NONE if math.isinf(m.coefficient) else m.coefficient / strength for m in materials]
    exposure = np.minimum(top * profile.exposure(depths), NONE)
    return np.array([depths, wear, slopes[0], caps, slopes[1], shear, bound, exposure])


def steps_above(
    task: ContactTask, cell_area: float, most: Mapping[str, float], removals: Mapping[str, FloatArray | float]
) -> int:
    """Return how many next steps cannot reach another material than the uppermost of both bodies.

    most: the deepest wear of each by name [mm]. removals: K ΔL of each by its name, by steps [mm³/N]. A cell
    bears no more than an unworn one, or all of the load. Shear that pressures bound is booked always.
    """
    if task.profiles is None or task.surface_shear is None:
        return 0
    bears = min(task.hardness, task.load / cell_area)
    depths = (
        max(most[f"wear_{b}"], 0.0) + bears * np.add.accumulate(np.atleast_1d(removals[b])) for b in BODIES
    )
    return min(int(np.searchsorted(d, p.first_interface)) for d, p in zip(depths, task.profiles, strict=True))


class MaterialsByDepth(Feature):
    """Gives cells K and the cap of the materials that meet there; books what each bears and loses.

    On the half-space the mean of K lends a compliance to all cells, and each has the deviation from it.
    """

    STATE: ClassVar = {"means": tuple}
    SCRATCH: ClassVar = (
        "_books",
        "_of_parts",
        "_slid",
        "_slides",
        "_largest",
        "properties",
        "sources",
        "yields",
    )
    columns = COLUMNS

    def __init__(self, task: ContactTask, executor: Executor, bodies: Mapping[str, Field]) -> None:
        profiles = task.profiles or ()
        self._executor, self._profiles = executor, dict(zip(BODIES, profiles, strict=False))
        self._wear = {body: bodies[f"wear_{body}"] for body in BODIES}
        self.properties: dict[str, Field] = {}
        for body, profile in self._profiles.items():
            numbers = depth_numbers(profile, task.hardness)
            self.properties[f"materials_{body}"] = wp.array(numbers, dtype=wp.float64, device=executor.device)
            if any(m.wear != profile.materials[0].wear for m in profile.materials):
                self.properties[f"k_{body}"] = self._ones()
        if task.half_space and not set(KS).isdisjoint(self.properties):
            self.yields = self.properties["yields"] = executor.zeros()
        #: K over that of the uppermost materials: the mean under the last pressure, and at most.
        self.means: tuple[float, ...] = (1.0, 1.0)
        self._largest: tuple[float, ...] = (1.0, 1.0)
        #: Books of the parts of a step so far, and the distance that they go over [mm].
        self._of_parts, self._slid = np.zeros(kernels.LINES), 0.0
        if any(m.hardness != p.materials[0].hardness for p in profiles for m in p.materials):
            self.properties["cap_ratio"] = self._ones()
        self.sources = {f"wear_{body}": field for body, field in self._wear.items()}
        self.sources |= {"layered": int(self.gives), "largest_shear": min(task.largest_shear, NONE)}
        slots = executor.slots_of(executor.grid.nx)
        self._books = wp.zeros((kernels.LINES, slots), dtype=wp.float64, device=executor.device)

    @property
    def gives(self) -> bool:
        """Tell whether cells have K or a cap of their own by their materials."""
        return not {*KS, "cap_ratio"}.isdisjoint(self.properties)

    def _ones(self) -> Field:
        return self._executor.field(np.ones(self._executor.grid.shape), padding=1.0)

    def prepare(self, host: Host, increment: float, removals: tuple[float, float]) -> None:
        """See how fast the materials wear that the deepest cells have reached."""
        self._slides, most = host.slides, host.ledger.most
        self._largest = tuple(
            profile.fastest_above(most[f"wear_{body}"]) / profile.materials[0].wear
            if profile.materials[0].wear  # else nothing below it is ever reached
            else 1.0
            for body, profile in self._profiles.items()
        )

    def ratios(self, window: int) -> tuple[float, float]:
        """Return the means of K, and the largest of a body that wears by a mean of pressures."""
        means = list(self.means)
        if window > 1 and self._profiles:
            by_mean = self._slides["counter_moves"]
            means[by_mean] = self._largest[by_mean]
        return means[0], means[1]

    def row(self, increment: float, total: Mapping[str, float]) -> dict[str, float]:
        """Add up the books of a part of a step, and learn the means of K from them."""
        lines = self._books.numpy().sum(axis=1)
        self._of_parts += np.where(IS_DEPTH, 1.0, increment) * lines
        self._slid += increment
        of_bodies = lines[:-1].reshape(len(BODIES), len(kernels.BOOKS), -1).sum(axis=2).tolist()
        expected = [self._slides[name] * p for name, (_, p, _) in zip(KS, of_bodies, strict=True)]
        pairs = zip(KS, (lost for *_, lost in of_bodies), expected, strict=True)
        self.means = tuple(
            lost / by_top if name in self.properties and lost > 0.0 < by_top else 1.0
            for name, lost, by_top in pairs
        )
        return {}

    def before_wear(self, program: Program, place: Place) -> None:
        """Add the books of a solved contact, of the tiles listed."""
        if place.pressed is not None:
            pressed = place.slides, place.pressed, place.sources
            program.launch(kernels.book_pressed, *pressed, self._books)
            return
        contact = place.slides, place.springs, place.sources, place.cells, place.bodies.gap
        program.launch(kernels.book, *place.listed, *contact, self._books)

    def between(self, program: Program, place: Place) -> None:
        """Add that the books go into the row of the step."""
        program.decide(kernels.record, place.slides, self._books, place.steps.history, self.first_column)

    def enter(self, columns: Mapping[str, FloatArray], total: dict[str, Any], most: dict[str, Any]) -> None:
        """Enter the books of the step."""
        if not self._slid:
            total["materials"] = {name: columns[name] for name in self.columns}
            return
        lines = self._of_parts / np.where(IS_DEPTH, 1.0, self._slid)
        total["materials"] = dict(zip(self.columns, lines.tolist(), strict=True))
        self._of_parts, self._slid = np.zeros(kernels.LINES), 0.0

    def fields(self, pressure: FloatArray) -> dict[str, FloatArray]:
        """Return the number of the material at the worn depth of both bodies' cells, 0 of the uppermost."""
        return {
            f"material_{body}": profile.material_at(self._executor.to_numpy(self._wear[body])).astype(float)
            for body, profile in self._profiles.items()
            if not profile.graded and len(profile.materials) > 1
        }
