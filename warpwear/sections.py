"""The sections of a study: every key, its unit, default, allowed values and meaning.

Numbers are kept in mm, N, MPa and s. A key whose default is a choice of ours and not the user's carries
`assumed`, which `warpwear show` and the results repeat. Keys that no rule of the chosen kind uses are ignored
with a notice (see `Study.notices`), so that changing one key can change a kind.
"""

import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainSerializer,
    PlainValidator,
    model_validator,
)

from warpwear.hertz import MATCHES
from warpwear.materials import material
from warpwear.quantities import (
    NOT_NEGATIVE,
    POSITIVE_OR_INFINITE,
    Number,
    Quantity,
    Range,
    parse,
    text,
)

Length = Annotated[float, Quantity("mm")]
LengthOrZero = Annotated[float, Quantity("mm", NOT_NEGATIVE)]
LengthOrInfinite = Annotated[float, Quantity("mm", POSITIVE_OR_INFINITE)]
Force = Annotated[float, Quantity("N")]
Pressure = Annotated[float, Quantity("MPa")]
PressureOrInfinite = Annotated[float, Quantity("MPa", POSITIVE_OR_INFINITE)]
Stiffness = Annotated[float, Quantity("N/mm^3", POSITIVE_OR_INFINITE)]
Angle = Annotated[float, Quantity("deg", Range(least=-360.0, or_equal=True, most=360.0))]
Time = Annotated[float, Quantity("s")]
Interval = Annotated[float, Quantity("s", Range(or_equal=True, infinite=True))]
Frequency = Annotated[float, Quantity("Hz")]
Speed = Annotated[float, Quantity("mm/s")]
PoissonRatio = Annotated[float, Number(Range(or_equal=True, most=0.5))]
HurstExponent = Annotated[float, Number(Range(most=1.0))]
Growth = Annotated[float, Number(Range(least=1.0, or_equal=True, most=10.0))]
Deviations = Annotated[float, Number(Range(least=3.0, or_equal=True))]
FrictionCoefficient = Annotated[float, Number(Range(most=3.0))]
Strokes = Annotated[int, Field(ge=0, le=1_000_000_000, strict=True)]
FrictionOffset = Annotated[float, Number(Range(or_equal=True, most=3.0))]
Ratio = Annotated[float, Number(Range(or_equal=True, most=1000.0))]
PerLength = Annotated[float, Quantity("1/mm")]
SurfaceEnergy = Annotated[float, Quantity("N/mm")]


def key(default: Any = ..., meaning: str = "", *, assumed: str | None = None) -> Any:
    """A key of a section. assumed: why this default was chosen, where it is a physical assumption."""
    extra: Any = {"assumed": assumed} if assumed else None
    return Field(default, description=meaning, json_schema_extra=extra)


class Section(BaseModel):
    """Frozen, and no key that is not declared."""

    model_config = ConfigDict(frozen=True, extra="forbid", validate_default=True)


class About(Section):
    """[study]"""

    name: Annotated[str, Field(pattern=r"^\w[\w .+-]{0,99}$")] = key(
        "study", "name of the run and of its folder: letters, digits, spaces and . + - _"
    )
    description: str = key("", "one line for people")
    model: Literal["macro", "micro", "two-scale"] = key(
        "micro",
        "macro: smooth bodies on an elastic foundation; micro: every asperity resolved; two-scale: patches "
        "of resolved asperities that share the load",
    )


class Body(Section):
    material: Annotated[str, AfterValidator(lambda name: material(name).name)] | None = key(
        None,
        "name of a known material (see 'warpwear materials'), for constants that are not given",
    )
    young: Pressure | None = key(None, "Young's modulus")
    poisson: PoissonRatio | None = key(None, "Poisson's ratio")
    hardness: Pressure | None = key(None, "indentation hardness")

    @property
    def elastic(self) -> tuple[float, float] | None:
        """Young's modulus [MPa] and Poisson's ratio, where both are known."""
        return None if self.young is None or self.poisson is None else (self.young, self.poisson)


class Sphere(Body):
    """[sphere]"""

    radius: LengthOrInfinite | None = key(None, "radius; 'inf mm' is a rigid flat")
    diameter: Length | None = key(None, "diameter, instead of the radius")

    @model_validator(mode="after")
    def _one_size(self) -> Self:
        if (self.radius is None) == (self.diameter is None):
            raise ValueError("sphere.radius or sphere.diameter must be given, and not both")
        return self

    @property
    def curvature(self) -> float:
        """1/R [1/mm], 0 for a flat."""
        if self.radius is not None:
            return 1.0 / self.radius
        assert self.diameter is not None
        return 2.0 / self.diameter


