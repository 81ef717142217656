"""Figures of a result. One style; every axis has its unit; the same colour for the same body everywhere."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from warpwear.grid import FloatArray
from warpwear.results import Result, Snapshot

if TYPE_CHECKING:
    from matplotlib.image import AxesImage

# Okabe and Ito's colours, told apart by colour-blind readers.
SPHERE, DISC, CONTACT, NEUTRAL, ACCENT, SUM = "#0072B2", "#D55E00", "#009E73", "#444444", "#CC79A7", "#E69F00"
WIDTH, HEIGHT = 3.5, 2.7  # one column [inch]
STYLE: dict[Any, Any] = {
    "font.size": 8,
    "axes.labelsize": 8,
    "legend.fontsize": 7,
    "legend.frameon": False,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "lines.linewidth": 1.2,
    "savefig.dpi": 200,
}
AREAS = {
    "area_contact": ("in contact", CONTACT, "-"),
    "area_plastic": ("at hardness", DISC, ":"),
    "area_touched": ("ever touched", SPHERE, "--"),
    "area_nominal": ("nominal (scar)", NEUTRAL, "-."),
    "area_cumulative": ("running sum", SUM, "-"),
}


class Plotter:
    """`result.plot.NAME()` returns a matplotlib figure; `save_all` writes every figure as a PNG."""

    NAMES = ("cof", "areas", "pressure", "pressure_map", "wear_map", "profiles", "volumes")

    def __init__(self, result: Result) -> None:
        self._result = result
        self._snapshots: dict[int, Snapshot] = {}

    def save_all(self, folder: Path) -> list[Path]:
        """Write all figures into the folder; returns their paths."""
        folder.mkdir(parents=True, exist_ok=True)
        return [self.save(name, folder) for name in self.NAMES]

    def save(self, name: str, folder: Path) -> Path:
        """Write one figure as a PNG; returns its path."""
        path = folder / f"{name}.png"
        figure: Figure = getattr(self, name)()
        with _style():
            figure.savefig(path)
        return path

    def cof(self) -> Figure:
        """Coefficient of friction over the distance slid, and relative to its end value."""
        history = self._result.history
        study = self._result.study

        def draw(axes: Axes) -> None:
            _over_distance(axes, history["distance"], history["cof"], color=NEUTRAL)
            axes.set_ylabel("coefficient of friction, 1")
            axes.set_ylim(bottom=0.0)
            end = float(history["cof"][-1])
            if np.isfinite(end) and end > 0.0:
                to_relative: Any = (lambda v: v / end, lambda v: v * end)
                relative = axes.secondary_yaxis("right", functions=to_relative)
                relative.set_ylabel("relative to its end, 1")
                relative.spines["right"].set_visible(True)
            area = AREAS[f"area_{study.friction.area}"][0]
            axes.set_title(f"friction from the area: {area}", fontsize=8)

        return _figure(draw)

    def areas(self) -> Figure:
        """The four areas and the nominal one over the distance slid."""
        history = self._result.history

        def draw(axes: Axes) -> None:
            for name, (label, color, line) in AREAS.items():
                values = np.where(history[name] > 0.0, history[name], np.nan)
                if np.isfinite(values).any():
                    _over_distance(axes, history["distance"], values, color=color, ls=line, label=label)
            _logarithmic(axes, history["distance"])
            axes.set_ylabel("area, mm²")
            axes.legend(loc="upper left")

        return _figure(draw)

    def pressure(self) -> Figure:
        """Mean and largest pressure of the cells in contact over the distance slid."""
        history = self._result.history

        def draw(axes: Axes) -> None:
            distance = history["distance"]
            _over_distance(axes, distance, history["pressure_mean"], color=CONTACT, label="mean")
            _over_distance(axes, distance, history["pressure_max"], color=NEUTRAL, ls=":", label="largest")
            hardness = self._result.study.hardness
            if np.isfinite(hardness):
                axes.axhline(hardness, color=ACCENT, lw=0.8, ls="--", label="hardness")
            _logarithmic(axes, distance)
            axes.set_ylabel("pressure in contact, MPa")
            axes.legend(loc="best")

        return _figure(draw)

    def pressure_map(self) -> Figure:
        """Pressure over the domain at the first and the last snapshot."""
        first, last = self._snapshot(0), self._snapshot(-1)
        shown = [last] if first.distance == last.distance else [first, last]

        def draw(axes: Any) -> None:
            for panel, snapshot in zip(np.atleast_1d(axes), shown, strict=True):
                pressure = np.where(snapshot.pressure > 0.0, snapshot.pressure, np.nan)
                self._map(panel, pressure, "viridis", "pressure, MPa")
                panel.set_title(_at(snapshot.distance), fontsize=8)

        return _figure(draw, columns=len(shown))

    def wear_map(self) -> Figure:
        """Wear depth of both bodies at the end."""
        last = self._snapshot(-1)

        def draw(axes: Any) -> None:
            deepest = 1.0e3 * max(last.wear_sphere.max(), last.wear_disc.max(), 1.0e-12)
            for panel, body in zip(axes, ("sphere", "disc"), strict=True):
                depth = 1.0e3 * getattr(last, f"wear_{body}")
                self._map(panel, depth, "magma_r", f"wear of the {body}, µm", top=deepest)
                panel.set_title(_at(last.distance), fontsize=8)

        return _figure(draw, columns=2)

    def profiles(self) -> Figure:
        """Both bodies along and across the sliding direction through the middle, at contact."""
        result, last = self._result, self._snapshot(-1)
        grid = result.study.cells
        approach = float(result.history["approach"][-1])
        curvature = result.study.sphere.curvature

        def draw(axes: Any) -> None:
            cuts: tuple[tuple[str, FloatArray, Callable[[FloatArray], FloatArray]], ...] = (
                ("along sliding, x", result.x, lambda f: f[:, grid.ny // 2]),
                ("across sliding, y", result.y, lambda f: f[grid.nx // 2, :]),
            )
            for panel, (label, place, cut) in zip(axes, cuts, strict=True):
                sphere0 = _sag(place, curvature) - approach
                sphere = sphere0 + cut(last.wear_sphere)
                disc = sphere + approach - cut(last.gap)
                unworn = disc + cut(last.wear_disc)
                panel.plot(place, 1e3 * unworn, color=DISC, lw=0.5, alpha=0.5, label="disc, unworn")
                panel.plot(place, 1e3 * sphere0, color=SPHERE, lw=0.6, ls="--", label="sphere, unworn")
                panel.plot(place, 1e3 * sphere, color=SPHERE, lw=2.6, alpha=0.4, label="sphere, worn")
                panel.plot(place, 1e3 * disc, color=DISC, lw=0.8, label="disc, worn")
                bottom = min(unworn.min(), disc.min(), sphere0.min())
                top = max(unworn.max(), sphere.min() + 0.25 * (sphere.max() - sphere.min()))
                room = 0.05 * (top - bottom)
                panel.set_ylim(1e3 * (bottom - room), 1e3 * (top + room))
                panel.set_xlabel(f"{label}, mm")
            axes[0].set_ylabel("height over the disc's mean plane, µm")
            figure = axes[0].figure
            handles, labels = axes[0].get_legend_handles_labels()
            figure.legend(handles, labels, loc="outside upper center", ncols=4)

        return _figure(draw, columns=2)

    def volumes(self) -> Figure:
        """Worn volume and deepest cell of both bodies over the distance slid."""
        history = self._result.history

        def draw(axes: Any) -> None:
            distance = history["distance"]
            for body, color in (("sphere", SPHERE), ("disc", DISC)):
                volume = 1e3 * history[f"wear_volume_{body}"]
                _over_distance(axes[0], distance, volume, color=color, label=body)
                depth = 1e3 * history[f"wear_depth_{body}"]
                _over_distance(axes[1], distance, depth, color=color, label=body)
            axes[0].set_ylabel("worn volume, 10⁻³ mm³")
            axes[1].set_ylabel("deepest cell, µm")
            axes[0].legend(loc="upper left")

        return _figure(draw, columns=2)

    def _snapshot(self, index: int) -> Snapshot:
        if index not in self._snapshots:
            self._snapshots[index] = self._result.snapshot(index)
        return self._snapshots[index]

    def _map(
        self, axes: Axes, values: FloatArray, colours: str, label: str, *, top: float | None = None
    ) -> "AxesImage":
        x, y = self._result.x, self._result.y
        half = 0.5 * self._result.study.grid.cell
        image = axes.imshow(
            values.T,
            origin="lower",
            extent=(x[0] - half, x[-1] + half, y[0] - half, y[-1] + half),
            cmap=colours,
            vmin=0.0,
            vmax=top,
            interpolation="auto",
        )
        axes.figure.colorbar(image, ax=axes, label=label, shrink=0.8)
        axes.set_xlabel("along sliding, x, mm")
        axes.set_ylabel("across, y, mm")
        axes.xaxis.set_major_locator(MaxNLocator(4))
        axes.yaxis.set_major_locator(MaxNLocator(5))
        return image


def _figure(draw: Callable[[Any], None], *, columns: int = 1) -> Figure:
    with _style():
        figure = Figure(figsize=(WIDTH * columns, HEIGHT), layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.subplots(1, columns)
        draw(axes)
    return figure


def _style() -> Any:
    import matplotlib

    return matplotlib.rc_context(STYLE)


def _over_distance(axes: Axes, distance: FloatArray, values: FloatArray, **style: Any) -> None:
    if distance.size == 1:
        style |= {"marker": "o", "ms": 4}
    axes.plot(distance, values, **style)
    axes.set_xlabel("sliding distance, mm")
    axes.xaxis.set_major_locator(MaxNLocator(6))


def _logarithmic(axes: Axes, distance: FloatArray) -> None:
    if distance.size > 1:
        axes.set_xscale("log")
    axes.set_yscale("log")


def _at(distance: float) -> str:
    return f"after {distance:.4g} mm of sliding" if distance else "static contact"


def _sag(place: FloatArray, curvature: float) -> FloatArray:
    if curvature == 0.0:
        return np.zeros_like(place)
    from warpwear.surfaces.sphere import sag

    return sag(place, np.zeros(1), radius=1.0 / curvature)[:, 0]
