"""The table of a result's figures: their names, what draws them, why a run has none; how they are written.

Nothing here imports Matplotlib: a run only asks which figures there are, and another process draws them.
"""

from collections.abc import Callable, Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.figures import when
from warpwear.figures.data import FigureData
from warpwear.results.file import ResultFile
from warpwear.results.manifest import add_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

fs = lazy.module("warpwear.figures.style")


class Entry(NamedTuple):
    """A figure of the table: what draws it, as file:function of this folder, and why a run may have none."""

    place: str
    reasons: tuple[when.Reason, ...] = ()

    @property
    def draw(self) -> Callable[..., "Figure"]:
        """The function that draws it."""
        found: Callable[..., Figure] = lazy.resolve(f"{__package__}.{self.place}")
        return found


_FIELD = (when.NO_SNAPSHOT, when.ONLY_SAMPLES)
_SPHERE = (*_FIELD, when.UNWORN_SPHERE)
_DISC = (when.TRACK, *_FIELD, when.UNWORN_DISC)
_GROOVE = (when.STILL, when.NO_SNAPSHOT, when.NO_GROOVE)
_PATCHES = (when.ONE_SCALE, when.NO_SNAPSHOT)
_ROUGHNESS = (when.TRACK, when.SMOOTH_DISC, when.ONE_SNAPSHOT, when.UNWORN_DISC)

FIGURES: dict[str, Entry] = {
    "setup": Entry("shape:setup", _FIELD),
    "cof": Entry("history:cof", (when.NO_COURSE, when.NO_COF)),
    "cof_time": Entry("history:cof_time", (when.NO_COURSE, when.NO_COF, when.NO_TIME)),
    "areas": Entry("history:areas", (when.NO_COURSE,)),
    "pressure": Entry("history:pressure", (when.NO_COURSE,)),
    "contact_radius": Entry("history:contact_radius", (when.NO_COURSE, when.NO_RADIUS)),
    "volumes": Entry("history:volumes", (when.NO_COURSE, when.UNWORN)),
    "pressure_map": Entry("fields:pressure_map", _FIELD),
    "pressure_3d": Entry("fields:pressure_3d", _FIELD),
    "pressure_profiles": Entry("fields:pressure_profiles", _FIELD),
    "contact_map": Entry("fields:contact_map", _FIELD),
    "bare_map": Entry("fields:bare_map", (when.NO_FILM, *_FIELD)),
    "bare_fraction": Entry("history:bare_fraction", (when.NO_FILM, when.NO_COURSE)),
    "wear_map": Entry("shape:wear_map", (when.TRACK, *_FIELD, when.UNWORN)),
    "sphere_map": Entry("shape:sphere_map", _SPHERE),
    "sphere_3d": Entry("shape:sphere_3d", _SPHERE),
    "sphere_profiles": Entry("shape:sphere_profiles", _SPHERE),
    "disc_map": Entry("shape:disc_map", _DISC),
    "disc_3d": Entry("shape:disc_3d", _DISC),
    "disc_profiles": Entry("shape:disc_profiles", _DISC),
    "profiles": Entry("shape:profiles", _FIELD),
    "roughness": Entry("snapshots:roughness", _ROUGHNESS),
    "texture": Entry("snapshots:texture", (when.ONE_SNAPSHOT, when.UNWORN, when.SMOOTH, when.NO_TEXTURE)),
    "spectrum": Entry("snapshots:spectrum", (when.NO_SNAPSHOT, when.UNWORN, when.SMOOTH, when.NO_SPECTRUM)),
    "islands": Entry("snapshots:islands", (when.SMOOTH_DISC, when.ONE_SNAPSHOT, when.ONLY_SAMPLES)),
    "junctions": Entry("snapshots:junctions", (when.SMOOTH_DISC, when.NO_JUNCTIONS, *_FIELD)),
    "pieces": Entry("history:pieces", (when.NO_PIECES,)),
    "load_share": Entry("patches:load_share", _PATCHES),
    "patch_zoom": Entry("patches:patch_zoom", _PATCHES),
    "hertz": Entry("fields:hertz", (when.ROUGH, when.NO_HERTZ, when.NO_SNAPSHOT)),
    "distance_factor": Entry("fields:factor", (when.TRACK_FACTOR, when.NO_FACTOR, when.NO_SNAPSHOT)),
    "groove": Entry("track:groove_figure", _GROOVE),
    "track_map": Entry("track:track_map", _GROOVE),
    "wear_per_pass": Entry("track:wear_per_pass", (when.STILL, when.NO_COURSE, when.UNWORN)),
    "cof_stroke": Entry("track:cof_stroke", (when.STILL, when.NO_COURSE, when.NO_COF)),
    "track_roughness": Entry("track:track_roughness", (*_GROOVE, when.SMOOTH_DISC)),
}
#: Figures that are drawn by default, what goes into a paper -> the attributes of `FigureData` that they need.
ESSENTIAL: dict[str, tuple[str, ...]] = {
    "setup": ("relief",),
    "pressure_map": ("views", "window"),
    "contact_map": ("views", "window"),
    "bare_map": ("views", "window"),
    "bare_fraction": ("bare_fit",),
    "areas": (),
    "cof": (),
    "profiles": ("views",),
    "volumes": (),
    "hertz": ("hertz", "middle"),
    "load_share": ("loads",),
    "groove": ("grooves", "depth_along"),
    "track_map": ("track",),
    "wear_per_pass": ("passes",),
    "roughness": ("roughness",),
    "pieces": ("pieces",),
}