class Synthetic(Section):
    """[disc.synthetic]"""

    kind: Literal["self-affine", "milled", "flat"] = key(..., "which surface")
    ra: Length | None = key(None, "arithmetic mean height Ra")
    sq: Length | None = key(None, "root mean square height Sq, instead of Ra")
    hurst: HurstExponent = key(0.8, "Hurst exponent", assumed="typical of machined steel")
    roll_off: Length = key("100 um", "wavelength above which the spectrum is flat", assumed="not measured")
    cut_off: Length = key("8 um", "shortest wavelength (λs)", assumed="profile filter λs of ISO 3274")
    seed: int = key(0, "seed of the random numbers", assumed="one surface of many")
    period: Length = key("2 mm", "length after which the surface repeats", assumed="wider than the contact")
    feed: Length = key("0.65 mm", "milled: distance of the feed marks")
    fine_ra: LengthOrZero = key("0.3 um", "milled: Ra of the random part", assumed="a tenth of a common Ra")
    lay: Angle = key(
        "90 deg", "milled: angle between feed marks and sliding", assumed="sliding across the marks"
    )

    @model_validator(mode="after")
    def _one_height(self) -> Self:
        if self.kind == "flat":
            return self
        if (self.ra is None) == (self.sq is None):
            raise ValueError("disc.synthetic.ra or disc.synthetic.sq must be given, and not both")
        return self


def _pixel(value: Any) -> Any:
    return (value, value) if isinstance(value, str) else value


def _crop(value: Any) -> Any:
    value = _pixel(value)
    if isinstance(value, list | tuple) and len(value) not in (2, 4):
        raise ValueError("needs a size, a size along x and along y, or four lengths x0, x1, y0, y1")
    return value


class Disc(Body):
    """[disc]"""

    surface: str | None = key(None, "file of a measured surface, relative to the study")
    synthetic: Synthetic | None = key(None, "a synthetic surface instead")
    extend: Literal["refuse", "mirror", "periodic"] = key(
        "refuse", "when the file is smaller than the domain"
    )
    height_sign: Literal["up", "down"] = key("up", "down turns the file's heights over: it gives depths")
    crop: Annotated[tuple[LengthOrZero, ...], BeforeValidator(_crop)] | None = key(
        None, "part of the file used: x0, x1, y0, y1 from its corner, or a size around its middle"
    )
    sliding_axis: Literal["x", "y"] = key("x", "axis of the file along which the sphere slides")
    outliers: Deviations | None = key(
        None, "points farther than so many robust standard deviations from the local median are removed"
    )
    level: Literal["none", "plane", "sphere"] | Annotated[int, Field(ge=0, le=12)] = key(
        "plane", "form removed from the measurement: none, plane, sphere or degree of a polynomial"
    )
    s_filter: Length | None = key(None, "waves shorter than this are filtered out (Gaussian, ISO 16610-61)")
    l_filter: Length | None = key(None, "waves longer than this are filtered out (Gaussian, ISO 16610-61)")
    pixel: Annotated[tuple[Length, Length], BeforeValidator(_pixel)] | None = key(
        None, "distance of the file's points, needed by .npy; overrides what a file says"
    )
    height_unit: Literal["m", "mm", "um", "µm", "nm"] | None = key(
        None, "unit of the file's heights, needed by .npy; overrides what a file says"
    )
    array: str | None = key(None, "which array of a .npz that holds several")

    @model_validator(mode="after")
    def _one_surface(self) -> Self:
        if self.surface is not None and self.synthetic is not None:
            raise ValueError("disc.surface (a file) and [disc.synthetic] exclude each other")
        return self


def _foundation(value: Any) -> Any:
    return value if isinstance(value, str) and value in MATCHES else Quantity("N/mm^3").read(value)


