"""What items of the thesis's report share: tolerances, rows of all versions, the shape of a growth."""

from warpwear.thesis_verdicts import Known, Row, number

#: Growth of the area as the square root of the distance, and how far from it still counts as that.
ROOT_EXPONENT, ROOT_LEVELLING, SHAPE_TOLERANCE = 0.5, 0.25, 0.05
#: Largest relative difference of two volumes that count as one.
SAME_VOLUME = 1e-3
#: Rounding of a printed diameter plus two cells of 10 µm [mm].
DIAMETER_TOLERANCE = 0.025
#: Rounding of a printed limit of the pressure [MPa].
PRESSURE_TOLERANCE = 5.0
#: Part of a depth below which no figure shows a difference of shape.
VISIBLE = 0.01


def of_all(quantity: str, unit: str, key: str, *, factor: float = 1.0) -> Row:
    """One quantity of the four versions."""
    columns = {"V1": "v1", "V2": "v2", "V3": "v3", "V3 fine": "fine"}
    return Row(quantity, unit, {column: f"{name}.{key}" for column, name in columns.items()}, factor=factor)


def is_root(n: Known, name: str) -> bool:
    """Whether an area grows as the square root of the distance."""
    return (
        abs(n[f"{name}.exponent_m"] - ROOT_EXPONENT) < SHAPE_TOLERANCE
        and abs(n[f"{name}.levelling_lambda"] - ROOT_LEVELLING) < SHAPE_TOLERANCE
    )


def shape_of(n: Known, name: str) -> str:
    """m and λ in words."""
    return f"m = {number(n[f'{name}.exponent_m'])}, λ = {number(n[f'{name}.levelling_lambda'])}"


#: Diameter of the worn patch: from the depths where the disc is smooth, as touched where it is rough.
SMOOTH_PATCHES = {"V1": "v1.patch_by_depth_mm", "V2": "v2.patch_by_depth_mm"}
ROUGH_PATCHES = {"V3": "v3.patch_along_mm", "V3 fine": "fine.patch_along_mm"}
