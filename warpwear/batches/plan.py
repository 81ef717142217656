"""What a sweep is asked for: keys and their values, the design, over what bands are taken."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict

from warpwear.batches.design import SAMPLED, Design, Factor, factors_of
from warpwear.batches.points import Point, points_of, with_positions
from warpwear.errors import InputError
from warpwear.results.ensemble import label_of, short_names
from warpwear.study import loading
from warpwear.study.keys import dotted
from warpwear.study.study import Study
from warpwear.study.text import read_section

SECTION = "sweep"


class SweepSection(BaseModel):
    """The section [sweep] of a study: [sweep.vary] key = values, design, samples, seed, band_over."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    vary: dict[str, Any] = {}
    design: Literal["grid", "zip", "sobol", "latin-hypercube", "saltelli"] = "grid"
    samples: int | None = None
    seed: int = 0
    band_over: str | list[str] = []


class Plan:
    """The runs of a sweep, known before any is made.

    study: what is varied. vary: key -> a list of values, a range "1:20", or a distribution. design, samples,
    seed: see `Design`. band_over: keys whose scatter a band shows; the others make groups. By default it is
    every key of a sampled design, and none of a grid. device: "cpu" or "cuda:0".
    Without a section it is the study alone.

    Raises InputError for what makes no sweep.
    """

    def __init__(self, study: Study, section: SweepSection | None = None, *, device: str = "cpu") -> None:
        alone, section = section is None, section or SweepSection()
        self.study, self.device = study, device
        self.design = Design(section.design, section.samples, section.seed)
        self.factors: list[Factor] = [] if alone else factors_of(with_positions(study, section.vary))
        self.keys = [factor.key for factor in self.factors]
        self.names = short_names(self.keys)
        band_over = [section.band_over] if isinstance(section.band_over, str) else list(section.band_over)
        for key in band_over:
            if key not in self.keys:
                raise InputError(f"sweep.band_over = '{key}' is not varied; {', '.join(self.keys)} are")
        self.band_over = band_over or (self.keys if self.design.kind in SAMPLED else [])
        self.points: list[Point] = points_of(study, self.design.points(self.factors), device=device)

    @property
    def groups(self) -> dict[str, list[int]]:
        """Label -> numbers of the runs that differ only in what the bands are taken over."""
        names = {key: name for key, name in self.names.items() if key not in self.band_over}
        groups: dict[str, list[int]] = {}
        for point in self.points:
            groups.setdefault(label_of(point.values, names), []).append(point.number)
        return groups


def read_plan(
    study: Study | str | Path, changes: Mapping[str, Any], options: Mapping[str, Any], *, device: str
) -> Plan:
    """Read the plan of a study file with a section [sweep], or of a study and options beside it.

    changes: of keys of the study. options: of the section, by its keys; "vary" adds to the file's.
    """
    section: Any = {}
    if not isinstance(study, Study):
        sections = loading.read_sections(study)
        section, study = sections.pop(SECTION, {}), Study(**sections)
    return Plan(study.replace(changes), section_of(section, options), device=device)


def section_of(section: Any, options: Mapping[str, Any]) -> SweepSection:
    """Put options in the place of what the section of a file says. Raises InputError with one sentence."""
    section = dict(section) if isinstance(section, Mapping) else {"vary": section}
    more = {key: value for key, value in options.items() if value is not None and key != "vary"}
    if isinstance(section.get("vary", {}), Mapping):
        # Unquoted dots make tables in tables of TOML; {positions = 12} is a value.
        vary = dotted(section.get("vary", {}), whole="positions")
        more["vary"] = {**vary, **dotted(options.get("vary", {}), whole="positions")}
    return SweepSection.model_validate(read_section(SECTION, SweepSection, {**section, **more}))