class Contact(Section):
    """[contact]"""

    load: Force = key(..., "normal load")
    hardness: PressureOrInfinite | None = key(
        None, "largest pressure of a cell; by default the softer body's, in the macro model none"
    )
    law: Literal["foundation", "half-space"] = key(
        "foundation",
        "under a largest pressure; foundation: every cell by itself; half-space: elastic bodies, whose "
        "asperities feel each other",
    )
    boundary: Literal["free", "periodic"] | None = key(
        None,
        "half-space: nothing beyond the domain (two-scale model: beyond each patch), or it is repeated; "
        "if not given free under a sphere, periodic under a flat and for patches",
        assumed="nothing beyond the domain under a sphere; under a flat the domain is repeated, and in the "
        "two-scale model each patch",
    )
    stiffness: Stiffness = key(
        "inf N/mm^3",
        "micro and two-scale model: local foundation stiffness k",
        assumed="asperities do not deform elastically",
    )
    foundation: Annotated[
        float | Literal["area", "pressure", "approach"],
        BeforeValidator(_foundation),
        PlainSerializer(lambda v: v if isinstance(v, str) else text(v, "N/mm^3")),
    ] = key(
        "area",
        "macro model, bulk of the two-scale: stiffness K_N that gives Hertz's area, peak pressure or "
        "approach, or a stiffness",
        assumed="one spring constant matches one of Hertz's three values",
    )
    foundation_update: Literal["initial", "updated"] = key(
        "initial",
        "K_N = C_W E*/a with Hertz's a for ever, or with that of the area in contact (two-scale: scar)",
    )


@dataclass(frozen=True)
class ArchardCoefficient:
    """K of V = K F L [mm³/(N·m)], hardness contained; or k of V = k F L / H, dimensionless."""

    value: float
    dimensionless: bool = False

    @classmethod
    def read(cls, given: Any) -> Self:
        """From text with a unit, or a bare number. Raises ValueError."""
        if isinstance(given, cls):
            return given
        bare = isinstance(given, int | float) and not isinstance(given, bool)
        value = Number(NOT_NEGATIVE).read(given) if bare else parse(given, "mm^3/N/m")
        return cls(NOT_NEGATIVE.check(value), bare)

    def write(self) -> str | float:
        """What `read` reads back."""
        return self.value if self.dimensionless else text(self.value, "mm^3/N/m")

    def resolved(self, hardness: float) -> float:
        """K [mm²/N] = 1e-3 mm³/(N·m) (thesis eqs 4.12 and 4.13)."""
        return self.value / hardness if self.dimensionless else 1.0e-3 * self.value


WearCoefficient = Annotated[
    ArchardCoefficient, PlainValidator(ArchardCoefficient.read), PlainSerializer(ArchardCoefficient.write)
]


class Wear(Section):
    """[wear]"""

    sphere: WearCoefficient = key(..., "wear coefficient K of the sphere, hardness contained")
    disc: WearCoefficient = key(..., "wear coefficient K of the disc, hardness contained")
    law: Literal["archard", "exponential", "running-in", "bearing-curve"] = key(
        "archard", "depth = K × pressure × distance, K constant or by an empirical law of the distance slid"
    )
    decay: PerLength | None = key(None, "exponential: α of V = K F (1 − e^(−αL))/α, an empirical fit")
    running_in: Length | None = key(None, "running-in: L0 of K + (K0 − K) e^(−L/L0), an empirical fit")
    initial_sphere: WearCoefficient | None = key(None, "running-in: K0 of the sphere; K if not given")
    initial_disc: WearCoefficient | None = key(None, "running-in: K0 of the disc; K if not given")
    distance_factor: Literal["none", "across", "radial"] = key(
        "none", "shorter sliding distance of disc cells beside the middle, √(1 − d²/R²): d across or radial"
    )

    @model_validator(mode="after")
    def _law_has_its_keys(self) -> Self:
        if self.law == "exponential" and self.decay is None:
            raise ValueError("wear.law = 'exponential' needs wear.decay, such as '0.1 1/m'")
        if self.law == "running-in" and self.running_in is None:
            raise ValueError("wear.law = 'running-in' needs wear.running_in, a length such as '100 mm'")
        if self.law == "running-in" and self.initial_sphere is None and self.initial_disc is None:
            raise ValueError("wear.law = 'running-in' needs wear.initial_sphere or wear.initial_disc")
        return self


#: Along a side: a million squared is more than any memory holds.
MOST_CELLS = 1_000_000


class GridSection(Section):
    """[grid]"""

    cell: Length = key(..., "size of a cell; 10 um in the macro model, if not given")
    extent: Length = key(..., "side of the square domain")

    @model_validator(mode="after")
    def _whole_cells(self) -> Self:
        cells = self.extent / self.cell
        if cells > MOST_CELLS:
            raise ValueError(
                f"grid.cell = {self.cell:g} mm makes more than {MOST_CELLS:,} cells along grid.extent = "
                f"{self.extent:g} mm; larger cells or a smaller extent are needed"
            )
        if abs(cells - round(cells)) > 1e-6 * cells or round(cells) < 4:
            near = max(round(cells), 4) * self.cell
            raise ValueError(
                f"grid.extent = {self.extent:g} mm is not a whole number (4 or more) of cells of "
                f"{1e3 * self.cell:g} µm; the nearest that is, is {near!r} mm"
            )
        return self


