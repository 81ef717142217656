"""What a sweep is asked for: keys and their values, the design, over what bands are taken, and its runs."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict

from warpwear.batches.design import SAMPLED, Design, Factor, factors_of
from warpwear.batches.run_one import RunTask
from warpwear.errors import InputError
from warpwear.results.ensemble import label_of, name_of, short_names
from warpwear.study import loading
from warpwear.study.keys import dotted
from warpwear.study.study import Study
from warpwear.study.text import read_section
from warpwear.surfaces.reading import digest_of, read

SECTION = "sweep"
#: Key that takes parts of a measured disc instead of values, and what says where they lie.
CROP, POSITIONS = "disc.crop", {"positions", "seed"}


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


@dataclass(frozen=True)
class Point:
    """One run of a sweep: its varied values as they were given, and its study, or why there is none."""

    number: int
    values: dict[str, Any]
    study: Study | None
    run: str  # name of its folder; empty without a study
    problem: str = ""
    files: dict[str, str] = field(default_factory=dict)  # key that names a file -> SHA-256 of that


def points_of(study: Study, values: Iterable[Mapping[str, Any]], *, device: str) -> list[Point]:
    """Return the runs of a study with these values of its keys.

    A combination that makes no study is a point with its sentence. Raises InputError where none makes one.
    """
    digest = cache(digest_of)  # a file is read once for all runs
    points = [_point(number, study, dict(changes), device, digest) for number, changes in enumerate(values)]
    if all(point.study is None for point in points):
        raise InputError(points[0].problem)
    return points


def _point(
    number: int, study: Study, values: dict[str, Any], device: str, digest: Callable[..., str]
) -> Point:
    try:
        varied = study.replace(values)
    except InputError as error:
        return Point(number, values, None, "", str(error))
    files = {key: digest(path, key=key) for key, path in varied.files.items()}
    return Point(number, values, varied, name_of(varied, device=device, files=files), files=files)


def task_of(point: Point, runs: Path, *, device: str, threads: int | None = None) -> RunTask:
    """Return what a worker is asked for a run. runs: the folder of all of them."""
    assert point.study is not None
    return RunTask(point.study.to_toml(), str((runs / point.run).resolve()), device, threads, point.files)


def with_positions(study: Study, vary: Mapping[str, Any]) -> dict[str, Any]:
    """Put parts of the measured disc where {positions = 12, seed = 1} stands for them in what is varied.

    Each part is as large as the domain, or the track, and lies anywhere in the file, as often as not over
    another. Raises InputError for a disc that is not measured, or too small for any choice.
    """
    positions = vary.get(CROP)
    if not isinstance(positions, Mapping):
        return dict(vary)
    number = positions.get("positions")
    if set(positions) - POSITIONS or not isinstance(number, int) or isinstance(number, bool) or number < 1:
        raise InputError(
            f"sweep.vary '{CROP}' = {dict(positions)!r}: {{positions = 12, seed = 1}} is expected, or a list."
        )
    disc = study.disc
    if disc.surface is None:
        raise InputError(f"sweep.vary '{CROP}' needs a measured disc, disc.surface; vary disc.synthetic.seed")
    reading = read(disc.surface, pixel=disc.pixel, height_unit=disc.height_unit, array=disc.array)
    rows = study.track.rows if study.is_swept else study.cells.nx
    needed = np.array([rows, study.cells.ny]) * study.grid.cell
    needed = needed[::-1] if disc.sliding_axis == "y" else needed
    pixel = np.asarray(reading.pixel)
    whole = np.asarray(reading.heights.shape) * pixel
    needed = needed + 2.0 * pixel  # cells at the rim lie between points
    if np.any(needed > whole):
        raise InputError(
            f"disc.surface '{disc.surface}' measures {whole[0]:.4g} × {whole[1]:.4g} mm: the part of "
            f"{needed[0]:.4g} × {needed[1]:.4g} mm that a run needs has no other place in it."
        )
    corners = np.random.default_rng(positions.get("seed", 0)).random((number, 2)) * (whole - needed)
    crops = [[f"{e:.9g} mm" for e in (x, x + needed[0], y, y + needed[1])] for x, y in corners.tolist()]
    return {**vary, CROP: crops}
