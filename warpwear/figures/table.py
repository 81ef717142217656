"""The table of a result's figures: their names, what declares them, why a run has none; how they are written.

Nothing here imports Matplotlib: a run only declares its figures, and another process draws them.
"""

from collections.abc import Callable, Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.figures import describe, fields, history, shape, snapshots, track, words
from warpwear.figures.data import FigureData
from warpwear.results.file import ResultFile
from warpwear.results.manifest import add_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

style, painter = lazy.module("warpwear.figures.style"), lazy.module("warpwear.figures.paint")
colours = lazy.module("matplotlib.colors")


class Entry(NamedTuple):
    """A figure of the table: what declares it, what stands below it, and why a run may have none.

    caption: a template with fields of `words.FIELDS`; the law of contact is said behind it. essential: whether
    it goes into a paper, and is drawn by default.
    """

    declare: Callable[[FigureData], describe.Figure]
    caption: str
    reasons: tuple[words.Reason, ...] = ()
    essential: bool = False


_FIELD = (words.NO_SNAPSHOT, words.ONLY_SAMPLES)
_SPHERE = (*_FIELD, words.UNWORN_SPHERE)
_DISC = (words.TRACK, *_FIELD, words.UNWORN_DISC)
_GROOVE = (words.STILL, words.NO_SNAPSHOT, words.NO_GROOVE)
_PATCHES = (words.ONE_SCALE, words.NO_SNAPSHOT)
_ROUGHNESS = (words.TRACK, words.SMOOTH_DISC, words.ONE_SNAPSHOT, words.UNWORN_DISC)