def _track(value: Any) -> Any:
    if value == "full":
        return value
    try:
        return Quantity("mm").read(value)
    except ValueError as error:
        raise ValueError(f"{error}, or 'full'") from None


class Sliding(Section):
    """[sliding]"""

    distance: LengthOrZero | None = key(None, "total sliding distance; 0 is a static contact")
    passes: Strokes | None = key(None, "instead of distance: number of strokes")
    cycles: Strokes | None = key(None, "instead of distance: number of pairs of strokes")
    duration: Time | None = key(None, "instead of distance, with frequency: time of the test")
    frequency: Frequency | None = key(None, "cycles in a second")
    revolutions: Annotated[float, Number()] | None = key(
        None, "instead of distance: revolutions of a rotating disc"
    )
    stroke: Length | None = key(None, "length of one pass")
    track_radius: Length | None = key(
        None, "instead of stroke: radius of the track on a rotating disc, which slides one way only"
    )
    speed: Speed | None = key(None, "sliding speed, for the time axis only")
    kinematics: Literal["stationary", "swept"] = key(
        "stationary",
        "stationary: the same disc cells stay under the sphere; swept: it slides along a track on the disc",
    )
    track: Annotated[
        float | Literal["full"],
        BeforeValidator(_track),
        PlainSerializer(lambda v: v if v == "full" else text(v, "mm")),
    ] = key(
        "full",
        "swept: the whole stroke, or the length of a periodic disc on which one lap stands for one pass",
    )
    shift: Annotated[int, Field(ge=1, le=100_000, strict=True)] = key(
        8, "swept: cells that the sphere moves on in a step", assumed="well within the contact's length"
    )
    plastic: Literal["forget", "keep"] = key(
        "forget",
        "swept: a disc cell at the hardness springs back, or keeps the depth it was pressed to",
        assumed="Archard's wear alone; 'keep' is the other end",
    )

    @model_validator(mode="after")
    def _one_distance(self) -> Self:
        ways = {
            "sliding.distance": self.distance is not None,
            "sliding.passes": self.passes is not None,
            "sliding.cycles": self.cycles is not None,
            "sliding.duration with sliding.frequency": self.duration is not None
            or self.frequency is not None,
            "sliding.revolutions": self.revolutions is not None,
        }
        given = [way for way, is_given in ways.items() if is_given]
        if len(given) != 1:
            found = " and ".join(given) if given else "none"
            raise ValueError(f"the sliding distance needs one of {', '.join(ways)}; given: {found}")
        if (self.duration is None) != (self.frequency is None):
            raise ValueError("sliding.duration and sliding.frequency need each other")
        if self.stroke is not None and self.track_radius is not None:
            raise ValueError("sliding.stroke and sliding.track_radius exclude each other")
        if self.revolutions is not None:
            if self.track_radius is None:
                raise ValueError("sliding.revolutions needs sliding.track_radius, a length such as '5 mm'")
        elif self.distance is None and self.stroke is None:
            raise ValueError(f"{given[0]} needs sliding.stroke, a length such as '30 mm'")
        return self

    @property
    def lap(self) -> float | None:
        """What is slid in one pass: the stroke, or the way of one revolution [mm]."""
        return self.stroke if self.track_radius is None else 2.0 * math.pi * self.track_radius

    @property
    def total(self) -> float:
        """Sliding distance of the whole test [mm]."""
        if self.distance is not None:
            return self.distance
        if self.revolutions is not None:
            assert self.lap is not None
            return self.revolutions * self.lap
        assert self.stroke is not None  # one of the other ways was given, and they need it
        if self.duration is not None and self.frequency is not None:
            return 2.0 * self.stroke * self.frequency * self.duration
        return self.stroke * (self.passes or 2 * (self.cycles or 0))


def _tolerance(value: Any) -> Any:
    return value if value == "one cell" else Quantity("N").read(value)


