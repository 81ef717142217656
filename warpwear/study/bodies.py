"""[counter] and [disc]: the bodies, what they are made of, their forms and measured surfaces."""

import math
from functools import partial
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import AfterValidator, BeforeValidator, Field, model_validator
from pydantic.functional_validators import ModelWrapValidatorHandler

from warpwear.laws.form import Form, Given, form_of
from warpwear.study.keys import Hardness, Length, LengthOrZero, Pressure, Rule, Section, key, needs, when
from warpwear.study.materials import material
from warpwear.study.sections.layers import LAYERED, MOST_LAYERS, Gradient, LayerSection
from warpwear.study.units import InUnit, Number, Range, is_pair, is_quantity, one_by_one

ROUGH = when("is_rough", otherwise="does not apply to the macro model, which has a smooth disc")
NO_KIND = "does not apply to kind = '{}'"
RANDOM = when("disc.synthetic.kind", "self-affine", "milled", otherwise=NO_KIND)
PERIODIC = when("disc.synthetic.kind", "self-affine", "milled", "profile", otherwise=NO_KIND)
LIKE = when("disc.synthetic.kind", "profile", otherwise=NO_KIND)
LAY = when("disc.synthetic.kind", "milled", "profile", otherwise=NO_KIND)
MILLED = when("disc.synthetic.kind", "milled", otherwise=NO_KIND)
CROWNED = when("counter.shape", "crowned")
NOMINAL = when(
    "counter.has_radius",
    otherwise="does not apply to a crowned body, nor to a measured one whose level is no sphere or cylinder",
)
random_key, milled_key = partial(key, applies=RANDOM), partial(key, applies=MILLED)
periodic_key, like_key = partial(key, applies=PERIODIC), partial(key, applies=LIKE)
file_key = partial(key, applies="FROM_A_FILE")
#: Constants that say how hot a contact gets, and nothing else; all that a body has of its material.
HEAT = ("conductivity", "heat_capacity", "density")
CONSTANTS = ("young", "poisson", "hardness", *HEAT, "resistivity")
joint_key = partial(key, None, applies=when("output.joint", otherwise="does not apply without output.joint"))
Radius = Annotated[float, InUnit("mm", Range(infinite=True))]


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
    conductivity: Annotated[float, InUnit("W/m/K")] | None = key(None, "thermal conductivity")
    heat_capacity: Annotated[float, InUnit("J/kg/K")] | None = key(None, "heat capacity of a mass")
    density: Annotated[float, InUnit("kg/m^3")] | None = key(None, "density")
    resistivity: Annotated[float, InUnit("ohm*m")] | None = joint_key("electrical resistivity")
    layers: tuple[LayerSection, ...] | None = key(
        None,
        "layers over the body, from the surface down; its own keys are those of the substrate below them",
        one_of="depth",
        demands=LAYERED,
    )
    gradient: Gradient | None = key(
        None,
        "numbers by worn depth: a file of comma-separated columns, or its rows: depth in µm, K in mm^3/N/m "
        "(wear.law = 'energy': mm^3/J) and hardness in MPa, or none; linear between rows, constant below the "
        "last, which is the body itself",
        one_of="depth",
        demands=LAYERED,
    )

    def _check(self) -> None:
        """Refuse layers of one name, and too many."""
        names = [layer.name for layer in self.layers or ()]
        if self.layers is not None and len({*names}) != max(len(names), 1):
            raise ValueError(f"layers: names must differ, and there must be one or more, not {names}")
        if len(names) > MOST_LAYERS:
            raise ValueError(f"layers: {len(names)} are too many; allowed are {MOST_LAYERS}, or a gradient")

    @model_validator(mode="wrap")
    @classmethod
    def _with_constants(cls, values: Any, validated: ModelWrapValidatorHandler[Self]) -> Self:
        """Fill in constants of the material, which do not count as given."""
        body = validated(values)
        known = {} if body.material is None else vars(material(body.material))
        constants = {name: known[name] for name in CONSTANTS if known and getattr(body, name) is None}
        return cls.model_construct(body.model_fields_set, **dict(body) | constants) if constants else body

    @property
    def has_depths(self) -> bool:
        """True where its numbers differ by worn depth."""
        return bool(self.layers or self.gradient)

    @property
    def elastic(self) -> tuple[float, float] | None:
        """Young's modulus [MPa] and Poisson's ratio, where both are known."""
        return None if self.young is None or self.poisson is None else (self.young, self.poisson)