FIGURES: dict[str, Entry] = {
    "setup": Entry(
        shape.setup,
        "The {slider} on the unworn disc at first contact, its near half cut away; heights are "
        "exaggerated as the figure says.",
        _FIELD,
        essential=True,
    ),
    "cof": Entry(
        history.cof,
        "Coefficient of friction over the sliding distance. {friction}{passes}",
        (words.NO_COURSE, words.NO_COF),
        essential=True,
    ),
    "cof_time": Entry(
        history.cof_time,
        "Coefficient of friction over the sliding time. {friction}",
        (words.NO_COURSE, words.NO_COF, words.NO_TIME),
    ),
    "areas": Entry(
        history.areas,
        "Real areas of contact and the nominal area of the scar, its ellipse, over the sliding "
        "distance.{passes}",
        (words.NO_COURSE,),
        essential=True,
    ),
    "pressure": Entry(
        history.pressure,
        "Mean and largest pressure of the cells in contact over the sliding distance.{fall}{passes}",
        (words.NO_COURSE,),
    ),
    "contact_radius": Entry(
        history.contact_radius,
        "Radii of circles of the scar's nominal area and of the area in contact over the sliding "
        "distance: where they meet the contact fills its scar.{passes}",
        (words.NO_COURSE, words.NO_RADIUS),
    ),
    "volumes": Entry(
        history.volumes,
        "Worn volume and depth of the deepest cell of {slider} and disc over the sliding distance.",
        (words.NO_COURSE, words.UNWORN),
        essential=True,
    ),
    "pressure_map": Entry(
        fields.pressure_map,
        "Pressure of the cells in contact {when}, all on one scale; above each its mean and standard "
        "deviation over these cells.{blocks}",
        _FIELD,
        essential=True,
    ),
    "pressure_3d": Entry(
        fields.pressure_3d,
        "Load over area of coarse squares, cells without contact included, at the first and the last "
        "distance kept; axes differ, colours are of one scale.",
        _FIELD,
    ),
    "pressure_profiles": Entry(
        fields.pressure_profiles,
        "Pressure along and across sliding in a strip through the middle {when}, means that include "
        "cells without contact.",
        _FIELD,
    ),
    "contact_map": Entry(
        fields.contact_map,
        "State of the cells {when}; above each the area in contact.{blocks}",
        _FIELD,
        essential=True,
    ),
    "bare_map": Entry(
        fields.bare_map,
        "Where the film is gone {when}; above each the bare part of the area in contact.{blocks}",
        (words.NO_FILM, *_FIELD),
        essential=True,
    ),
    "bare_fraction": Entry(
        history.bare_fraction,
        "Part of the area in contact that is bare of film over the sliding distance, and its fitted "
        "course.{passes}",
        (words.NO_FILM, words.NO_COURSE),
        essential=True,
    ),
    "wear_map": Entry(
        shape.wear_map, "Wear depth of {slider} and disc {end}.", (words.TRACK, *_FIELD, words.UNWORN)
    ),
    "sphere_map": Entry(
        shape.sphere_map,
        "Height of the {slider}, turned over, unworn and at distances slid; lines are of equal height, "
        "and far apart where it is worn flat.",
        _SPHERE,
    ),
    "sphere_3d": Entry(
        shape.sphere_3d, "The {slider}, turned over, unworn and {end}; pale where it is worn.", _SPHERE
    ),
    "sphere_profiles": Entry(
        shape.sphere_profiles, "Sections of the {slider} through the middle, unworn and {when}.", _SPHERE
    ),
    "disc_map": Entry(
        shape.disc_map, "Height of the disc, unworn and at distances slid, on one scale.", _DISC
    ),
    "disc_3d": Entry(shape.disc_3d, "The disc, unworn and {end}.", _DISC),
    "disc_profiles": Entry(
        shape.disc_profiles, "Sections of the disc through the middle, unworn and {when}.", _DISC
    ),
    "profiles": Entry(
        shape.profiles,
        "Sections of both bodies through the middle in contact {end}, and without their wear.",
        _FIELD,
        essential=True,
    ),
    "roughness": Entry(
        snapshots.roughness,
        "Height parameters (ISO 25178-2) of the disc in the middle of the scar, its bowl taken off, over "
        "the sliding distance.",
        _ROUGHNESS,
        essential=True,
    ),
    "texture": Entry(
        snapshots.texture,
        "Root mean square height Sq and gradient Sdq of both bodies in the inner scar over the sliding "
        "distance; dashed, the exponential course fitted to Sq.",
        (words.ONE_SNAPSHOT, words.UNWORN, words.SMOOTH, words.NO_TEXTURE),
    ),
    "spectrum": Entry(
        snapshots.spectrum,
        "Power spectral density of both bodies in the inner scar {when}.",
        (words.NO_SNAPSHOT, words.UNWORN, words.SMOOTH, words.NO_SPECTRUM),
    ),
    "islands": Entry(
        snapshots.islands,
        "Number of islands of contact over the sliding distance, and of those at least as large as an "
        "area {when}; islands of one cell are limits of the mesh.",
        (words.SMOOTH_DISC, words.ONE_SNAPSHOT, words.ONLY_SAMPLES),
    ),
    "junctions": Entry(
        snapshots.junctions,
        "Share of the area in contact that lies in islands larger than a diameter {when}.{critical}",
        (words.SMOOTH_DISC, words.NO_JUNCTIONS, *_FIELD),
    ),
    "pieces": Entry(
        history.pieces,
        "Diameters of the pieces as they were cut, and how many left {slider} and disc per distance slid.",
        (words.NO_PIECES,),
        essential=True,
    ),
    "load_share": Entry(
        fields.load_share, "Load of each patch over its area {when}{smooth}.", _PATCHES, essential=True
    ),
    "patch_zoom": Entry(
        fields.patch_zoom,
        "From the load of the patches to the pressure of the cells of one that carries half of the most.",
        _PATCHES,
    ),
    "hertz": Entry(
        fields.hertz,
        "Pressure along sliding through the middle at the first and the last distance kept, beside "
        "Hertz's of the unworn bodies.",
        (words.ROUGH, words.NO_HERTZ, words.NO_SNAPSHOT),
        essential=True,
    ),
    "distance_factor": Entry(
        fields.factor,
        "Sliding distance of cells of the disc over that of the middle.",
        (words.TRACK_FACTOR, words.NO_FACTOR, words.NO_SNAPSHOT),
    ),
    "groove": Entry(
        track.groove,
        "Mean cross-section of the groove {when}, and its mean depth along the track {end}.",
        _GROOVE,
        essential=True,
    ),
    "track_map": Entry(
        track.track_map,
        "Height of the whole track {end}, and what wear and plastic flow took off it.",
        _GROOVE,
        essential=True,
    ),
    "wear_per_pass": Entry(
        track.wear_per_pass,
        "Mean depth that each pass adds to the groove, over the width of the contact.",
        (words.STILL, words.NO_COURSE, words.NO_GROOVE),
        essential=True,
    ),
    "cof_stroke": Entry(
        track.cof_stroke,
        "Coefficient of friction over the position in the stroke, of some passes. {friction}",
        (words.STILL, words.NO_COURSE, words.NO_COF),
    ),
    "track_roughness": Entry(
        track.track_roughness,
        "Height parameters (ISO 25178-2) of the disc in the middle of the groove over the passes.",
        (*_GROOVE, words.SMOOTH_DISC),
    ),
}
#: The file of captions beside figures, and its first line, by which it is known as ours.
CAPTIONS, HEAD = "captions.md", "# Captions of the figures, by warpwear"
#: Figures that are drawn by default.
ESSENTIAL = tuple(name for name, entry in FIGURES.items() if entry.essential)