class Stepping(Section):
    """[stepping]"""

    scheme: Literal["explicit", "implicit"] = key("implicit", "pressure of the step's start, or of its end")
    increment: Length | None = key(None, "fixed sliding increment")
    first: Length = key("3 um", "growing increments: the first", assumed="nanometres of wear")
    growth: Growth = key(1.02, "ratio of an increment to the last", assumed="grow with the distance slid")
    largest: Length = key("3 mm", "growing increments: the largest", assumed="a tenth of a usual stroke")
    load_tolerance: Annotated[
        float | Literal["one cell"],
        BeforeValidator(_tolerance),
        PlainSerializer(lambda v: v if v == "one cell" else text(v, "N")),
    ] = key("one cell", "bearing area only: load left unbalanced, at most")
    force: bool = key(False, "go on beyond the explicit stability limit")

    @model_validator(mode="after")
    def _one_plan(self) -> Self:
        growing = {"first", "growth", "largest"} & self.model_fields_set
        if self.increment is not None and growing:
            raise ValueError(f"stepping.increment and stepping.{min(growing)} exclude each other")
        if self.first > self.largest:
            raise ValueError(
                f"stepping.first = {self.first:g} mm must not exceed stepping.largest = {self.largest:g} mm"
            )
        return self

    @property
    def plan(self) -> tuple[float, float, float]:
        """First increment [mm], growth, largest [mm]."""
        if self.increment is not None:
            return self.increment, 1.0, self.increment
        return self.first, self.growth, self.largest


class Friction(Section):
    """[friction]"""

    shear_strength: Pressure | None = key(None, "interfacial shear strength τ0")
    coefficient: FrictionCoefficient = key(
        0.6, "measured coefficient that fixes τ0, instead", assumed="for want of a measured one"
    )
    calibrate: Literal["end", "initial"] = key("end", "when the measured coefficient holds")
    ploughing: FrictionOffset = key(0.0, "part μ_p of the coefficient that does not shear")
    initial_ratio: Ratio | None = key(
        None, "running-in: τ at the start over τ0, with τ0 (1 + (ratio − 1) e^(−L/L_τ)); an empirical fit"
    )
    running_in: Length | None = key(None, "running-in: L_τ of the shear strength")
    area: Literal["contact", "touched", "cumulative", "nominal"] = key("contact", "area that shears")

    @model_validator(mode="after")
    def _one_strength(self) -> Self:
        measured = {"coefficient", "calibrate"} & self.model_fields_set
        if self.shear_strength is not None and measured:
            raise ValueError(f"friction.shear_strength and friction.{max(measured)} exclude each other")
        if (self.initial_ratio is None) != (self.running_in is None):
            raise ValueError("friction.initial_ratio and friction.running_in need each other")
        if self.shear_strength is None and self.coefficient <= self.ploughing:
            raise ValueError(
                f"friction.coefficient = {self.coefficient:g} must exceed friction.ploughing = "
                f"{self.ploughing:g}"
            )
        return self


class Junctions(Section):
    """[junctions]"""

    surface_energy: SurfaceEnergy | None = key(
        None, "surface energy γ, for the critical size of junctions (thesis eq 2.3) beside the islands' sizes"
    )
    strength: Pressure | None = key(
        None, "shear strength σ_j of junctions; by default the hardness/(3√3) of the softer body"
    )


class Macro(Section):
    """[macro]: of the two-scale model"""

    cell: Length = key("50 um", "size of a macro cell, each of which has one patch of the grid's cells")
    patch: Length | None = key(
        None, "size of a patch; by default the macro cell, which tiles the contact; smaller ones stand for it"
    )
    bulk: Literal["foundation", "none"] = key(
        "foundation",
        "spring behind each patch: foundation is K_N, the elastic bulk of both bodies, in series; none where "
        "the patch's own law carries that compliance, as free patches of the half-space do",
        assumed="springs of the patches yield as the smooth bodies do; without hardness or asperities",
    )
    coupling: Literal["approach", "load"] = key(
        "approach",
        "approach: one for all patches, whose own answers share the load; load: a smooth macro contact "
        "prescribes the load of each patch",
    )
    placement: Literal["centre", "random"] = key(
        "centre", "place of a smaller patch in its macro cell: in the middle, or at random by macro.seed"
    )
    seed: Annotated[int, Field(ge=0, strict=True)] = key(0, "seed of the random placement")

    @property
    def patch_width(self) -> float:
        """[mm]"""
        return self.cell if self.patch is None else self.patch


class Run(Section):
    """[run]"""

    checkpoint: Interval = key(
        "2 min", "time between checkpoints, from which --resume goes on; 0 s is after every step, inf s never"
    )


class Checks(Section):
    """[checks]"""

    strict: bool = key(
        True,
        "stop when a step breaks what must hold: finite numbers, balance, volumes, a contact off the edge; "
        "false records a warning",
    )


class Output(Section):
    """[output]"""

    snapshots: tuple[LengthOrZero, ...] = key(
        (),
        "sliding distances at which fields are kept; the end always is; swept: at the end of the step that "
        "reaches each",
    )
