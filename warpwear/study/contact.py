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

    load: Annotated[float, Load("N")] = key(...)
    hardness: Annotated[float, InUnit("MPa", Range(infinite=True), hardness=True)] | None = key(
        None, demands=needs_compliance(math.inf)
    )
    law: Literal["local", "half-space"] = key(
        "local",
        demands=needs("study.model", "micro", "two-scale", of="half-space")
        + needs("pair.effective_modulus", of="half-space", what=ELASTIC)
        + needs("stepping.scheme", "implicit", of="half-space"),
    )
    boundary: Literal["free", "periodic", "line"] | None = key(
        None,
        applies=when("contact.law", "half-space"),
        demands=excludes("study.model", "two-scale", of="line"),
    )
    stiffness: Annotated[float, InUnit("N/mm^3", Range(infinite=True))] = key(
        "inf N/mm^3", applies=ROUGH + LOCAL
    )
    bulk_stiffness: Annotated[
        float | Literal["area", "pressure", "approach"], InUnit("N/mm^3", words=tuple(MATCHES))
    ] = key(
        "area",
        applies=BULK,
        demands=needs("counter.has_hertz", of=tuple(MATCHES), what=ROUND, why=A_STIFFNESS)
        + needs("counter.has_approach", of="approach", what="a ball or a crowned body", why=A_STIFFNESS)
        + needs("pair.effective_modulus", of=tuple(MATCHES), what=ELASTIC, why=A_STIFFNESS),
    )
    bulk_update: Literal["initial", "updated"] = key(
        "initial",
        applies=BULK,
        demands=needs("contact.bulk_stiffness", *MATCHES, of="updated")
        + needs("counter.has_approach", of="updated", what="a ball or a crowned body"),
    )
