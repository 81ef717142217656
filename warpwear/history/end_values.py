"""A run comes to these numbers: typed for texts, verdicts and tables, and as quantities that people see."""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Annotated, Any, Self, get_args

from warpwear.history.quantities import BY_NAME, ENDS_DECLARED, Quantity
from warpwear.study.keys import value_of

Value = str | int | float | None


@dataclass(frozen=True)
class Verdict:
    """Say what to trust, and how far.

    area_relative: error of the area, as a part of it, and of pressures and friction, which go by it.
    area_parts: what makes it uncertain -> its part, the largest first, then what nobody looked at.
    area_scatter: part by which another piece of such a surface differs, one standard deviation.
    area_corrected_mm2: what is told where it is not the counted area. scar_error_mm: of length and width.
    None is not known. area, friction: the same in words.
    """

    text: str
    trusted: bool
    area: str
    area_corrected_mm2: float | None
    area_relative: float | None
    area_parts: Mapping[str, float | None]
    area_scatter: float | None
    scar_error_mm: float | None
    friction: str


@dataclass(frozen=True)
class Summary:
    """Hold what a run came to, as its texts ask for it; beside each stand its keys in summary.json.

    They name its unit. What a run may lack is None. Names are those of `ENDS` and of the history; of a swept
    run areas, pressures and `cof` are means over what `end_values` says. contact_sides: of cells of the last
    contact beside others. step_error, change_by_step: part of the area by the length of steps, on the
    half-space; and by which another length changes it. books: what volumes over wear coefficients are of F L,
    less 1.
    """

    distance: Annotated[float, "distance_mm"]
    steps: Annotated[int, "steps"]
    end_values: Annotated[str, "end_values"]
    load: Annotated[float, "load_N"]
    cell: Annotated[float, "cell_um"]
    macro_cell: Annotated[float | None, "patches.macro_cell_um"]
    macro_patch: Annotated[float | None, "patches.width_um"]
    patch_along: Annotated[float, "scar_mm.along"]
    patch_across: Annotated[float, "scar_mm.across"]
    approach: Annotated[float, "approach_um"]
    area_contact: Annotated[float, "area_mm2.contact"]
    area_plastic: Annotated[float, "area_mm2.plastic"]
    area_touched: Annotated[float, "area_mm2.touched"]
    area_cumulative: Annotated[float, "area_mm2.cumulative"]
    area_nominal: Annotated[float, "area_mm2.nominal"]
    pressure_mean: Annotated[float, "pressure_MPa.mean"]
    pressure_std: Annotated[float, "pressure_MPa.std"]
    pressure_max: Annotated[float, "pressure_MPa.max"]
    depth_counter: Annotated[float, "depth_um.counter"]
    depth_disc: Annotated[float, "depth_um.disc"]
    volume_counter: Annotated[float, "volume_mm3.counter"]
    volume_disc: Annotated[float, "volume_mm3.disc"]
    cof: Annotated[float | None, "cof.end"]
    cof_first: Annotated[float | None, "cof.first"]
    cof_input: Annotated[str | None, "cof_input"]
    shear_strength: Annotated[float | None, "shear_strength_MPa"]
    flash: Annotated[float | None, "flash_K.largest"]
    flash_unknown: Annotated[str | None, "flash_unknown"]
    exponent_m: Annotated[float | None, "cof_shape.exponent_m"]
    levelling_lambda: Annotated[float | None, "cof_shape.levelling_lambda"]
    load_residual: Annotated[float, "load_residual_N.largest"]
    load_on_filled: Annotated[float | None, "load_on_filled_percent.largest"]
    conservation: Annotated[Mapping[str, float], "conservation_relative"]
    books_counter: Annotated[float | None, "layers_counter.volumes_over_K_less_FL"]
    books_disc: Annotated[float | None, "layers_disc.volumes_over_K_less_FL"]
    contact_sides: Annotated[int | None, "contact_sides"]
    change_by_step: Annotated[float | None, "track.change_by_step"]
    step_error: Annotated[float | None, "track.parts.estimated_error_at_most"]
    jump_errors: Annotated[Mapping[str, float] | None, "cycle_jump.depth_error"]
    finished: Annotated[bool, "finished"]
    warnings: Annotated[list[str], "warnings"]
    notes: Annotated[list[str], "notes"]
    assumptions: Annotated[Mapping[str, str], "assumptions"]
    version: Annotated[str, "version"]
    made_with: Annotated[Mapping[str, str] | None, "made_with"]
    verdict: Annotated[Verdict, "verdict"]

    @classmethod
    def of(cls, summary: Mapping[str, Any]) -> Self:
        """Read the content of summary.json, or of `Result.summary`, also before it has a verdict."""
        values = {number.name: value_of(summary, get_args(number.type)[1]) for number in fields(cls)}
        return cls(**values | {"verdict": values["verdict"] and Verdict(**values["verdict"])})


#: What a run comes to that is no column.
OF_A_RUN = Quantity("", "1", "what a run comes to")
#: End values by name, in the order of tables: the last of a column of the history, of a swept run the mean of
#: the last cycle, or what a run comes to beside.
ENDS = {
    name: replace(BY_NAME.get(own.pop("column", name), OF_A_RUN), name=name, **own)
    for name, own in ENDS_DECLARED.items()
}