class Plotter:
    """Draws the figures of a result: `result.plot.NAME()` returns a matplotlib figure; `NAMES` lists them.

    Figures of lines, such as `cof`, can be drawn into axes that are there, over another run's:
    `result.plot.cof(ax, label="8 N", color="C1")`; of two panels `ax` is two axes. `left_out` says which
    figures make no sense for the run, and why; `save_all` writes all others. A figure that is left out is an
    InputError, and so are ax, label and color for maps and pictures in 3-D.
    """

    NAMES = tuple(FIGURES)

    def __init__(self, result: ResultFile) -> None:
        self.data = FigureData(result)
        self._declared: dict[str, describe.Figure] = {}

    def __getattr__(self, name: str) -> Callable[..., "Figure"]:
        if name not in FIGURES:
            raise AttributeError(_unknown(name))

        def figure(ax: Any = None, *, label: str | None = None, color: Any = None) -> "Figure":
            declared = self.declared(name)
            if ax is None and label is None and color is None:
                return painter.paint(declared)
            _check_overlay(name, declared, ax, color)
            declared = painter.of_run(declared, label=label, color=color)
            return painter.paint(declared) if ax is None else painter.paint_over(declared, np.ravel(ax))

        figure.__name__, figure.__doc__ = name, FIGURES[name].declare.__doc__
        return figure

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *FIGURES]

    def declared(self, name: str) -> describe.Figure:
        """Say what a figure shows. Raises InputError for an unknown name, and for one that the run has not."""
        reason = self.reason(name)
        if reason is not None:
            raise InputError(f"there is no figure '{name}': {reason}")
        if name not in self._declared:
            with self.data:
                self._declared[name] = FIGURES[name].declare(self.data)
        return self._declared[name]

    def reason(self, name: str) -> str | None:
        """Say in a sentence why the run has no such figure; None if it has. Unknown names: InputError."""
        if name not in FIGURES:
            raise InputError(_unknown(name))
        return words.first_of(FIGURES[name].reasons, self.data)

    @property
    def left_out(self) -> dict[str, str]:
        """Name -> reason, of the figures that make no sense for this run."""
        return {name: why for name in FIGURES if (why := self.reason(name))}

    def names(self, plots: str = "all") -> list[str]:
        """Names of the figures that the run has: "all", or only "essential" ones."""
        return [name for name in (ESSENTIAL if plots == "essential" else FIGURES) if not self.reason(name)]

    def save_all(
        self,
        folder: Path,
        *,
        plots: str = "all",
        file_format: str = "png",
        drawn: Mapping[str, bytes] = MappingProxyType({}),
    ) -> list[Path]:
        """Write all figures but `left_out` into the folder; returns their paths.

        plots: "all", or only "essential" ones. file_format: of FORMATS. drawn: name -> what is to be written.
        """
        paths = [
            self.save(name, folder, file_format=file_format, drawn=drawn.get(name))
            for name in self.names(plots)
        ]
        self.save_captions(folder)
        return paths

    def caption(self, name: str) -> str:
        """Return what stands below a figure: what it shows, at which distance, by which law.

        Raises InputError for an unknown name.
        """
        if name not in FIGURES:
            raise InputError(_unknown(name))
        with self.data:
            return (FIGURES[name].caption + " {law}").format_map(words.Fields(self.data))

    def save_captions(self, folder: Path) -> None:
        """Write captions.md, of the figures that lie in the folder; a file of others is left alone."""
        path = folder / CAPTIONS
        names = [name for name in FIGURES if any(folder.glob(f"{name}.*")) and not self.reason(name)]
        try:
            if not names or (path.exists() and not path.read_bytes().startswith(HEAD.encode())):
                return
            texts = [f"**{name}**: {self.caption(name)}" for name in names]
            path.write_text("\n\n".join([HEAD, *texts]) + "\n", encoding="utf-8")
            add_figure(path)
        except OSError as error:
            raise InputError(f"{path} cannot be written: {error.strerror}.") from error

    def save(self, name: str, folder: Path, *, file_format: str = "png", drawn: bytes | None = None) -> Path:
        """Write one figure, or the file's content as it was drawn; returns its path.

        Raises InputError for a name or a format that is not known.
        """
        if drawn is None:
            self.check([name], file_format=file_format)
            drawn = style.bytes_of(getattr(self, name)(), file_format)
        path = folder / f"{name}.{file_format}"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            path.write_bytes(drawn)
            add_figure(path)
        except OSError as error:
            raise InputError(f"{path} cannot be written: {error.strerror}.") from error
        return path

    def png(self, name: str, *, dpi: int) -> bytes:
        """Draw one figure; returns the bytes of a PNG file. Raises InputError for an unknown name."""
        png: bytes = style.bytes_of(getattr(self, name)(), dpi=dpi)
        return png

    def check(self, names: Sequence[str], *, file_format: str = "png") -> None:
        """Raise InputError for a name or a format that is not known, before anything is drawn."""
        style.check_format(file_format)
        for name in names:
            if name not in FIGURES:
                raise InputError(_unknown(name))


def _check_overlay(name: str, figure: describe.Figure, ax: Any, color: Any) -> None:
    """Raise InputError where a figure cannot be drawn into these axes, or in this colour."""
    if not all(isinstance(panel, describe.Chart) for panel in figure.panels):
        raise InputError(
            f"the figure '{name}' is a map or drawn in three dimensions: it needs a figure of its own, "
            "without ax, label and color"
        )
    if ax is not None and np.size(ax) != len(figure.panels):
        raise InputError(
            f"the figure '{name}' needs as many axes as it has panels: ax has {np.size(ax)}, and "
            f"plt.subplots(1, {len(figure.panels)}) makes {len(figure.panels)}"
        )
    if color is not None and not colours.is_color_like(color):
        raise InputError(f"color = {color!r} is not a colour of matplotlib, such as 'C1' or '#D55E00'")


def _unknown(name: str) -> str:
    near = get_close_matches(name, FIGURES, n=1, cutoff=0.6)
    hint = f" (did you mean '{near[0]}'?)" if near else ""
    return f"'{name}' is no figure{hint}; allowed: {', '.join(FIGURES)}"
