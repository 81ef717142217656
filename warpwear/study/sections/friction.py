"""[friction] and [junctions]: what shears."""

import math
from collections.abc import Mapping
from functools import partial
from types import MappingProxyType
from typing import Annotated, Any, Literal

from warpwear.laws.film import Film
from warpwear.laws.friction import FRICTION_LAWS, KEYS, LAP, FrictionLaw
from warpwear.study.keys import (
    Demand,
    Length,
    Pressure,
    Section,
    attribute_of,
    excludes,
    key,
    needs,
    refused,
    when,
)
from warpwear.study.units import InUnit, Number, Range

FITTED = when("friction.shear_strength", None, otherwise="does not apply with a friction.shear_strength")
FITTED += when("friction.law", "shear-strength", "coulomb")
SHEARS = when("friction.law", "shear-strength")
NO_STATES = excludes("friction.law", "states", why=", whose coefficient follows no area")
UNCHANGED: Mapping[str, Any] = MappingProxyType({})


def no_cell_by_cell(why: str, of: tuple[str, ...] = ()) -> tuple[Demand, ...]:
    """Return the demand that no film, growing junctions or bound give each cell its own shear strength."""
    ways = ("film", "junction_growth", "largest_coefficient")
    return tuple(demand for way in ways for demand in excludes(f"friction.{way}", of=of, why=why))


fitted_key = partial(
    key,
    one_of="strength: measured",
    demands=no_cell_by_cell(", which needs friction.shear_strength itself"),
)
BY_STATES = when("friction.law", "states")
Coefficient = Annotated[float, Number(Range(or_equal=True, most=3.0))]
Rate = Annotated[float, Number(Range(most=1000.0))]
UNLAYERED = "layers without a shear_strength or coefficient of their own"
ONE_LAP = "laps, all of one length: sliding.stroke or sliding.track_radius; or friction.states.per = 'mm'"
BARE_STRENGTH = needs(
    "friction.shear_strength",
    what="friction.shear_strength, the interfacial shear strength of bare metal, such as '172 MPa'",
)
NO_BEARING_CURVE = excludes("wear.law", "bearing-curve", why=", where a share of a cell touches")
NOT_CONTACT = ("touched", "cumulative", "nominal")


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
    )
    regrowth: Annotated[float | Literal["never"], InUnit("mm", words=("never",))] = key(
        "never",
        "sliding distance without wear of a body's cell after which its film is whole again",
        assumed="the film does not form anew during the test",
    )

    def with_caps(self, caps: tuple[float, float], bare: float | None) -> Film:
        """Return the film on cells. caps: with it and without it; bare: the strength of these [MPa]."""
        on = self.bodies in ("both", "counter"), self.bodies in ("both", "disc")
        regrowth = math.inf if isinstance(self.regrowth, str) else self.regrowth
        filmed, bared = (1.0 if cap == max(caps) else cap / max(caps) for cap in caps)
        return Film(self.thickness, on, regrowth, filmed, bared, self.shear_strength / bare if bare else 1.0)


class StatesSection(Section):
    """The section [friction.states] says what film, bare metal and cover have, and how they take turns."""

    film: Coefficient = key(..., "coefficient of friction of what has its film, at the start")
    slope: Annotated[float, Number(Range(least=-1.0, most=1.0))] = key(
        0.0, "by how much that grows per lap or mm", assumed="a film that wears does not change its friction"
    )
    metal: Coefficient = key(..., "coefficient of friction of bare metal on metal")
    cover: Coefficient = key(
        ..., "coefficient of friction of metal under debris or oxide, which is the level"
    )
    spread: Rate = key(..., "rate r per lap or mm at which bare metal makes more, db/dN = (1 − b)(e + r b)")
    seed: Rate = key(..., "rate e per lap or mm at which the film is lost by itself: ln(r/e)/r is the wait")
    cover_rate: Rate = key(..., "rate k per lap or mm at which bare metal is covered, dc/dN = k (b − c)")
    per: Literal["lap", "mm"] = key(
        "lap",
        "what rates and slope are of: a lap, or two strokes; or a mm slid",
        demands=needs("cycle", of="lap", what=ONE_LAP),
    )


class Friction(Section):
    """The section [friction] says what fixes the coefficient of friction."""

    law: Literal["shear-strength", "coulomb", "states"] = key(
        "shear-strength",
        "the coefficient is τ0 × area / load, and ploughing; coulomb: it is friction.coefficient at every "
        "distance, ploughing included; states: it goes from film over bare metal to cover, whatever the area",
        demands=needs("friction.states", of="states", what="a section [friction.states]")
        + needs("pair.shears_by_layer", False, of="states", what=UNLAYERED),
    )
    states: StatesSection | None = key(
        None, "friction that waits, jumps and settles; a law that fits", one_of="strength", applies=BY_STATES
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
        demands=NO_STATES
        + BARE_STRENGTH
        + NO_BEARING_CURVE
        + needs("pair.caps_pressure", what="a finite contact.hardness", why=", which it lowers"),
    )
    largest_coefficient: Annotated[float, Number(Range(most=3.0))] | None = key(
        None,
        "largest part of its pressure that shears a cell, whatever its strength; if not given there is none",
        applies=SHEARS,
        demands=BARE_STRENGTH
        + NO_BEARING_CURVE
        + excludes("wear.law", "energy", why=", which wears cells in contact by one strength")
        + excludes("study.model", "two-scale", why=", whose patches do not follow it"),
    )
    film: FilmSection | None = key(
        None, "a film that wear breaks", demands=NO_STATES + BARE_STRENGTH + NO_BEARING_CURVE
    )

    @property
    def fitted(self) -> Literal["end", "initial", "coulomb", "states"] | None:
        """Where the coefficient is an input, to which τ0 is fitted, or all of it; None where τ0 is given."""
        if self.law != "shear-strength":
            return self.law
        return self.calibrate if self.shear_strength is None else None

    @property
    def ends_as_given(self) -> bool:
        """True where the coefficient at the end is an input."""
        return self.fitted in ("end", "coulomb", "states")

    def law_with(self, values: Mapping[str, Any] = UNCHANGED) -> FrictionLaw:
        """Return the law by which friction follows from a history. values: as of `Wear.laws`."""
        own = {key: attribute_of(self, key) for key in (*KEYS, LAP)}
        numbers = {key: values.get(f"friction.{key}", value) for key, value in own.items()}
        return FRICTION_LAWS[self.law](numbers)

    @property
    def grows(self) -> bool:
        """True where junctions grow."""
        return self.junction_growth > 0.0

    @property
    def limit(self) -> str:
        """Formula of the shear stress that a body of hardness H bears."""
        return "H/√α" if self.grows else "H/(3√3)"

    def _check(self) -> None:
        if self.fitted in ("end", "initial") and self.coefficient <= self.ploughing:
            raise refused("ploughing", friction=self)


class Junctions(Section):
    """The section [junctions] says what the critical size of junctions follows from."""

    surface_energy: Annotated[float, InUnit("N/mm")] | None = key(
        None, "surface energy γ, for the critical size of junctions (thesis eq 2.3) beside the islands' sizes"
    )
    strength: Pressure | None = key(
        None, "shear strength σ_j of junctions; by default the hardness/(3√3) of the softer body"
    )
