"""A body is made of materials by worn depth: layers, or a case whose numbers change gradually.

K of a depth is known, so wear is integrated over depth and not sampled: ∫ p dL = ∫ dδ / K(δ).
"""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from warpwear.grid import FloatArray

#: What the body itself is called, below its layers.
SUBSTRATE = "substrate"
#: Halvings of the range in which a worn volume is sought.
HALVINGS = 60


@dataclass(frozen=True)
class LayerMaterial:
    """A material wears by a coefficient, and bears and shears no more than it can; infinite is no limit."""

    wear: float  # K [mm²/N]
    hardness: float = math.inf  # [MPa]
    shear_strength: float = math.inf  # [MPa]
    coefficient: float = math.inf  # of its pressure, which shears it at most
    name: str = SUBSTRATE


@dataclass(frozen=True)
class DepthProfile:
    """A body's materials by worn depth; the last goes on for ever.

    depths: at which materials begin [mm], rising from 0. graded: whether K and hardness are linear between
    depths; else they are constant from one depth to the next.
    """

    depths: tuple[float, ...]
    materials: tuple[LayerMaterial, ...]
    graded: bool = False

    @property
    def least_hardness(self) -> float:
        """Return the smallest hardness at any depth [MPa]."""
        return min(material.hardness for material in self.materials)

    @property
    def fastest(self) -> float:
        """Return the largest K at any depth [mm²/N]."""
        return max(material.wear for material in self.materials)

    def fastest_above(self, depth: float) -> float:
        """Return the largest K of the unworn body and down to a depth [mm²/N]."""
        reached = [0.0, *(begin for begin in self.depths if begin <= depth), max(depth, 0.0)]
        return float(self.coefficient_at(np.array(reached)).max())

    @property
    def is_uniform(self) -> bool:
        """Tell whether the body is alike at all depths, by whichever names."""
        return len({(m.wear, m.hardness, m.shear_strength, m.coefficient) for m in self.materials}) == 1

    @property
    def scales(self) -> bool:
        """Tell whether results only scale with K: depths are lengths that do not."""
        return self.is_uniform

    @property
    def first_interface(self) -> float:
        """Return the depth down to which all numbers are those of the uppermost material [mm]."""
        if self.is_uniform:
            return math.inf
        return 0.0 if self.graded else self.depths[1]

    def _segments(self) -> Iterator[tuple[float, float, float, float]]:
        """Yield the depths of the beginning and the end of each segment, K where it begins, and dK/dδ."""
        ends = (*self.depths[1:], math.inf)
        following = (*self.materials[1:], self.materials[-1])
        for begin, end, material, below in zip(self.depths, ends, self.materials, following, strict=True):
            rises = self.graded and end < math.inf
            yield begin, end, material.wear, (below.wear - material.wear) / (end - begin) if rises else 0.0

    def material_at(self, depth: FloatArray) -> FloatArray:
        """Return the number of the material at worn depths [mm], 0 of the uppermost."""
        return np.asarray(np.searchsorted(self.depths, depth, side="right") - 1)

    def coefficient_at(self, depth: FloatArray) -> FloatArray:
        """Return K at worn depths [mm²/N]."""
        values = np.array([material.wear for material in self.materials])
        return np.asarray(self._at(values, depth))

    def hardness_at(self, depth: FloatArray) -> FloatArray:
        """Return the hardness at worn depths [MPa]."""
        return np.asarray(self._at(np.array([material.hardness for material in self.materials]), depth))

    def _at(self, values: FloatArray, depth: FloatArray) -> FloatArray:
        return np.interp(depth, self.depths, values) if self.graded else values[self.material_at(depth)]

    def lost_of_each(self, depth: FloatArray) -> FloatArray:
        """Return how much of worn depths [mm] each material has lost, of shape (materials, ...)."""
        pairs = zip(self.depths, (*self.depths[1:], math.inf), strict=True)
        return np.array([np.clip(depth, begin, end) - begin for begin, end in pairs])

    def exposure(self, depth: FloatArray) -> FloatArray:
        """Return ∫ p dL [N/mm] that wears the unworn body to depths [mm]: Σ of all cells' is F L / h²."""
        total = np.zeros(np.shape(depth))
        segments = self._segments()
        for (_, _, wear, slope), lost in zip(segments, self.lost_of_each(depth), strict=True):
            total += np.where(lost > 0.0, _exposure_through(lost, wear, slope), 0.0)
        return total

    def worn(self, depth: FloatArray, exposure: FloatArray) -> FloatArray:
        """Return the depths [mm] to which ∫ p dL [N/mm] wears a body that was worn to `depth` before.

        What wears through a material in it goes on in the next by what is left, exactly.
        """
        depth, left = (values.copy() for values in np.broadcast_arrays(depth, exposure))
        for begin, end, top, slope in self._segments():
            here = (depth < end) & (left > 0.0)
            wear = top + slope * np.where(here, depth - begin, 0.0)
            needed = _exposure_through(np.where(here, end - depth, math.inf), wear, slope)
            through, stays = here & (left >= needed), here & (left < needed)
            last = np.where(stays, left, 0.0)
            grown = wear * (np.expm1(slope * last) / slope if slope else last)
            depth = np.where(through, end, np.where(stays, depth + grown, depth))
            left = np.where(through, left - needed, np.where(stays, 0.0, left))
        return depth

    def mean_coefficient(self, deepest: float, power: float) -> float:
        """Return about V / F L [mm²/N] of a cap worn off, whose volume below a depth goes as its power.

        deepest: depth of the cap [mm]. power: 2 of a paraboloid, 3/2 of a cylinder, 1 of what is flat.
        """
        softness = 0.0
        for begin, end, top, slope in self._segments():
            if begin < deepest or begin == 0.0:
                wear = top + 0.5 * slope * (min(end, deepest) - begin)
                left = [max(1.0 - d / deepest, 0.0) if deepest else float(d == 0.0) for d in (begin, end)]
                softness += (left[0] ** power - left[1] ** power) / wear if wear else math.inf
        return 1.0 / softness

    def volume(self, load_distance: float, deepest: Callable[[float], tuple[float, float]]) -> float:
        """Return about what a cap loses [mm³] over F L [N mm], by `mean_coefficient`.

        deepest: gives for a volume [mm³] the depth of its cap [mm], and the power.
        """
        low, high = 0.0, self.fastest * load_distance
        for _ in range(HALVINGS):
            volume = 0.5 * (low + high)
            enough = volume >= self.mean_coefficient(*deepest(volume)) * load_distance
            low, high = (low, volume) if enough else (volume, high)
        return high


