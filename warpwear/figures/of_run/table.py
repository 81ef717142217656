"""The table of a result's figures by name, and how they are drawn and written.

Nothing here imports Matplotlib: a run only declares its figures, and another process draws them.
"""

from collections.abc import Callable, Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from warpwear import lazy
from warpwear.errors import InputError, explained
from warpwear.figures import describe
from warpwear.figures.blocks import with_blocks
from warpwear.figures.of_run import fields, fretting, history, layers, shape, snapshots, stresses, track
from warpwear.figures.of_run.data import FigureData
from warpwear.figures.of_run.words import FIGURES, DeclaredFigure, first_of
from warpwear.results.file import ResultFile
from warpwear.results.manifest import add_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

style, painter = lazy.module("warpwear.figures.style"), lazy.module("warpwear.figures.paint")
overlay = lazy.module("warpwear.figures.overlay")
colours = lazy.module("matplotlib.colors")

#: What declares the figures of a run; importing them fills `FIGURES`.
DECLARED_IN = (history, fields, layers, shape, snapshots, stresses, track, fretting)
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
            declared = overlay.of_run(declared, label=label, color=color)
            return painter.paint(declared) if ax is None else overlay.paint_over(declared, np.ravel(ax))

        figure.__name__, figure.__doc__ = name, FIGURES[name].help
        return figure

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *FIGURES]

    def declared(self, name: str) -> describe.Figure:
        """Declare a figure. Raises InputError for an unknown name, and for one that the run has not."""
        reason = self.reason(name)
        if reason is not None:
            raise InputError(f"there is no figure '{name}': {reason}")
        if name not in self._declared:
            with self.data:
                figure, study = FIGURES[name].declare(self.data), self.data.study
            self._declared[name] = with_blocks(figure, study)
        return self._declared[name]

    def reason(self, name: str) -> str | None:
        """Say in a sentence why the run has no such figure; None if it has. Unknown names: InputError."""
        return first_of(_entry(name).reasons, self.data)

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
        with self.data:
            return _entry(name).caption_of(self.data)

    def save_captions(self, folder: Path) -> None:
        """Write captions.md, of the figures that lie in the folder; a file of others is left alone."""
        path = folder / CAPTIONS
        names = [name for name in FIGURES if any(folder.glob(f"{name}.*")) and not self.reason(name)]
        with explained(f"{path} cannot be written"):
            if not names or (path.exists() and not path.read_bytes().startswith(HEAD.encode())):
                return
            texts = [f"**{name}**: {self.caption(name)}" for name in names]
            path.write_text("\n\n".join([HEAD, *texts]) + "\n", encoding="utf-8", errors="backslashreplace")
            add_figure(path)

    def save(self, name: str, folder: Path, *, file_format: str = "png", drawn: bytes | None = None) -> Path:
        """Write one figure, or the file's content as it was drawn; returns its path.

        Raises InputError for a name or a format that is not known.
        """
        if drawn is None:
            self.check([name], file_format=file_format)
            drawn = style.bytes_of(getattr(self, name)(), file_format)
        path = folder / f"{name}.{file_format}"
        with explained(f"{path} cannot be written"):
            folder.mkdir(parents=True, exist_ok=True)
            path.write_bytes(drawn)
            add_figure(path)
        return path

    def png(self, name: str, *, dpi: int) -> bytes:
        """Draw one figure; returns the bytes of a PNG file. Raises InputError for an unknown name."""
        return style.bytes_of(getattr(self, name)(), dpi=dpi)

    def check(self, names: Sequence[str], *, file_format: str = "png") -> None:
        """Raise InputError for a name or a format that is not known, before anything is drawn."""
        style.check_format(file_format)
        for name in names:
            _entry(name)


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


def _entry(name: str) -> DeclaredFigure:
    """Find a figure. Raises InputError for an unknown name."""
    if name not in FIGURES:
        raise InputError(_unknown(name))
    return FIGURES[name]


def _unknown(name: str) -> str:
    near = get_close_matches(name, FIGURES, n=1, cutoff=0.6)
    hint = f" (did you mean '{near[0]}'?)" if near else ""
    return f"'{name}' is no figure{hint}; allowed: {', '.join(FIGURES)}"
