"""The table at the top of the report of the thesis: each row with a verdict of its own numbers."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from warpwear.thesis.findings import FINDINGS
from warpwear.thesis.items_compared import TABLE as COMPARED
from warpwear.thesis.items_v1 import TABLE as V1
from warpwear.thesis.items_v2_v3 import TABLE as V2_V3
from warpwear.thesis.printed import V3_PRESSURES, Printed
from warpwear.thesis.verdicts import (
    DIAMETER_TOLERANCE,
    PRESSURE_TOLERANCE,
    ROUGH_PATCHES,
    SMOOTH_PATCHES,
    Item,
    Kind,
    Row,
    of_all,
    patches,
)


@dataclass(frozen=True)
class Line:
    """A row of the table and where more is said of it.

    item: id of a figure or a finding. tolerance: largest difference, in the row's unit, of a printed and one
    of our numbers that agree.
    """

    row: Row
    item: str
    tolerance: float = 0.0

    def judge(self, numbers: Mapping[str, float]) -> Kind | None:
        """Judge whether ours are what is printed; None where nothing is.

        A column 'thesis V1' stands beside our V1, the experiment's beside all of ours.
        """
        pairs = [
            (self.row.factor * printed.value, self.row.factor * numbers.get(name, math.nan))
            for column, printed in self.row.printed.items()
            for version, name in self.row.ours.items()
            if column in (f"thesis {version}", "experiment")
        ]
        if not pairs:
            return None
        if not all(math.isfinite(ours) for _, ours in pairs):
            return Kind.NOT_COMPARABLE
        near = all(abs(ours - printed) <= self.tolerance for printed, ours in pairs)
        return Kind.AGREES if near else Kind.DISAGREES


def _patch(which: str, ours: dict[str, str], printed: tuple[str, ...], item: str) -> Line:
    """Declare diameters of the worn patch. printed: versions, or the experiment; item: where more is said."""
    row = Row(f"worn patch of the sphere, {which}", "mm", ours, patches(*printed))
    return Line(row, item, DIAMETER_TOLERANCE)


def _pressure(which: str, name: str, printed: Printed) -> Line:
    """Declare a limit of the mean pressure of V3. name: of our number."""
    row = Row(f"mean pressure of V3, {which} of all steps", "MPa", {"V3": name}, {"thesis V3": printed})
    return Line(row, "figure-4.30", PRESSURE_TOLERANCE)


SUMMARY: tuple[Line, ...] = (
    _patch("smooth: diameter", SMOOTH_PATCHES, ("v1", "v2"), "figure-4.32"),
    _patch("rough: along sliding", ROUGH_PATCHES, ("v3",), "figure-4.32"),
    _patch("models beside the experiment", SMOOTH_PATCHES | ROUGH_PATCHES, ("experiment",), "figure-4.36"),
    Line(of_all("deepest wear of the sphere", "µm", "sphere_depth_um"), "figure-A.9"),
    Line(of_all("deepest wear of the disc", "µm", "disc_depth_um"), "figure-4.35"),
    Line(of_all("worn volume of the sphere", "mm³", "sphere_volume_mm3"), "figure-4.21"),
    Line(of_all("worn volume of the disc", "mm³", "disc_volume_mm3"), "figure-4.33"),
    Line(of_all("area in contact, start", "mm²", "area_first_mm2"), "figure-A.8"),
    Line(of_all("area in contact, 30 mm", "mm²", "area_30_mm2"), "cure"),
    Line(of_all("area in contact, end", "mm²", "area_end_mm2"), "cure"),
    Line(of_all("mean pressure, end", "MPa", "pressure_end_MPa"), "figure-4.17"),
    _pressure("smallest", "v3.pressure_smallest_MPa", V3_PRESSURES[0]),
    _pressure("largest", "v3.pressure_largest_MPa", V3_PRESSURES[1]),
    Line(of_all("coefficient of friction, end", "–", "cof_end"), "figure-4.34"),
    Line(of_all("coefficient of friction, start over end", "–", "cof_first_over_end"), "figure-4.37"),
    Line(of_all("exponent m of the area in contact", "–", "exponent_m"), "cure"),
)


#: Figures and tables of the thesis.
OF_THESIS: tuple[Item, ...] = tuple(entry for table in (V1, V2_V3, COMPARED) for entry in table.items)
#: Figures and tables of the thesis, then statements of our own.
ALL_ITEMS: tuple[Item, ...] = (*OF_THESIS, *FINDINGS.items)
