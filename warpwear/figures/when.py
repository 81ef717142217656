"""When a run has no such figure, and why: each reason is a test of the run and a sentence for people."""

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from warpwear.figures.data import FigureData


class Reason(NamedTuple):
    """Why a figure is left out of the runs that the test picks."""

    applies: Callable[[FigureData], bool]
    sentence: str


def first_of(reasons: Iterable[Reason], data: FigureData) -> str | None:
    """Return the sentence of the first reason that applies to a run; None where none does."""
    return next((reason.sentence for reason in reasons if reason.applies(data)), None)


def _is_smooth(data: FigureData) -> bool:
    disc = data.study.disc.synthetic
    return data.study.study.model == "macro" or (disc is not None and disc.kind == "flat")


def _lost_nothing(*columns: str) -> Callable[[FigureData], bool]:
    """Test whether none of these columns of the history ends above zero."""
    return lambda data: not any(data.history[name][-1] > 0.0 for name in columns)


NO_COURSE = Reason(lambda d: d.steps < 2, "the run has one step, so nothing changes over the distance")
NO_COF = Reason(
    lambda d: not np.isfinite(d.history["cof"]).any(),
    "the coefficient of friction is calibrated at the end, which the run did not reach",
)
NO_FILM = Reason(lambda d: d.study.film is None, "the bodies carry no film: see friction.film")
NO_TIME = Reason(
    lambda d: not np.isfinite(d.history["time"]).any(), "sliding.speed is not given, so there is no time"
)
NO_RADIUS = Reason(lambda d: d.study.sphere.curvature == 0.0, "a rigid flat has no radius of contact")
NO_SNAPSHOT = Reason(
    lambda d: d.result.snapshot_distances.size == 0, "the run was interrupted before its first snapshot"
)
ONE_SNAPSHOT = Reason(
    lambda d: d.result.snapshot_distances.size < 2,
    "one snapshot shows no course; ask for more with output.snapshots",
)
SMOOTH_DISC = Reason(_is_smooth, "a smooth disc has neither roughness nor islands")
SMOOTH = Reason(
    lambda d: _is_smooth(d) and not d.study.wear.sheds, "smooth bodies that lose no pieces have no roughness"
)
NO_TEXTURE = Reason(
    lambda d: not any(np.isfinite(d.roughness[f"sq_{body}"]).any() for body in ("sphere", "disc")),
    "the scar has too few cells to tell its roughness",
)
NO_SPECTRUM = Reason(
    lambda d: not all(d.spectra.values()),
    "the scar has too few cells for a spectrum, or patches cover a part",
)
ONLY_SAMPLES = Reason(
    lambda d: d.study.samples_area, "the patches cover a part of the area only: see load_share and patch_zoom"
)
ONE_SCALE = Reason(
    lambda d: d.study.study.model != "two-scale", "the run has one scale: no patches share the load"
)
ROUGH = Reason(
    lambda d: d.study.study.model != "macro", "a rough contact has no profile that Hertz's could stand beside"
)
NO_HERTZ = Reason(
    lambda d: d.study.hertz is None,
    "the elastic constants of sphere and disc are not all known, or there is no sphere",
)
NO_FACTOR = Reason(
    lambda d: d.study.wear.distance_factor == "none", "wear.distance_factor is none: all cells slide as far"
)
NO_JUNCTIONS = Reason(
    lambda d: d.study.critical_junction is None,
    "the critical size of junctions needs junctions.surface_energy and the softer body's constants",
)
NO_PIECES = Reason(
    lambda d: not d.study.wear.sheds or d.result.pieces["step"].size < 2,
    "wear leaves at once, or fewer than two pieces have left: see wear.particle",
)
STILL = Reason(
    lambda d: not d.study.is_swept, "the disc lies still: sliding.kinematics = 'swept' makes a track"
)
TRACK = Reason(
    lambda d: d.study.is_swept, "the disc's wear covers a track: see groove, track_map and track_roughness"
)
TRACK_FACTOR = Reason(
    lambda d: d.study.is_swept, "a sphere that slides over its track has no factor of the distance"
)
UNWORN = Reason(
    _lost_nothing("wear_depth_sphere", "wear_depth_disc"), "nothing is worn off the sphere or the disc"
)
UNWORN_SPHERE = Reason(_lost_nothing("wear_depth_sphere"), "nothing is worn off the sphere")
UNWORN_DISC = Reason(_lost_nothing("wear_depth_disc"), "nothing is worn off the disc")
NO_GROOVE = Reason(
    _lost_nothing("wear_depth_disc", "plastic_volume_disc"), "nothing is worn or pressed off the disc"
)
