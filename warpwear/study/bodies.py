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

    material: Annotated[str, AfterValidator(lambda name: material(name).name)] | None = key(None)
    young: Pressure | None = key(None)
    poisson: Annotated[float, Number(Range(or_equal=True, most=0.5))] | None = key(None)
    hardness: Hardness | None = key(None)
    conductivity: Annotated[float, InUnit("W/m/K")] | None = key(None)
    heat_capacity: Annotated[float, InUnit("J/kg/K")] | None = key(None)
    density: Annotated[float, InUnit("kg/m^3")] | None = key(None)
    resistivity: Annotated[float, InUnit("ohm*m")] | None = joint_key()
    layers: tuple[LayerSection, ...] | None = key(None, one_of="depth", demands=LAYERED)
    gradient: Gradient | None = key(None, one_of="depth", demands=LAYERED)

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

    surface: str | None = file_key(None, is_file=True)
    extend: Literal["refuse", "mirror", "periodic"] = file_key("refuse")
    height_sign: Literal["up", "down"] = file_key("up")
    crop: Annotated[tuple[LengthOrZero, ...], BeforeValidator(_crop)] | None = file_key(None)
    sliding_axis: Literal["x", "y"] = file_key("x")
    outliers: Annotated[float, Number(Range(least=3.0, or_equal=True))] | None = file_key(None)
    level: Literal["none", "plane", "sphere", "cylinder"] | Annotated[int, Field(ge=0, le=12)] = file_key(
        "plane"
    )
    s_filter: Length | None = file_key(None)
    l_filter: Length | None = file_key(None)
    pixel: Annotated[tuple[Length, Length], BeforeValidator(_pixel)] | None = file_key(None)
    height_unit: Literal["m", "mm", "um", "µm", "nm"] | None = file_key(None)
    array: str | None = file_key(None)


class Shape(Section):
    """A counter-body has one of these shapes."""

    shape: Literal["ball", "crowned", "cylinder", "pin", "measured"] = key(
        "ball",
        demands=needs("counter.surface", of="measured")
        + needs("counter.radius_along", of="crowned")
        + needs("counter.radius_across", of="crowned"),
    )
    radius: Radius | None = key(None, applies=NOMINAL, one_of="size", must_be_said=True)
    diameter: Length | None = key(None, applies=NOMINAL, one_of="size")
    radius_along: Radius | None = key(None, applies=CROWNED)
    radius_across: Radius | None = key(None, applies=CROWNED)
    edge_radius: LengthOrZero = key("0 mm", applies=when("counter.shape", "pin"))


class CounterBody(MeasuredBody, Shape, Body):
    """The section [counter] says which shape and size the counter-body has and what it is made of."""

    FROM_A_FILE: ClassVar = when("counter.shape", "measured")

    level: Literal["none", "plane", "sphere", "cylinder"] | Annotated[int, Field(ge=0, le=12)] = file_key(
        "plane"
    )
    extend: Literal["refuse", "mirror", "periodic"] = file_key("refuse")

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

    kind: Literal["self-affine", "milled", "flat", "profile"] = key(...)
    like: str | None = like_key(None, is_file=True, one_of="profile", must_be_said=True)
    lay_length: Length | None = like_key(None)
    ra: Length | None = random_key(None, one_of="height", must_be_said=True)
    sq: Length | None = random_key(None, one_of="height")
    hurst: Annotated[float, Number(Range(most=1.0))] = random_key(0.8)
    roll_off: Length = random_key("100 um")
    cut_off: Length = periodic_key("8 um")
    seed: Annotated[int, Field(ge=0)] = periodic_key(0)
    period: Length = periodic_key("2 mm")
    feed: Length = milled_key("0.65 mm")
    fine_ra: LengthOrZero = milled_key("0.3 um")
    lay: Annotated[float, InUnit("deg", Range(least=-180.0, or_equal=True, most=180.0))] = key(
        "90 deg", applies=LAY
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
        None, applies=when("has_stresses", otherwise="does not apply without output.stress_depths")
    )
    surface: str | None = key(None, is_file=True, applies=ROUGH, one_of="surface", must_be_said=True)
    synthetic: Synthetic | None = key(None, applies=ROUGH, one_of="surface")
