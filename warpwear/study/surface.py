"""The sections [disc] and [counter] say what the bodies' surfaces are; here they are made or read."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import fields, replace
from pathlib import Path

import numpy as np

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.laws.bearing_curve import Logistic
from warpwear.laws.form import Ball, Form, Given
from warpwear.laws.track import WHOLE
from warpwear.study.bodies import Disc, MeasuredBody, Synthetic
from warpwear.study.study import Study
from warpwear.surfaces.base import Surface
from warpwear.surfaces.made.like import LikeProfile
from warpwear.surfaces.made.milled import Milled
from warpwear.surfaces.made.self_affine import SelfAffine
from warpwear.surfaces.made.synthetic import Flat
from warpwear.surfaces.measured import Measured, read_measured
from warpwear.surfaces.preparation import Preparation
from warpwear.surfaces.profiles.profile import profile_in
from warpwear.surfaces.reading import HoldsAProfile
from warpwear.surfaces.roughness import material_ratio_curve

optimize = lazy.module("scipy.optimize")

#: What the record says of a levelled cylinder that lies along sliding.
LYING = "cylinder along x"
#: Points along a side at which a bearing area curve is taken.
FINE = 1000


def surface_in(study: Study) -> Surface:
    """Return what the ball slides on: the disc's surface, flat in the macro model. Raises InputError."""
    if study.study.model == "macro":
        return Flat()
    surface = surface_of(study.disc)
    if study.is_swept and isinstance(surface, Measured) and surface.extend == "refuse":
        _check_track(study, surface.size[0])
    return surface


def _check_track(study: Study, length: float) -> None:
    """Refuse a track that is longer than the measured disc. length: of the measurement along sliding [mm]."""
    track, sliding = study.track, study.sliding
    needed = track.rows * track.cell
    if needed <= length * (1.0 + WHOLE):
        return
    step = track.shift * track.cell
    most = math.floor(length / step * (1.0 + WHOLE)) * step
    shorter = f"sliding.track = '{most:.9g} mm' or less, of which a lap stands for a pass, and "
    text = sliding.track if sliding.track == "full" else f"{sliding.track:g} mm"
    raise InputError(
        f"sliding.track = {text} needs {needed:.4g} mm of the disc along the sliding direction, and "
        f"disc.surface has {length:.4g} mm of it: allowed are "
        f"{shorter if most >= study.grid.sides[0] else ''}"
        "disc.extend = 'mirror' or 'periodic'."
    )


def bearing_curve_of(study: Study) -> Logistic:
    """Return the bearing area curve of the study's disc over its domain. Raises InputError for a flat one."""
    grid = study.cells
    places = np.linspace(grid.x[0], grid.x[-1], FINE)
    heights = surface_of(study.disc).heights(places, places)
    try:
        return fit_bearing_curve(heights)
    except ValueError as error:
        raise InputError(f"wear.law = 'bearing-curve' needs a rough disc: {error}.") from error


def fit_bearing_curve(heights: FloatArray) -> Logistic:
    """Return the logistic function nearest, by least squares, to the bearing area curve of heights.

    heights: [mm], of any shape. Raises ValueError for flat ones.
    """
    percent, reached = material_ratio_curve(heights)
    depth, ratio = float(np.max(heights)) - reached, percent / 100.0
    spread = float(np.std(heights))
    if not spread > 0.0:
        raise ValueError("a flat surface has no bearing area curve")

    def logistic(z: FloatArray, middle: float, scale: float) -> FloatArray:
        return np.asarray(0.5 * (1.0 + np.tanh(0.5 * (z - middle) / scale)))

    start = (float(np.median(depth)), np.sqrt(3.0) / np.pi * spread)
    (middle, scale), _ = optimize.curve_fit(logistic, depth, ratio, p0=start, bounds=(0.0, np.inf))
    return Logistic(float(middle), float(scale))


def surface_of(disc: Disc) -> Surface:
    """Return the disc's surface. Raises InputError, naming the field of ``disc``, where it cannot be used."""
    synthetic = disc.synthetic
    if synthetic is None:
        return _measured(disc)
    if synthetic.kind == "flat":
        return Flat()
    if synthetic.kind == "profile":
        return _like(synthetic)
    kind = SelfAffine if synthetic.kind == "self-affine" else Milled
    return kind(**{field.name: getattr(synthetic, field.name) for field in fields(kind)})


def _like(synthetic: Synthetic) -> LikeProfile:
    """Return a surface like the profile in a file. Raises InputError."""
    path = str(synthetic.like)
    try:
        profile = profile_in(path)
    except InputError as error:
        text = str(error).replace("disc.surface", "disc.synthetic.like")
        if text.startswith(("disc.pixel", "disc.height_unit")):
            units = "allowed is a file that does, such as text under a line 'x [mm]; z [um]'"
            text = f"disc.synthetic.like '{path}' does not say its units and spacing: {units}"
        raise InputError(text) from error
    own = {name: getattr(synthetic, name) for name in ("seed", "period", "cut_off", "lay", "lay_length")}
    return LikeProfile(profile=profile, like=Path(path).name, digest=profile.about["sha256"], **own)


def counter_surface(study: Study) -> Measured | None:
    """Return what was measured of the counter-body; None of another shape. Raises InputError."""
    if study.counter.shape != "measured":
        return None
    with _of_counter():
        return _measured(study.counter)


def form_of(study: Study, surface: Measured | None) -> Form:
    """Return the unworn counter-body's form, of a measured one the heights turned over on the domain's cells.

    surface: as of `counter_surface`. Raises InputError where it is smaller than the domain.
    """
    form, grid = study.counter.form, study.cells
    if surface is None or not isinstance(form, Given):
        return form
    if study.counter.level == "cylinder" and any(LYING in text for text in surface.details["operations"]):
        raise InputError(
            f"counter.surface = '{study.counter.surface}' shows a cylinder along sliding, and counter.level "
            "= 'cylinder' puts one back that lies across it: allowed are the other counter.sliding_axis, or "
            "counter.level = 'plane', which keeps the file's."
        )
    with _of_counter():
        seen = surface.heights(grid.x, -grid.y[::-1])[:, ::-1]
    nominal = Ball(form.along, form.across) if form.across else Form(form.along)
    heights = nominal.heights(grid.x, grid.y) - seen
    return replace(form, values=heights - heights.min())


@contextmanager
def _of_counter() -> Iterator[None]:
    """Name the keys of [counter] in what is said of a file, whose readers speak of the disc's."""
    try:
        yield
    except InputError as error:
        raise InputError(str(error).replace("disc.", "counter.")) from error


def _measured(body: MeasuredBody) -> Measured:
    """Read a body's file, of a disc also a profile. Raises InputError, naming the field of ``disc``."""
    preparation = Preparation(**{field.name: getattr(body, field.name) for field in fields(Preparation)})
    how = {name: getattr(body, name) for name in ("extend", "pixel", "height_unit", "array")}
    try:
        return read_measured(str(body.surface), preparation, **how)
    except HoldsAProfile:
        if not isinstance(body, Disc):
            raise
        return read_measured(str(body.surface), preparation, profile=True, **how)
