"""Figures of a result: the table of their names, when each makes sense, and how they are written."""

import io
from collections.abc import Callable, Sequence
from difflib import get_close_matches
from functools import wraps
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from warpwear.errors import InputError
from warpwear.figures import fields as figures_fields
from warpwear.figures import history as figures_history
from warpwear.figures import macro as figures_macro
from warpwear.figures import patches as figures_patches
from warpwear.figures import shape as figures_setup
from warpwear.figures import shape as figures_shape
from warpwear.figures import snapshots as figures_evolution
from warpwear.figures import snapshots as figures_junctions
from warpwear.figures import style as figure_style
from warpwear.figures import track as figures_track
from warpwear.figures.data import FigureData
from warpwear.results.file import ResultFile

FORMATS = ("png", "pdf", "svg")
#: Says in one sentence why a run has no such figure; None if it has.
Reason = Callable[[FigureData], str | None]


class Entry(NamedTuple):
    """A figure of the table."""

    draw: Callable[[FigureData], Figure]
    reasons: tuple[Reason, ...] = ()


class Plotter:
    """`result.plot.NAME()` returns a matplotlib figure; `save_all` writes every figure that the run has."""

    NAMES: tuple[str, ...]

    def __init__(self, result: ResultFile) -> None:
        self._data = FigureData(result)

    def __getattr__(self, name: str) -> Callable[[], Figure]:
        if name not in FIGURES:
            raise AttributeError(_unknown(name))
        draw = FIGURES[name].draw

        @wraps(draw)
        def figure() -> Figure:
            reason = self.reason(name)
            if reason is not None:
                raise InputError(f"there is no figure '{name}': {reason}")
            return draw(self._data)

        return figure

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *FIGURES]

    def reason(self, name: str) -> str | None:
        """Why the run has no such figure, in one sentence; None if it has. InputError for an unknown name."""
        if name not in FIGURES:
            raise InputError(_unknown(name))
        return next((why for reason in FIGURES[name].reasons if (why := reason(self._data))), None)

    @property
    def left_out(self) -> dict[str, str]:
        """Name -> reason, of the figures that make no sense for this run."""
        return {name: why for name in FIGURES if (why := self.reason(name))}

    def save_all(self, folder: Path, *, file_format: str = "png") -> list[Path]:
        """Write all figures but `left_out` into the folder; returns their paths. file_format: of FORMATS."""
        left_out = self.left_out
        return [self.save(name, folder, file_format=file_format) for name in FIGURES if name not in left_out]

    def save(self, name: str, folder: Path, *, file_format: str = "png") -> Path:
        """Write one figure; returns its path. InputError for a name or a format that is not known."""
        self.check([name], file_format=file_format)
        figure: Figure = getattr(self, name)()
        path = folder / f"{name}.{file_format}"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            # Without a date the same run gives the same file.
            with figure_style.style():
                figure.savefig(path, metadata={} if file_format == "png" else {_DATE[file_format]: None})
        except OSError as error:
            raise InputError(f"{path} cannot be written: {error.strerror}.") from error
        return path

    def png(self, name: str, *, dpi: int) -> bytes:
        """One figure as the bytes of a PNG file. Raises InputError for a name that is not known."""
        written = io.BytesIO()
        with figure_style.style():
            getattr(self, name)().savefig(written, format="png", dpi=dpi)
        return written.getvalue()

    def check(self, names: Sequence[str], *, file_format: str = "png") -> None:
        """InputError for a name or a format that is not known, before anything is drawn."""
        if file_format not in FORMATS:
            raise InputError(f"format = '{file_format}' is not known; allowed: {', '.join(FORMATS)}")
        for name in names:
            if name not in FIGURES:
                raise InputError(_unknown(name))


_DATE = {"pdf": "CreationDate", "svg": "Date"}


def _unknown(name: str) -> str:
    near = get_close_matches(name, FIGURES, n=1, cutoff=0.6)
    hint = f" (did you mean '{near[0]}'?)" if near else ""
    return f"'{name}' is no figure{hint}; allowed: {', '.join(FIGURES)}"


def _no_course(data: FigureData) -> str | None:
    if data.steps < 2:
        return "the run has one step, so nothing changes over the distance"
    return None


def _no_cof(data: FigureData) -> str | None:
    if not np.isfinite(data.history["cof"]).any():
        return "the coefficient of friction is calibrated at the end, which the run did not reach"
    return None


def _no_time(data: FigureData) -> str | None:
    if not np.isfinite(data.history["time"]).any():
        return "sliding.speed is not given, so there is no time"
    return None


def _no_curvature(data: FigureData) -> str | None:
    if data.study.sphere.curvature == 0.0:
        return "a rigid flat has no radius of contact"
    return None


def _no_snapshot(data: FigureData) -> str | None:
    if data.result.snapshot_distances.size == 0:
        return "the run was interrupted before its first snapshot"
    return None


def _one_snapshot(data: FigureData) -> str | None:
    if data.result.snapshot_distances.size < 2:
        return "one snapshot shows no course; ask for more with output.snapshots"
    return None


def _smooth_disc(data: FigureData) -> str | None:
    disc = data.study.disc.synthetic
    if data.study.study.model == "macro" or (disc is not None and disc.kind == "flat"):
        return "a smooth disc has neither roughness nor islands"
    return None


