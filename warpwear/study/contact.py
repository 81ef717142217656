"""[contact], [wear], [friction] and [junctions]: the laws of what touches."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from numbers import Real
from types import MappingProxyType
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, GetCoreSchemaHandler, PlainSerializer, PlainValidator
from pydantic_core import CoreSchema, core_schema

from warpwear.laws.archard import BODIES, COEFFICIENTS, WEAR_LAWS, WearLaw
from warpwear.laws.elastic import MATCHES
from warpwear.laws.friction import COEFFICIENT, FRICTION_LAWS, KEYS, FrictionLaw
from warpwear.study.keys import (
    Demand,
    Length,
    Pressure,
    Section,
    excludes,
    key,
    needs,
    needs_compliance,
    when,
)
from warpwear.study.units import NOT_NEGATIVE, Number, Quantity, Range, parse, text

#: K_N plays a part in the macro model, and in the two-scale model where it is the bulk behind the patches.
BULK = when("study.model", "macro", "two-scale", otherwise="does not apply to the micro model")
BULK += when("uses_bulk_stiffness", otherwise="does not apply to patches.bulk = 'none'")
ROUGH = when(
    "study.model",
    "micro",
    "two-scale",
    otherwise="does not apply to the {} model: its K_N is contact.bulk_stiffness",
)
LOCAL = when("contact.law", "local", otherwise="does not apply to contact.law = '{}': E* of both bodies does")
AT_REST = when(
    "kinematics",
    "stationary",
    otherwise="does not apply to sliding.kinematics = '{}', where a cell slides while the contact is over it",
)
FITTED = when("friction.shear_strength", None, otherwise="does not apply with a friction.shear_strength")
SHEARS = when("friction.law", "shear-strength")
SHEDS = when("wear.sheds", otherwise="does not apply without a wear.particle: all wear leaves at once")
shed_key = partial(key, applies=SHEDS)
running_in_key = partial(key, applies=when("wear.law", "running-in"))
UNCHANGED: Mapping[str, Any] = MappingProxyType({})
#: The sentence's words for what E* follows from.
ELASTIC = (
    "Young's modulus and Poisson's ratio of both bodies: counter.material or counter.young and "
    "counter.poisson, and the same of the disc"
)
#: Shapes that Hertz knows.
ROUND = "a ball, a crowned body or a cylinder"
#: The sentence's end where a stiffness is allowed instead.
A_STIFFNESS = "; or a stiffness such as '2e6 N/mm^3'"
THICKNESS = (
    "wear.particle_thickness, such as '0.6 um': measure it as 4 times Rq of the worn counter-body along "
    "sliding, or on flakes in the SEM"
)
CRITICAL = (
    "junctions.surface_energy, such as '2 J/m^2', and of the softer body Young's modulus, Poisson's ratio "
    "and hardness; or give a diameter, such as '20 um'"
)
NOT_BY_AREA = (
    ": by a shear strength all cells that touch would wear alike, whatever their pressure, which no contact "
    "here is solved with"
)
IN_ONE_PROPORTION = ", which keeps what counter-body and disc wear in one proportion"


def no_cell_by_cell(why: str, of: tuple[str, ...] = ()) -> tuple[Demand, ...]:
    """Return the demand that neither a film nor growing junctions give each cell its own shear strength."""
    return excludes("friction.film", of=of, why=why) + excludes("friction.junction_growth", of=of, why=why)


fitted_key = partial(
    key,
    one_of="strength: measured",
    demands=no_cell_by_cell(", which needs friction.shear_strength itself"),
)
BARE_STRENGTH = needs(
    "friction.shear_strength",
    what="friction.shear_strength, the interfacial shear strength of bare metal, such as '172 MPa'",
)
NO_BEARING_CURVE = excludes("wear.law", "bearing-curve", why=", where a share of a cell touches")
NOT_CONTACT = ("touched", "cumulative", "nominal")


class LineLoad(float):
    """A load [N] that was given as one of a length [N/mm] is that times the length it acts on [mm]."""

    per_length: float

    def __new__(cls, per_length: float, length: float = 1.0) -> Self:
        load = super().__new__(cls, per_length * length)
        load.per_length = per_length
        return load

    def __getnewargs__(self) -> tuple[float, float]:  # type: ignore[override]
        return self.per_length, float(self) / self.per_length


@dataclass(frozen=True)
class Load(Quantity):
    """This annotates a load: a force, or a force of a length, which is times a length known later."""

    def read(self, value: Any) -> Any:
        """Return the load [N], or a `LineLoad`. Raises ValueError, saying what is allowed."""
        if isinstance(value, LineLoad):
            return value
        try:
            return super().read(value)
        except ValueError as refused:
            if "dimension" not in str(refused):
                raise
            try:
                return LineLoad(float(Quantity("N/mm").read(value)))
            except ValueError as error:
                either = ValueError(f"{refused}, or of a line contact one of its length, '18.5 N/mm'")
                raise (either if "dimension" in str(error) else error) from None

    def write(self, value: Any) -> str:
        """Return text that `read` reads back without loss."""
        return text(value.per_length, "N/mm") if isinstance(value, LineLoad) else text(value, self.unit)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_wrap_validator_function(
            lambda value, _: self.read(value),
            handler(source),
            serialization=core_schema.plain_serializer_function_ser_schema(self.write),
        )


class Contact(Section):
    """The section [contact] says what is pressed, and by which law cells yield."""

    load: Annotated[float, Load("N")] = key(
        ..., "normal load; of a line contact also a load of its length, '18.5 N/mm', times grid.extent across"
    )
    hardness: Annotated[float, Quantity("MPa", Range(infinite=True), hardness=True)] | None = key(
        None,
        "largest pressure of a cell, inf for no limit; by default the softer body's, in the macro model none",
        demands=needs_compliance(math.inf),
    )
    law: Literal["local", "half-space"] = key(
        "local",
        "under a largest pressure; local: every cell by itself; half-space: elastic bodies, whose "
        "asperities feel each other",
        former_value=("foundation", "local"),
        demands=needs("study.model", "micro", "two-scale", of="half-space")
        + needs("effective_modulus", of="half-space", what=ELASTIC)
        + needs("stepping.scheme", "implicit", of="half-space"),
    )
    boundary: Literal["free", "periodic", "line"] | None = key(
        None,
        "half-space: nothing beyond the domain (two-scale model: beyond each patch), or it is repeated; "
        "line: repeated across sliding, with nothing beyond its ends along it; "
        "if not given free under a counter-body, periodic under a flat and for patches",
        assumed="nothing beyond the domain under a counter-body; under a flat the domain is repeated, and in "
        "the two-scale model each patch",
        applies=when("contact.law", "half-space"),
    )
    stiffness: Annotated[float, Quantity("N/mm^3", Range(infinite=True))] = key(
        "inf N/mm^3",
        "micro and two-scale model: local foundation stiffness k",
        assumed="asperities do not deform elastically",
        applies=ROUGH + LOCAL,
    )
    bulk_stiffness: Annotated[
        float | Literal["area", "pressure", "approach"], Quantity("N/mm^3", words=tuple(MATCHES))
    ] = key(
        "area",
        "macro model, bulk of the two-scale: stiffness K_N that gives Hertz's area, peak pressure or "
        "approach, or a stiffness",
        assumed="one spring constant matches one of Hertz's three values",
        applies=BULK,
        formerly="contact.foundation",
        demands=needs("counter.has_hertz", of=tuple(MATCHES), what=ROUND, why=A_STIFFNESS)
        + needs("counter.has_approach", of="approach", what="a ball or a crowned body", why=A_STIFFNESS)
        + needs("effective_modulus", of=tuple(MATCHES), what=ELASTIC, why=A_STIFFNESS),
    )
    bulk_update: Literal["initial", "updated"] = key(
        "initial",
        "K_N = C_W E*/a with Hertz's a for ever, or with that of the area in contact (two-scale: scar)",
        applies=BULK,
        formerly="contact.foundation_update",
        demands=needs("contact.bulk_stiffness", *MATCHES, of="updated")
        + needs("counter.has_approach", of="updated", what="a ball or a crowned body"),
    )


@dataclass(frozen=True)
class ArchardCoefficient:
    """A wear coefficient is K of V = K F L [mm³/(N·m)], k of V = k F L / H, a bare number, or α [mm³/J]."""

    unit: ClassVar[str] = "mm^3/N/m"
    of_energy: ClassVar[str] = "mm^3/J"
    range: ClassVar[Range] = NOT_NEGATIVE

    value: float
    dimensionless: bool = False
    #: Whether it is volume over friction energy. A joule is a newton metre: units alone do not tell.
    per_energy: bool = False

    @classmethod
    def read(cls, quantity: Any) -> Self:
        """Return the coefficient of a quantity, or of a bare number. Raises ValueError."""
        if isinstance(quantity, cls):
            return quantity
        bare = isinstance(quantity, Real) and not isinstance(quantity, bool)
        value = Number(cls.range).read(quantity) if bare else parse(quantity, cls.unit)
        return cls(cls.range.check(value), bare, not bare and "J" in str(quantity).replace("joule", "J"))

    def write(self) -> str | float:
        """Return what `read` reads back: text with a unit, or a bare number."""
        unit = self.of_energy if self.per_energy else self.unit
        return self.value if self.dimensionless else text(self.value, unit)

    def resolved(self, hardness: float, friction: Any = math.nan) -> Any:
        """Return K [mm²/N] (thesis eqs 4.12 and 4.13). hardness: H of V = k F L / H [MPa].

        friction: coefficient μ, of K = α μ.
        """
        if self.per_energy:
            return 1.0e-3 * (self.value * friction)
        return self.value / hardness if self.dimensionless else 1.0e-3 * self.value


WearCoefficient = Annotated[
    ArchardCoefficient, PlainValidator(ArchardCoefficient.read), PlainSerializer(ArchardCoefficient.write)
]


class Wear(Section):
    """The section [wear] says what each body loses."""

    counter: WearCoefficient = key(
        ...,
        'wear coefficient K of the counter-body, such as "2e-6 mm^3/N/m"; 0 where it does not wear; without '
        "a unit k = K H, H as of the disc",
        formerly="wear.sphere",
    )
    disc: WearCoefficient = key(
        ...,
        'wear coefficient K of the disc, such as "2e-6 mm^3/N/m"; 0 where it does not wear; without a unit '
        "k = K H, with contact.hardness or else the softer body's for both bodies",
    )
    law: Literal["archard", "exponential", "running-in", "bearing-curve", "energy"] = key(
        "archard",
        "depth = K × pressure × distance, K constant or by an empirical law of the distance slid; energy: "
        "depth = α × friction energy of an area, with counter and disc in mm^3/J",
        demands=needs("wear.decay", of="exponential")
        + needs("wear.running_in", of="running-in")
        + needs("wear.starts_apart", of="running-in", what="wear.initial_counter or wear.initial_disc")
        + needs("study.model", "macro", of="bearing-curve", why=": the other models resolve the roughness")
        + needs("stepping.scheme", "implicit", of="bearing-curve")
        + excludes("study.model", "two-scale", of="running-in", why=IN_ONE_PROPORTION)
        + needs("friction.law", "coulomb", of="energy", why=NOT_BY_AREA),
    )
    decay: Annotated[float, Quantity("1/mm")] | None = key(
        None,
        "exponential: α of V = K F (1 − e^(−αL))/α, an empirical fit",
        applies=when("wear.law", "exponential"),
    )
    running_in: Length | None = running_in_key(
        None, "running-in: L0 of K + (K0 − K) e^(−L/L0), an empirical fit"
    )
    initial_counter: WearCoefficient | None = running_in_key(
        None,
        "running-in: K0 of the counter-body; K if not given",
        formerly="wear.initial_sphere",
    )
    initial_disc: WearCoefficient | None = running_in_key(None, "running-in: K0 of the disc; K if not given")
    distance_factor: Literal["none", "across", "radial"] = key(
        "none",
        "shorter sliding distance of disc cells beside the middle, √(1 − d²/R²): d across or radial",
        applies=AT_REST,
        demands=excludes("study.model", "two-scale", of=("across", "radial"), why=IN_ONE_PROPORTION)
        + excludes("contact.law", "half-space", of=("across", "radial"))
        + needs("counter.shape", "ball", of=("across", "radial"))
        + excludes("wear.particle", of=("across", "radial")),
    )
    particle: Annotated[float | Literal["critical"], Quantity("mm", words=("critical",))] | None = key(
        None,
        "diameter d* of the pieces in which worn volume leaves; critical: that of thesis eq 2.3, see "
        "[junctions]; if not given, it leaves at once, as dust",
        demands=needs("wear.particle_thickness", what=THICKNESS)
        + needs("study.model", "micro", why=": patches would cut pieces, and smooth bodies have none")
        + needs("critical_junction", of="critical", what=CRITICAL),
    )
    particle_thickness: Length | None = shed_key(
        None,
        "thickness t of a piece at its middle: 4 Rq of profiles of the worn counter-body along sliding, form "
        "removed, or of flakes in SEM",
    )
    dust_fraction: Annotated[float, Number(Range(or_equal=True, most=1.0))] = shed_key(
        0.0,
        "share of the worn volume that leaves at once beside the pieces",
        assumed="wear in pieces alone; a few per cent change the course",
    )
    pending_start: Literal["zero", "uniform"] = shed_key(
        "zero",
        "volume that pieces have gathered before the test: none, or drawn, so that they are at every stage",
        assumed="unworn bodies: the first pieces take a while",
    )
    pending_seed: Annotated[int, Field(ge=0, strict=True)] = key(
        0, "seed of the uniform start", applies=SHEDS + when("wear.pending_start", "uniform")
    )

    @property
    def sheds(self) -> bool:
        """True where worn volume leaves in pieces."""
        return self.particle is not None

    @property
    def unit(self) -> str:
        """Give the unit that coefficients have under the law."""
        return ArchardCoefficient.of_energy if self.law == "energy" else ArchardCoefficient.unit

    def laws(
        self, hardness: float, friction: float, values: Mapping[str, Any] = UNCHANGED
    ) -> tuple[WearLaw, WearLaw]:
        """Return the laws of counter-body and disc. hardness: H of V = k F L / H [MPa].

        friction: coefficient, of the energy law. values: dotted keys -> numbers, or arrays of them, in the
        keys' units, that replace those of the study.
        """
        friction = values.get(f"friction.{COEFFICIENT}", friction)

        def number(key: str) -> Any:
            value = values.get(f"wear.{key}")
            if value is None:
                value = getattr(self, key)
            elif key in COEFFICIENTS:
                value = ArchardCoefficient(value, per_energy=self.law == "energy")
            return value.resolved(hardness, friction) if isinstance(value, ArchardCoefficient) else value

        counter, disc = (WEAR_LAWS[self.law].of(body, number) for body in BODIES)
        return counter, disc

    @property
    def starts_apart(self) -> bool:
        """True where a body runs in, from a coefficient of its own."""
        return self.initial_counter is not None or self.initial_disc is not None

    @property
    def per_energy(self) -> dict[str, float]:
        """Map a body to its coefficient α of the energy law [mm³/J]."""
        return {body: getattr(self, body).value for body in BODIES}

    def _check(self) -> None:
        for name in sorted(COEFFICIENTS):
            value, other = getattr(self, name), "the energy of friction" if self.law == "energy" else "load"
            if value and value.value and value.per_energy != (self.law == "energy"):
                raise ValueError(
                    f"wear.{name} = '{value.write()}' does not go with wear.law = '{self.law}', which wears "
                    f"by {other}: its unit is {self.unit}"
                )


class FilmSection(Section):
    """The section [friction.film] says what covers the bodies until it is worn off."""

    thickness: Length = key(..., "wear depth beyond which a body's cell has lost its film, such as '10 nm'")
    shear_strength: Pressure = key(
        ..., "interfacial shear strength of a cell with a film; friction.shear_strength is that of a bare one"
    )
    bodies: Literal["both", "counter", "disc"] = key(
        "both",
        "bodies that carry a film; a cell of the contact is bare where all of them have lost it",
        assumed="oxide on both metals",
        former_value=("sphere", "counter"),
    )
    regrowth: Annotated[float | Literal["never"], Quantity("mm", words=("never",))] = key(
        "never",
        "sliding distance without wear of a body's cell after which its film is whole again",
        assumed="the film does not form anew during the test",
    )


class Friction(Section):
    """The section [friction] says what fixes the coefficient of friction."""

    law: Literal["shear-strength", "coulomb"] = key(
        "shear-strength",
        "the coefficient is τ0 × area / load, and ploughing; coulomb: it is friction.coefficient at every "
        "distance, ploughing included",
    )
    shear_strength: Pressure | None = key(
        None,
        "interfacial shear strength τ0",
        one_of="strength",
        demands=excludes("friction.law", "coulomb", why=", a coefficient alone"),
    )
    coefficient: Annotated[float, Number(Range(most=3.0))] = fitted_key(
        0.6,
        "measured coefficient that fixes τ0, instead; coulomb: the coefficient μ",
        assumed="for want of a measured one",
        applies=FITTED,
    )
    calibrate: Literal["end", "initial"] = fitted_key(
        "end", "when the measured coefficient holds", applies=SHEARS + FITTED
    )
    ploughing: Annotated[float, Number(Range(or_equal=True, most=3.0))] = key(
        0.0, "part μ_p of the coefficient that does not shear", applies=SHEARS
    )
    initial_ratio: Annotated[float, Number(Range(or_equal=True, most=1000.0))] | None = key(
        None,
        "running-in: τ at the start over τ0, with τ0 (1 + (ratio − 1) e^(−L/L_τ)); an empirical fit",
        applies=SHEARS,
        demands=needs("friction.running_in")
        + no_cell_by_cell(": a shear strength that runs in by a fit would be counted twice"),
    )
    running_in: Length | None = key(
        None,
        "running-in: L_τ of the shear strength",
        applies=SHEARS,
        demands=needs("friction.initial_ratio"),
    )
    area: Literal["contact", "touched", "cumulative", "nominal"] = key(
        "contact",
        "area that shears",
        applies=SHEARS,
        demands=no_cell_by_cell(", which shears the cells in contact", of=NOT_CONTACT),
    )
    junction_growth: Annotated[float, Number(Range(or_equal=True, most=100.0))] = key(
        0.0,
        "α of the cap √(H² − α τ²) of a cell under shear: junctions grow (Tabor: 9 to 27); 0 is none",
        demands=BARE_STRENGTH
        + NO_BEARING_CURVE
        + needs("caps_pressure", what="a finite contact.hardness", why=", which it lowers"),
    )
    film: FilmSection | None = key(None, "a film that wear breaks", demands=BARE_STRENGTH + NO_BEARING_CURVE)

    @property
    def fitted(self) -> Literal["end", "initial", "coulomb"] | None:
        """Where the coefficient is an input, to which τ0 is fitted, or all of it; None where τ0 is given."""
        if self.law == "coulomb":
            return self.law
        return self.calibrate if self.shear_strength is None else None

    @property
    def ends_as_given(self) -> bool:
        """True where the coefficient at the end is an input."""
        return self.fitted in ("end", "coulomb")

    def law_with(self, values: Mapping[str, Any] = UNCHANGED) -> FrictionLaw:
        """Return the law by which friction follows from a history. values: as of `Wear.laws`."""
        own = {key: value_in(self, key) for key in KEYS}
        numbers = {key: values.get(f"friction.{key}", value) for key, value in own.items()}
        return FRICTION_LAWS[self.law](numbers)

    @property
    def limit(self) -> str:
        """Formula of the shear stress that a body of hardness H bears."""
        return "H/√α" if self.junction_growth else "H/(3√3)"

    def _check(self) -> None:
        if self.fitted in ("end", "initial") and self.coefficient <= self.ploughing:
            raise ValueError(
                f"friction.coefficient = {self.coefficient:g} must exceed friction.ploughing = "
                f"{self.ploughing:g}"
            )


def value_in(section: Any, key: str) -> Any:
    """Return the value of a dotted key of a study or a section; None where a section is not there."""
    for name in key.split("."):
        section = getattr(section, name, None)
    return section


class Junctions(Section):
    """The section [junctions] says what the critical size of junctions follows from."""

    surface_energy: Annotated[float, Quantity("N/mm")] | None = key(
        None, "surface energy γ, for the critical size of junctions (thesis eq 2.3) beside the islands' sizes"
    )
    strength: Pressure | None = key(
        None, "shear strength σ_j of junctions; by default the hardness/(3√3) of the softer body"
    )