class Plotter:
    """Draws the figures of a result: `result.plot.NAME()` returns a matplotlib figure; `NAMES` lists them.

    A figure of a single panel, such as `cof`, can be drawn into axes that are there: `result.plot.cof(ax)`.
    `left_out` says which figures make no sense for the run, and why; `save_all` writes all others. A figure
    that is left out is an InputError, and so are axes for a figure of several panels.
    """

    NAMES = tuple(FIGURES)

    def __init__(self, result: ResultFile) -> None:
        self.data = FigureData(result)

    def __getattr__(self, name: str) -> Callable[..., "Figure"]:
        if name not in FIGURES:
            raise AttributeError(_unknown(name))
        draw = FIGURES[name].draw

        def figure(ax: "Axes | None" = None) -> "Figure":
            reason = self.reason(name)
            if reason is not None:
                raise InputError(f"there is no figure '{name}': {reason}")
            if ax is None:
                with self.data:
                    return draw(self.data)
            if not isinstance(draw, fs.Panels) or draw.columns > 1:
                raise InputError(
                    f"ax is given, but the figure '{name}' needs a figure of its own: it has several panels "
                    "or is drawn in three dimensions; call it without ax"
                )
            with self.data:
                return draw(self.data, ax)

        figure.__name__, figure.__doc__ = name, draw.__doc__
        return figure

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *FIGURES]

    def reason(self, name: str) -> str | None:
        """Say in a sentence why the run has no such figure; None if it has. Unknown names: InputError."""
        if name not in FIGURES:
            raise InputError(_unknown(name))
        return when.first_of(FIGURES[name].reasons, self.data)

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
        return [
            self.save(name, folder, file_format=file_format, drawn=drawn.get(name))
            for name in self.names(plots)
        ]

    def save(self, name: str, folder: Path, *, file_format: str = "png", drawn: bytes | None = None) -> Path:
        """Write one figure, or the file's content as it was drawn; returns its path.

        Raises InputError for a name or a format that is not known.
        """
        if drawn is None:
            self.check([name], file_format=file_format)
            drawn = fs.bytes_of(getattr(self, name)(), file_format)
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
        found: bytes = fs.bytes_of(getattr(self, name)(), dpi=dpi)
        return found

    def check(self, names: Sequence[str], *, file_format: str = "png") -> None:
        """Raise InputError for a name or a format that is not known, before anything is drawn."""
        fs.check_format(file_format)
        for name in names:
            if name not in FIGURES:
                raise InputError(_unknown(name))


def _unknown(name: str) -> str:
    near = get_close_matches(name, FIGURES, n=1, cutoff=0.6)
    hint = f" (did you mean '{near[0]}'?)" if near else ""
    return f"'{name}' is no figure{hint}; allowed: {', '.join(FIGURES)}"