def _only_samples(data: FigureData) -> str | None:
    if data.study.samples_area:
        return "the patches cover a part of the area only: see load_share and patch_zoom"
    return None


def _no_patches(data: FigureData) -> str | None:
    if data.study.study.model != "two-scale":
        return "the run has one scale: no patches share the load"
    return None


def _no_hertz(data: FigureData) -> str | None:
    if data.study.study.model != "macro":
        return "a rough contact has no profile that Hertz's could stand beside"
    if data.study.hertz is None:
        return "the elastic constants of sphere and disc are not all known, or there is no sphere"
    return None


def _no_factor(data: FigureData) -> str | None:
    if data.study.is_swept:
        return "a sphere that slides over its track has no factor of the distance"
    if data.study.wear.distance_factor == "none":
        return "wear.distance_factor is none: all cells slide as far"
    return None


def _no_junctions(data: FigureData) -> str | None:
    if data.study.critical_junction is None:
        return "the critical size of junctions needs junctions.surface_energy and the softer body's constants"
    return None


def _still(data: FigureData) -> str | None:
    if not data.study.is_swept:
        return "the disc lies still: sliding.kinematics = 'swept' makes a track"
    return None


def _sliding(data: FigureData) -> str | None:
    if data.study.is_swept:
        return "the disc's wear covers a track: see groove, track_map and track_roughness"
    return None


def _no_wear_of(*bodies: str) -> Reason:
    def reason(data: FigureData) -> str | None:
        if not any(data.history[f"wear_depth_{body}"][-1] > 0.0 for body in bodies):
            return f"nothing is worn off the {' or the '.join(bodies)}"
        return None

    return reason


def _no_groove(data: FigureData) -> str | None:
    lost = ("wear_depth_disc", "plastic_volume_disc")
    if not any(data.history[name][-1] > 0.0 for name in lost):
        return "nothing is worn or pressed off the disc"
    return None


_FIELD = (_no_snapshot, _only_samples)
_SPHERE = (*_FIELD, _no_wear_of("sphere"))
_DISC = (_sliding, *_FIELD, _no_wear_of("disc"))
_GROOVE = (_still, _no_snapshot, _no_groove)
_BOTH = _no_wear_of("sphere", "disc")

FIGURES: dict[str, Entry] = {
    "setup": Entry(figures_setup.setup, _FIELD),
    "cof": Entry(figures_history.cof, (_no_course, _no_cof)),
    "cof_time": Entry(figures_history.cof_time, (_no_course, _no_cof, _no_time)),
    "areas": Entry(figures_history.areas, (_no_course,)),
    "pressure": Entry(figures_history.pressure, (_no_course,)),
    "contact_radius": Entry(figures_history.contact_radius, (_no_course, _no_curvature)),
    "volumes": Entry(figures_history.volumes, (_no_course, _BOTH)),
    "pressure_map": Entry(figures_fields.pressure_map, _FIELD),
    "pressure_3d": Entry(figures_fields.pressure_3d, _FIELD),
    "pressure_profiles": Entry(figures_fields.pressure_profiles, _FIELD),
    "contact_map": Entry(figures_fields.contact_map, _FIELD),
    "wear_map": Entry(figures_shape.wear_map, (_sliding, *_FIELD, _BOTH)),
    "sphere_map": Entry(figures_shape.sphere_map, _SPHERE),
    "sphere_3d": Entry(figures_shape.sphere_3d, _SPHERE),
    "sphere_profiles": Entry(figures_shape.sphere_profiles, _SPHERE),
    "disc_map": Entry(figures_shape.disc_map, _DISC),
    "disc_3d": Entry(figures_shape.disc_3d, _DISC),
    "disc_profiles": Entry(figures_shape.disc_profiles, _DISC),
    "profiles": Entry(figures_shape.profiles, _FIELD),
    "roughness": Entry(
        figures_evolution.roughness, (_sliding, _smooth_disc, _one_snapshot, _no_wear_of("disc"))
    ),
    "islands": Entry(figures_evolution.islands, (_smooth_disc, _one_snapshot, _only_samples)),
    "junctions": Entry(figures_junctions.junctions, (_smooth_disc, _no_junctions, *_FIELD)),
    "load_share": Entry(figures_patches.load_share, (_no_patches, _no_snapshot)),
    "patch_zoom": Entry(figures_patches.patch_zoom, (_no_patches, _no_snapshot)),
    "hertz": Entry(figures_macro.hertz, (_no_hertz, _no_snapshot)),
    "distance_factor": Entry(figures_macro.factor, (_no_factor, _no_snapshot)),
    "groove": Entry(figures_track.groove_figure, _GROOVE),
    "track_map": Entry(figures_track.track_map, _GROOVE),
    "wear_per_pass": Entry(figures_track.wear_per_pass, (_still, _no_course, _BOTH)),
    "cof_stroke": Entry(figures_track.cof_stroke, (_still, _no_course, _no_cof)),
    "track_roughness": Entry(figures_track.track_roughness, (*_GROOVE, _smooth_disc)),
}
Plotter.NAMES = tuple(FIGURES)
