"""[wear]: what each body loses."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from numbers import Real
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, PlainSerializer, PlainValidator

from warpwear.laws.archard import BODIES, COEFFICIENTS, WEAR_LAWS, EnergyLaw, WearLaw
from warpwear.laws.pieces import Pieces
from warpwear.study.keys import Length, Pressure, Section, excludes, key, needs, refused, when
from warpwear.study.sections.friction import NOT_CONTACT, UNCHANGED, Friction
from warpwear.study.units import NOT_NEGATIVE, InUnit, Number, Range, parse, text

AT_REST = when("kinematics", "stationary")
SHEDS = when("wear.sheds", otherwise="does not apply without a wear.particle: all wear leaves at once")
shed_key = partial(key, applies=SHEDS)
running_in_key = partial(key, applies=when("wear.law", "running-in"))
transition_key = partial(key, applies=when("wear.law", "transition"))
THICKNESS = (
    "wear.particle_thickness, such as '0.6 um': measure it as 4 times Rq of the worn counter-body along "
    "sliding, or on flakes in the SEM"
)
CRITICAL = (
    "junctions.surface_energy, such as '2 J/m^2', and of the softer body Young's modulus, Poisson's ratio "
    "and hardness; or give a diameter, such as '20 um'"
)
#: Where cells in contact wear alike by the energy of a shear strength, and what else there is.
BY_AREA = when("friction.law", "shear-strength")
BY_COULOMB = ", or friction.law = 'coulomb', by which cells in contact wear unalike"
no_energy = partial(excludes, of="energy", where=BY_AREA, why=BY_COULOMB.replace("or", "unless", 1))
#: Laws by which K goes with the pressure of a cell.
OF_PRESSURE = tuple(name for name, law in WEAR_LAWS.items() if law.over_pressure is not WearLaw.over_pressure)
IN_ONE_PROPORTION = ", which keeps what counter-body and disc wear in one proportion"


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
    )
    disc: WearCoefficient = key(
        ...,
        'wear coefficient K of the disc, such as "2e-6 mm^3/N/m"; 0 where it does not wear; without a unit '
        "k = K H, with contact.hardness or else the softer body's for both bodies",
    )
    law: Literal["archard", "exponential", "running-in", "bearing-curve", "energy", "transition"] = key(
        "archard",
        "depth = K × pressure × distance, K constant or by an empirical law of the distance slid; energy: "
        "depth = α × friction energy of an area, with counter and disc in mm^3/J; transition: K by the "
        "pressure of a cell, with counter and disc for mild wear",
        demands=needs("wear.decay", of="exponential")
        + needs("wear.running_in", of="running-in")
        + needs("wear.starts_apart", of="running-in", what="wear.initial_counter or wear.initial_disc")
        + needs("study.model", "macro", of="bearing-curve", why=": the other models resolve the roughness")
        + needs("stepping.scheme", "implicit", of="bearing-curve")
        + excludes("study.model", "two-scale", of="running-in", why=IN_ONE_PROPORTION)
        + excludes("friction.law", "states", of="energy", why=", whose coefficient changes")
        + needs("friction.shear_strength", of="energy", where=BY_AREA, why=BY_COULOMB)
        + no_energy("study.model", "two-scale")
        + no_energy("stepping.scheme", "explicit")
        + no_energy("friction.area", *NOT_CONTACT)
        + no_energy("wear.distance_factor", "across", "radial")
        + no_energy("wear.particle")
        + needs("wear.severe_counter", of="transition")
        + needs("wear.severe_disc", of="transition")
        + needs("wear.transition_pressure", of="transition")
        + needs("wear.transition_width", of="transition")
        + excludes("wear.distance_factor", "across", "radial", of=OF_PRESSURE)
        + excludes("wear.particle", of=OF_PRESSURE)
        + excludes("kinematics", "fretting", of=OF_PRESSURE, why=", where cells slip by their own lengths")
        + excludes("patches.coupling", "load", of=OF_PRESSURE),
    )
    decay: Annotated[float, InUnit("1/mm")] | None = key(
        None,
        "exponential: α of V = K F (1 − e^(−αL))/α, an empirical fit",
        applies=when("wear.law", "exponential"),
    )
    running_in: Length | None = running_in_key(
        None, "running-in: L0 of K + (K0 − K) e^(−L/L0), an empirical fit"
    )
    initial_counter: WearCoefficient | None = running_in_key(
        None, "running-in: K0 of the counter-body; K if not given"
    )
    initial_disc: WearCoefficient | None = running_in_key(None, "running-in: K0 of the disc; K if not given")
    severe_counter: WearCoefficient | None = transition_key(
        None, "transition: K of severe wear of the counter-body"
    )
    severe_disc: WearCoefficient | None = transition_key(None, "transition: K of severe wear of the disc")
    transition_pressure: Pressure | None = transition_key(
        None, "transition: pressure of a cell in the middle of the transition"
    )
    transition_width: Pressure | None = transition_key(
        None, "transition: pressures from its beginning to its end, over which K is linear"
    )
    distance_factor: Literal["none", "across", "radial"] = key(
        "none",
        "shorter sliding distance of disc cells beside the middle, √(1 − d²/R²): d across or radial",
        applies=AT_REST,
        demands=excludes("study.model", "two-scale", of=("across", "radial"), why=IN_ONE_PROPORTION)
        + excludes("contact.law", "half-space", of=("across", "radial"))
        + needs("counter.shape", "ball", of=("across", "radial"))
        + excludes("wear.particle", of=("across", "radial")),
    )
    particle: Annotated[float | Literal["critical"], InUnit("mm", words=("critical",))] | None = key(
        None,
        "diameter d* of the pieces in which worn volume leaves; critical: that of thesis eq 2.3, see "
        "[junctions]; if not given, it leaves at once, as dust",
        demands=needs("wear.particle_thickness", what=THICKNESS)
        + needs("study.model", "micro", why=": patches would cut pieces, and smooth bodies have none")
        + needs("pair.critical_junction", of="critical", what=CRITICAL),
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

    def pieces(self, critical: float | None) -> Pieces | None:
        """Return the pieces by which bodies wear; None where all leaves at once. critical: their d* [mm]."""
        diameter = critical if self.particle == "critical" else self.particle
        if diameter is None or self.particle_thickness is None:
            return None
        seed = self.pending_seed if self.pending_start == "uniform" else None
        return Pieces(float(diameter), self.particle_thickness, self.dust_fraction, seed)

    @property
    def unit(self) -> str:
        """Give the unit that coefficients have under the law."""
        return ArchardCoefficient.of_energy if self.law == "energy" else ArchardCoefficient.unit

    def laws(
        self, hardness: float, friction: Friction, values: Mapping[str, Any] = UNCHANGED
    ) -> tuple[WearLaw, WearLaw]:
        """Return the laws of counter-body and disc. hardness: H of V = k F L / H [MPa].

        friction: of which the energy law takes what shears a cell. values: dotted keys -> numbers, or arrays
        of them, in the keys' units, that replace those of the study.
        """
        law = friction.law_with(values)
        of_pressure, strength = law.tractions

        def number(key: str) -> Any:
            value = values.get(f"wear.{key}")
            if value is None:
                value = getattr(self, key)
            elif key in COEFFICIENTS:
                value = ArchardCoefficient(value, per_energy=self.law == "energy")
            return value.resolved(hardness, of_pressure) if isinstance(value, ArchardCoefficient) else value

        counter, disc = (WEAR_LAWS[self.law].of(body, number) for body in BODIES)
        if not (isinstance(counter, EnergyLaw) and isinstance(disc, EnergyLaw) and strength):
            return counter, disc
        alphas = (values.get(f"wear.{body}", getattr(self, body).value) for body in BODIES)
        counter, disc = (
            replace(one, shear=1.0e-3 * alpha * strength, **law.course)
            for one, alpha in zip((counter, disc), alphas, strict=True)
        )
        return counter, disc

    def resolved(
        self, coefficient: float | ArchardCoefficient, *, hardness: float, friction: Friction
    ) -> float:
        """Return K [mm²/N] of a coefficient, or of a number in its `unit`. hardness: as of `laws`."""
        if not isinstance(coefficient, ArchardCoefficient):
            coefficient = ArchardCoefficient(coefficient, per_energy=self.law == "energy")
        return float(coefficient.resolved(hardness, friction.law_with().tractions[0]))

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
                raise refused("unit_of_wear", name=name, value=value.write(), wear=self, other=other)
