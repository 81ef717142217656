"""[contact]: what is pressed, and by which law cells yield."""

import math
from typing import Annotated, Literal

from warpwear.laws.elastic import MATCHES
from warpwear.study.keys import Section, excludes, key, needs, needs_compliance, when
from warpwear.study.units import InUnit, Load, Range

#: K_N plays a part in the macro model, and in the two-scale model where it is the bulk behind the patches.
BULK = when("study.model", "macro", "two-scale", otherwise="does not apply to the micro model")
BULK += when("pair.uses_bulk_stiffness", otherwise="does not apply to patches.bulk = 'none'")
ROUGH = when(
    "study.model",
    "micro",
    "two-scale",
    otherwise="does not apply to the {} model: its K_N is contact.bulk_stiffness",
)
LOCAL = when("contact.law", "local", otherwise="does not apply to contact.law = '{}': E* of both bodies does")
#: The sentence's words for what E* follows from.
ELASTIC = (
    "Young's modulus and Poisson's ratio of both bodies: counter.material or counter.young and "
    "counter.poisson, and the same of the disc"
)
#: Shapes that Hertz knows.
ROUND = "a ball, a crowned body or a cylinder"
#: The sentence's end where a stiffness is allowed instead.
A_STIFFNESS = "; or a stiffness such as '2e6 N/mm^3'"


class Contact(Section):
    """The section [contact] says what is pressed, and by which law cells yield."""

    load: Annotated[float, Load("N")] = key(
        ..., "normal load; of a line contact also a load of its length, '18.5 N/mm', times grid.extent across"
    )
    hardness: Annotated[float, InUnit("MPa", Range(infinite=True), hardness=True)] | None = key(
        None,
        "largest pressure of a cell, inf for no limit; by default the softer body's, in the macro model none",
        demands=needs_compliance(math.inf),
    )
    law: Literal["local", "half-space"] = key(
        "local",
        "under a largest pressure; local: every cell by itself; half-space: elastic bodies, whose "
        "asperities feel each other",
        demands=needs("study.model", "micro", "two-scale", of="half-space")
        + needs("pair.effective_modulus", of="half-space", what=ELASTIC)
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
        demands=excludes("study.model", "two-scale", of="line"),
    )
    stiffness: Annotated[float, InUnit("N/mm^3", Range(infinite=True))] = key(
        "inf N/mm^3",
        "micro and two-scale model: local foundation stiffness k",
        assumed="asperities do not deform elastically",
        applies=ROUGH + LOCAL,
    )
    bulk_stiffness: Annotated[
        float | Literal["area", "pressure", "approach"], InUnit("N/mm^3", words=tuple(MATCHES))
    ] = key(
        "area",
        "macro model, bulk of the two-scale: stiffness K_N that gives Hertz's area, peak pressure or "
        "approach, or a stiffness",
        assumed="one spring constant matches one of Hertz's three values",
        applies=BULK,
        demands=needs("counter.has_hertz", of=tuple(MATCHES), what=ROUND, why=A_STIFFNESS)
        + needs("counter.has_approach", of="approach", what="a ball or a crowned body", why=A_STIFFNESS)
        + needs("pair.effective_modulus", of=tuple(MATCHES), what=ELASTIC, why=A_STIFFNESS),
    )
    bulk_update: Literal["initial", "updated"] = key(
        "initial",
        "K_N = C_W E*/a with Hertz's a for ever, or with that of the area in contact (two-scale: scar)",
        applies=BULK,
        demands=needs("contact.bulk_stiffness", *MATCHES, of="updated")
        + needs("counter.has_approach", of="updated", what="a ball or a crowned body"),
    )
