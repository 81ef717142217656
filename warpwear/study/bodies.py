"""[counter] and [disc]: the bodies, what they are made of, and the disc's surface."""

from functools import partial
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field

from warpwear.study.keys import Hardness, Length, LengthOrZero, Pressure, Section, key, when
from warpwear.study.materials import material
from warpwear.study.units import Number, Quantity, Range, is_pair, is_quantity, one_by_one

ROUGH = when("is_rough", otherwise="does not apply to the macro model, which has a smooth disc")
FROM_A_FILE = when("disc.synthetic", None, otherwise="does not apply to a synthetic surface")
RANDOM = when("disc.synthetic.kind", "self-affine", "milled", otherwise="does not apply to kind = '{}'")
MILLED = when("disc.synthetic.kind", "milled", otherwise="does not apply to kind = '{}'")
random_key, milled_key = partial(key, applies=RANDOM), partial(key, applies=MILLED)
file_key = partial(key, applies=ROUGH + FROM_A_FILE)


class Body(Section):
    """A body has constants of its material, each given or that of a known material."""

    material: Annotated[str, AfterValidator(lambda name: material(name).name)] | None = key(
        None, "name of a known material (see 'warpwear materials'), for constants that are not given"
    )
    young: Pressure | None = key(None, "Young's modulus")
    poisson: Annotated[float, Number(Range(or_equal=True, most=0.5))] | None = key(None, "Poisson's ratio")
    hardness: Hardness | None = key(
        None, "indentation hardness: a pressure, or a number of Vickers or Brinell, '200 HV'"
    )

    @property
    def elastic(self) -> tuple[float, float] | None:
        """Young's modulus [MPa] and Poisson's ratio, where both are known."""
        return None if self.young is None or self.poisson is None else (self.young, self.poisson)


class CounterBody(Body):
    """The section [counter] says how large the ball is and what it is made of."""

    radius: Annotated[float, Quantity("mm", Range(infinite=True))] | None = key(
        None, "radius; 'inf mm' is a rigid flat", one_of="size", must_be_said=True
    )
    diameter: Length | None = key(None, "diameter, instead of the radius", one_of="size")

    @property
    def curvature(self) -> float:
        """Curvature [1/mm]: 1/R, which is 0 for a flat."""
        if self.radius is not None:
            return 1.0 / self.radius
        assert self.diameter is not None
        return 2.0 / self.diameter


class Synthetic(Section):
    """The section [disc.synthetic] says how the disc's surface is made."""

    kind: Literal["self-affine", "milled", "flat"] = key(..., "which surface")
    ra: Length | None = random_key(None, "arithmetic mean height Ra", one_of="height", must_be_said=True)
    sq: Length | None = random_key(None, "root mean square height Sq, instead of Ra", one_of="height")
    hurst: Annotated[float, Number(Range(most=1.0))] = random_key(
        0.8, "Hurst exponent", assumed="typical of machined steel"
    )
    roll_off: Length = random_key(
        "100 um", "wavelength above which the spectrum is flat", assumed="not measured"
    )
    cut_off: Length = random_key("8 um", "shortest wavelength (λs)", assumed="profile filter λs of ISO 3274")
    seed: int = random_key(0, "seed of the random numbers", assumed="one surface of many")
    period: Length = random_key(
        "2 mm", "length after which the surface repeats", assumed="wider than the contact"
    )
    feed: Length = milled_key("0.65 mm", "milled: distance of the feed marks")
    fine_ra: LengthOrZero = milled_key(
        "0.3 um", "milled: Ra of the random part", assumed="a tenth of a common Ra"
    )
    lay: Annotated[float, Quantity("deg", Range(least=-360.0, or_equal=True, most=360.0))] = milled_key(
        "90 deg", "milled: angle between feed marks and sliding", assumed="sliding across the marks"
    )


def _pixel(value: Any) -> Any:
    value = one_by_one(value)
    return (value, value) if isinstance(value, str) or is_quantity(value) or is_pair(value) else value


def _crop(value: Any) -> Any:
    value = _pixel(value)
    if isinstance(value, list | tuple) and len(value) not in (2, 4):
        raise ValueError("needs a size, a size along x and along y, or four lengths x0, x1, y0, y1")
    return value


class Disc(Body):
    """The section [disc] says what the disc is made of and which surface it has."""

    surface: str | None = key(
        None,
        "file of a measured surface, relative to the study",
        applies=ROUGH,
        one_of="surface",
        must_be_said=True,
    )
    synthetic: Synthetic | None = key(None, "a synthetic surface instead", applies=ROUGH, one_of="surface")
    extend: Literal["refuse", "mirror", "periodic"] = file_key(
        "refuse", "when the file is smaller than the domain"
    )
    height_sign: Literal["up", "down"] = file_key("up", "down turns the file's heights over: it gives depths")
    crop: Annotated[tuple[LengthOrZero, ...], BeforeValidator(_crop)] | None = file_key(
        None, "part of the file used: x0, x1, y0, y1 from its corner, or a size around its middle"
    )
    sliding_axis: Literal["x", "y"] = file_key("x", "axis of the file along which the counter-body slides")
    outliers: Annotated[float, Number(Range(least=3.0, or_equal=True))] | None = file_key(
        None, "points farther than so many robust standard deviations from the local median are removed"
    )
    level: Literal["none", "plane", "sphere"] | Annotated[int, Field(ge=0, le=12)] = file_key(
        "plane", "form removed from the measurement: none, plane, sphere or degree of a polynomial"
    )
    s_filter: Length | None = file_key(
        None, "waves shorter than this are filtered out (Gaussian, ISO 16610-61)"
    )
    l_filter: Length | None = file_key(
        None, "waves longer than this are filtered out (Gaussian, ISO 16610-61)"
    )
    pixel: Annotated[tuple[Length, Length], BeforeValidator(_pixel)] | None = file_key(
        None, "distance of the file's points, needed by .npy; overrides what a file says"
    )
    height_unit: Literal["m", "mm", "um", "µm", "nm"] | None = file_key(
        None, "unit of the file's heights, needed by .npy; overrides what a file says"
    )
    array: str | None = file_key(None, "which array of a .npz, or measurement of a .zip, by name or number")