def _pixel(value: Any) -> Any:
    value = one_by_one(value)
    return (value, value) if isinstance(value, str) or is_quantity(value) or is_pair(value) else value


def _crop(value: Any) -> Any:
    value = _pixel(value)
    if isinstance(value, list | tuple) and len(value) not in (2, 4):
        raise ValueError("needs a size, a size along x and along y, or four lengths x0, x1, y0, y1")
    return value


class MeasuredBody(Section):
    """A body may be measured; `FROM_A_FILE` says when its file is read."""

    FROM_A_FILE: ClassVar[tuple[Rule, ...]] = ()

    surface: str | None = file_key(None, "file of a measured surface, relative to the study", is_file=True)
    extend: Literal["refuse", "mirror", "periodic"] = file_key(
        "refuse", "when the file is smaller than the domain"
    )
    height_sign: Literal["up", "down"] = file_key("up", "down turns the file's heights over: it gives depths")
    crop: Annotated[tuple[LengthOrZero, ...], BeforeValidator(_crop)] | None = file_key(
        None, "part of the file used: x0, x1, y0, y1 from its corner, or a size around its middle"
    )
    sliding_axis: Literal["x", "y"] = file_key("x", "axis of the file that lies along sliding")
    outliers: Annotated[float, Number(Range(least=3.0, or_equal=True))] | None = file_key(
        None, "points farther than so many robust standard deviations from the local median are removed"
    )
    level: Literal["none", "plane", "sphere", "cylinder"] | Annotated[int, Field(ge=0, le=12)] = file_key(
        "plane", "form removed from the measurement: none, plane, sphere, cylinder or degree of a polynomial"
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
    array: str | None = file_key(
        None, "which array, channel, column or measurement of a file with several, by name or number"
    )


class Shape(Section):
    """A counter-body has one of these shapes."""

    shape: Literal["ball", "crowned", "cylinder", "pin", "measured"] = key(
        "ball",
        "ball; crowned: a paraboloid of two radii; cylinder: a parabola of counter.radius along sliding, its "
        "axis across it, as long as the domain; pin: a flat round face with an edge; measured: a file, seen "
        "as by an instrument from outside and turned over about the direction of sliding",
        demands=needs("counter.surface", of="measured")
        + needs("counter.radius_along", of="crowned")
        + needs("counter.radius_across", of="crowned"),
    )
    radius: Radius | None = key(
        None,
        "radius of the ball ('inf mm' is a rigid flat), of the cylinder, of the pin's flat face, or of the "
        "nominal form that a measured body's level puts back",
        applies=NOMINAL,
        one_of="size",
        must_be_said=True,
    )
    diameter: Length | None = key(None, "diameter, instead of the radius", applies=NOMINAL, one_of="size")
    radius_along: Radius | None = key(
        None, "radius of the section along sliding; inf: a cylinder that lies along it", applies=CROWNED
    )
    radius_across: Radius | None = key(
        None, "radius of the section across sliding; inf: a cylinder that lies across it", applies=CROWNED
    )
    edge_radius: LengthOrZero = key(
        "0 mm", "radius of the edge around the pin's face; 0 is sharp", applies=when("counter.shape", "pin")
    )


class CounterBody(MeasuredBody, Shape, Body):
    """The section [counter] says which shape and size the counter-body has and what it is made of."""

    FROM_A_FILE: ClassVar = when("counter.shape", "measured")

    level: Literal["none", "plane", "sphere", "cylinder"] | Annotated[int, Field(ge=0, le=12)] = file_key(
        "plane",
        "what is not the body's own in the measurement: none; plane, a tilt; sphere, cylinder (axis across "
        "sliding): the fitted form, so that roughness is left, and the form of counter.radius is put back; a "
        "degree: a polynomial, so that a rough flat is left",
    )
    extend: Literal["refuse", "mirror", "periodic"] = file_key(
        "refuse",
        "beyond the file; other than refuse: the body goes on beyond the domain too, whose edge the contact "
        "may then reach, as under a flat",
    )

    @property
    def has_radius(self) -> bool:
        """True where one radius says how large the body is."""
        measured = self.shape == "measured" and self.level in ("sphere", "cylinder")
        return measured or self.shape in ("ball", "cylinder", "pin")

    @property
    def nominal_radius(self) -> float:
        """The radius [mm], by whichever key; infinite where none plays a part."""
        if not self.has_radius:
            return math.inf
        return self.radius if self.radius is not None else 0.5 * (self.diameter or math.inf)

    @property
    def has_hertz(self) -> bool:
        """True where Hertz knows the contact: of a ball, a crowned body or a cylinder."""
        return self.shape in ("ball", "crowned", "cylinder") and not self.form.is_flat

    @property
    def has_approach(self) -> bool:
        """True where Hertz's approach is known too: not of a line."""
        return self.has_hertz and all(self.form.rises)

    @property
    def form(self) -> Form:
        """The unworn form; of a measured body its nominal one, whose heights `study.surface` reads."""
        if self.shape == "measured":
            one = 1.0 / self.nominal_radius
            return Given(one, one if self.level == "sphere" else 0.0, goes_on=self.extend != "refuse")
        return form_of(
            self.shape,
            radius=self.nominal_radius,
            radius_along=self.radius_along or math.inf,
            radius_across=self.radius_across or math.inf,
            edge_radius=self.edge_radius,
        )

    @property
    def name(self) -> str:
        """What figures and pages call it: ball, flat or counter-body."""
        return "flat" if self.form.is_flat else "ball" if self.shape == "ball" else "counter-body"

    @property
    def title(self) -> str:
        """What it is, for a sentence: 'ball of 3 mm radius'."""
        radius = f"{self.nominal_radius:.4g} mm radius"
        if self.form.is_flat and self.shape != "measured":
            return "rigid flat"
        if self.shape == "crowned":
            return f"crowned body of {self.radius_along:.4g} × {self.radius_across:.4g} mm radius"
        edge = f", {self.edge_radius:.4g} mm at the edge" if self.edge_radius else ""
        of = {"pin": f"flat pin of {radius}{edge}", "measured": "measured counter-body"}
        return of.get(self.shape, f"{self.shape} of {radius}")


class Synthetic(Section):
    """The section [disc.synthetic] says how the disc's surface is made."""

    kind: Literal["self-affine", "milled", "flat", "profile"] = key(
        ..., "which surface; with like, 'profile' may be left out"
    )
    like: str | None = like_key(
        None,
        "file of a profile, relative to the study: the surface gets its spectrum and heights",
        is_file=True,
        one_of="profile",
        must_be_said=True,
    )
    lay_length: Length | None = like_key(
        None, "like a profile: length over which heights stay alike along the lay; without, there is none"
    )
    ra: Length | None = random_key(None, "arithmetic mean height Ra", one_of="height", must_be_said=True)
    sq: Length | None = random_key(None, "root mean square height Sq, instead of Ra", one_of="height")
    hurst: Annotated[float, Number(Range(most=1.0))] = random_key(
        0.8, "Hurst exponent", assumed="typical of machined steel"
    )
    roll_off: Length = random_key(
        "100 um", "wavelength above which the spectrum is flat", assumed="not measured"
    )
    cut_off: Length = periodic_key(
        "8 um", "shortest wavelength (λs)", assumed="profile filter λs of ISO 3274"
    )
    seed: Annotated[int, Field(ge=0)] = periodic_key(
        0, "seed of the random numbers", assumed="one surface of many"
    )
    period: Length = periodic_key(
        "2 mm", "length after which the surface repeats", assumed="wider than the contact"
    )
    feed: Length = milled_key("0.65 mm", "milled: distance of the feed marks")
    fine_ra: LengthOrZero = milled_key(
        "0.3 um", "milled: Ra of the random part", assumed="a tenth of a common Ra"
    )
    lay: Annotated[float, InUnit("deg", Range(least=-180.0, or_equal=True, most=180.0))] = key(
        "90 deg", "angle between feed marks and sliding", applies=LAY, assumed="sliding across the marks"
    )

    @model_validator(mode="before")
    @classmethod
    def _like_a_profile(cls, values: Any) -> Any:
        """Take the kind of a surface like a profile as said."""
        return {"kind": "profile", **values} if isinstance(values, dict) and "like" in values else values


class Disc(MeasuredBody, Body):
    """The section [disc] says what the disc is made of and which surface it has."""

    FROM_A_FILE: ClassVar = ROUGH + when(
        "disc.synthetic", None, otherwise="does not apply to a synthetic surface"
    )

    yield_strength: Pressure | None = key(
        None,
        "stress at which the disc yields in tension, for the stresses below its surface; by default a third "
        "of its hardness",
        applies=when("has_stresses", otherwise="does not apply without output.stress_depths"),
    )
    surface: str | None = key(
        None,
        "file of a measured surface, relative to the study",
        is_file=True,
        applies=ROUGH,
        one_of="surface",
        must_be_said=True,
    )
    synthetic: Synthetic | None = key(None, "a synthetic surface instead", applies=ROUGH, one_of="surface")