def _exposure_through(depth: FloatArray, wear: FloatArray | float, slope: float) -> FloatArray:
    """Return ∫ p dL [N/mm] that wears a depth [mm]. wear: K where it begins; slope: dK/dδ."""
    with np.errstate(divide="ignore", invalid="ignore"):  # K = 0 is never worn through
        if slope == 0.0:
            return np.asarray(depth / wear)
        needed = np.log1p(slope * depth / wear) / slope
    return np.where(np.asarray(wear) > 0.0, needed, math.inf)


def shears_unalike(profiles: Iterable[DepthProfile], largest: float = math.inf) -> bool:
    """Tell whether cells have a shear strength by their materials, or a part of their pressure.

    largest: shear of all cells over their pressure, infinite without such a limit.
    """
    materials = [material for profile in profiles for material in profile.materials]
    pairs = {(material.shear_strength, material.coefficient) for material in materials}
    return len(pairs) > 1 or math.isfinite(largest)


def of_materials(body: str, profile: DepthProfile) -> list[tuple[str, str, str]]:
    """Return the names of the columns of a body's layers and substrate: load share, area and worn volume."""
    if profile.graded or len(profile.materials) == 1:
        return []
    names = [f"{body}_{material.name}" for material in profile.materials]
    return [(f"load_share_{name}", f"area_{name}", f"wear_volume_{name}") for name in names]
