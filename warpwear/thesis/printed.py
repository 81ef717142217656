"""What the thesis prints: its test, its wear coefficients, its patch diameters, and where each is printed.

*Modeling the Influence of Wear on the Evolution of the Coefficient of Friction*, a Master's thesis. A place
is a numbered table, figure or section of it. Kept in one table, so that no number is typed twice.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Printed:
    """One printed number: its unit, and where it stands."""

    value: float
    unit: str
    place: str
    note: str = ""


LOAD = Printed(8.0, "N", "Table 3.3")
#: One pass. The table prints the back-and-forth motion.
STROKE = Printed(30.0, "mm", "Table 3.3", "half of its back-and-forth motion of 60 mm")
PASSES = Printed(80, "1", "Table 3.3", "two for each of its 40 back-and-forth motions")
DISTANCE = Printed(2400.0, "mm", "Table 3.4")
SPHERE_RADIUS = Printed(3.0, "mm", "Table 3.1", "half of its diameter of 6 mm")

SPEEDS = tuple(Printed(speed, "mm/min", "Table 3.4") for speed in (10.0, 20.0, 50.0, 100.0))
#: Time of a test at each of these speeds.
TEST_TIMES = tuple(Printed(time, "min", "Table 3.4") for time in (240.0, 120.0, 48.0, 24.0))

#: Table 4.1: body or way of measuring -> K with the hardness contained.
WEAR_COEFFICIENTS = {
    "sphere": Printed(9.4e-4, "mm^3/N/m", "Table 4.1", "ball, scanning electron microscope"),
    "disc": Printed(12.7e-4, "mm^3/N/m", "Table 4.1", "disc, focus variation microscope"),
    "disc_confocal": Printed(23.7e-4, "mm^3/N/m", "Table 4.1", "disc, confocal microscope"),
}

#: Diameter of the worn patch on the sphere after the whole distance.
PATCH_DIAMETERS = {
    "experiment": Printed(0.80, "mm", "figure 4.36"),
    "v1": Printed(1.28, "mm", "figure 4.36"),
    "v2": Printed(1.28, "mm", "figure 4.36"),
    "v3": Printed(1.37, "mm", "figure 4.36"),
}

#: Mean pressure of version 3 at all times, least and largest.
V3_PRESSURES = (Printed(580.0, "MPa", "section 4.3.3"), Printed(600.0, "MPa", "section 4.3.3"))
#: After this distance pressure and radius of version 1 are said to change slowly.
SLOWS_AFTER = Printed(100.0, "mm", "section 4.3.1", "0.1 m")
#: Distances at which the wear of the disc is drawn.
DRAWN_AT = tuple(Printed(d, "mm", "figure 4.19") for d in (30.0, 600.0, 1200.0, 2400.0))
#: The distance that the text gives to 80 strokes in one place; its figures and tables have 2400 mm.
MISPRINTED_DISTANCE = Printed(240.0, "mm", "section 4.3.1")
