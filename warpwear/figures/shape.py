"""Figures of the bodies' shapes: how they stood before sliding, what is left of them and what is gone."""

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d import proj3d  # type: ignore[import-untyped]

from warpwear.figures import style as fs
from warpwear.figures.axes import (
    draw_map,
    draw_surface,
    exaggeration,
    finish_3d,
    finish_sections,
    maps_of,
    new_3d_figure,
    panels,
    shared_bar,
)
from warpwear.figures.view import Profile, Window, coarsen, positive, sag_or_nan
from warpwear.grid import FloatArray

if TYPE_CHECKING:
    from warpwear.figures.data import FigureData

COLOURS = {"sphere": fs.SPHERE, "disc": fs.DISC}
#: Where one body is worn this many times as deep as the other, each has a scale of its own.
UNLIKE = 4.0
#: Blocks along a side of a body in 3-D.
RELIEF = 70
#: Blocks along a side from which lines of equal height are drawn, and about how many lines.
CONTOURED, CONTOURS = 60, 9
#: Length of the arrow of sliding over the domain's side.
ARROW = 0.4


def setup(data: "FigureData") -> Figure:
    """The sphere over the unworn disc at first contact, true to scale in x and y.

    Only the sphere's far half is drawn, so that the disc below it is seen; the disc is shown as far as it is
    computed.
    """
    about = data.about
    disc, window = data.relief
    x0, x1, y0, y1 = window.extent
    x, y = np.linspace(x0, x1, 61), np.linspace(0.5 * (y0 + y1), y1, 31)
    curvature, approach = about.curvature, float(data.history["approach"][0])
    sphere = 1e3 * (sag_or_nan(x, y, curvature) - approach)

    figure, (axes,) = new_3d_figure(1)
    draw_surface(axes, disc, window, fs.DISC, low=np.nanmin(disc), high=np.nanmax(disc))
    grid = np.meshgrid(x, y, indexing="ij")
    # The far half only lies over the disc: its order of drawing is known, so it is not left to be guessed.
    axes.plot_surface(*grid, sphere, color=fs.SPHERE, alpha=0.3, linewidth=0.0, shade=False, zorder=5)
    axes.plot_wireframe(*grid, sphere, rstride=6, cstride=6, color=fs.SPHERE, lw=0.4, zorder=6)
    axes.plot(x, np.full(x.size, y[0]), sphere[:, 0], color=fs.SPHERE, lw=1.4, zorder=7)
    low, high = 1e3 * float(np.nanmin(disc)), float(np.nanmax(sphere))
    top = 1e3 * float(np.nanmax(disc))
    axes.set_zlim(low, max(high, top) + 0.05 * (high - low))
    shape = f"sphere, R = {1.0 / curvature:.3g} mm," if curvature else "rigid flat"
    title = (
        f"{shape} on the disc; domain {about.extent:.4g} mm wide\n"
        f"{about.load:.3g} N; heights drawn {exaggeration(axes, window):g} times as large"
    )
    finish_3d(axes, window, "height, µm", title)
    middle, half = 0.5 * (x0 + x1), 0.5 * ARROW * (x1 - x0)
    _arrow(axes, middle - half, middle + half, y0, top + 0.15 * (high - low))
    return figure


def _arrow(axes: Any, start: float, end: float, y: float, height: float) -> None:
    """Draw an arrow along +x over the disc's near edge, where the sphere hides nothing; the view is final."""
    (x0, x1), (y0, y1), _ = proj3d.proj_transform([start, end], [y, y], [height, height], axes.get_proj())
    arrow = {"arrowstyle": "-|>", "color": "black", "lw": 1.0, "shrinkA": 0, "shrinkB": 0}
    with fs.style():
        axes.annotate("", (x1, y1), (x0, y0), arrowprops=arrow, zorder=20)
        paper = {"facecolor": "white", "edgecolor": "none", "pad": 0.8}
        axes.annotate("sliding", (x0, y0), ha="right", va="bottom", fontsize=7, bbox=paper, zorder=21)


def wear_map(data: "FigureData") -> Figure:
    """Wear depth of both bodies at the end; on scales of their own where one lost far less."""
    last, distance = data.bodies[-1], data.distances[-1]
    depths = {body: 1.0e3 * getattr(last, f"wear_{body}") for body in COLOURS}
    deepest = {body: float(depth.max()) for body, depth in depths.items()}
    unlike = UNLIKE * min(deepest.values()) < max(deepest.values())

    def draw(panel: Any, body: str) -> None:
        high = deepest[body] if unlike else max(deepest.values())
        label = "wear depth, µm" if unlike else None
        draw_map(panel, positive(depths[body]), data.window, fs.DEPTHS, label, low=0.0, high=high or 1.0)
        own = ", a scale of its own" if unlike else ""
        panel.set_title(f"{data.about.name_of(body)} {fs.after(distance)}{own}")

    def bar(figure: Any) -> None:
        if not unlike:
            shared_bar(figure, figure.axes[0].images[0], "wear depth, µm")

    return maps_of([*COLOURS], draw, finish=bar)


def sphere_map(data: "FigureData") -> Figure:
    """Shape of the sphere, unworn and at the snapshots."""
    return _maps(data, "sphere")


def disc_map(data: "FigureData") -> Figure:
    """Shape of the disc, unworn and at the snapshots."""
    return _maps(data, "disc")


def sphere_3d(data: "FigureData") -> Figure:
    """The sphere turned over, unworn and at the end, in 3-D."""
    return _surfaces(data, "sphere")


def disc_3d(data: "FigureData") -> Figure:
    """The disc, unworn and at the end, in 3-D."""
    return _surfaces(data, "disc")


@panels(2)
def sphere_profiles(axes: Any, data: "FigureData") -> None:
    """The sphere's shape through the middle, all snapshots overlaid."""
    _profiles(axes, data, "sphere")


@panels(2)
def disc_profiles(axes: Any, data: "FigureData") -> None:
    """The disc's shape through the middle, all snapshots overlaid."""
    _profiles(axes, data, "disc")


def _maps(data: "FigureData", body: str) -> Figure:
    bodies = [*zip(data.distances, data.bodies, strict=True)]
    if len(bodies) == 4:  # with the unworn one four panels; the third says least
        del bodies[2]
    titles = ["unworn", *(fs.after(distance) for distance, _ in bodies)]
    fields = [1e3 * _unworn(data, body), *(1e3 * getattr(worn, body) for _, worn in bodies)]
    high = max(float(np.nanmax(field)) for field in fields)
    label, extend, scaled = f"height of the {data.about.name_of(body)}, µm", "neither", fields
    is_sphere = data.about.name_of(body) == "sphere"
    if is_sphere:  # its flank at the corners would take half of the colours
        scaled, extend = [field[:, field.shape[1] // 2] for field in fields], "min"
    low = min(float(np.nanmin(field)) for field in scaled)

    def draw(panel: Any, shown: tuple[str, FloatArray]) -> None:
        title, field = shown
        draw_map(panel, field, data.window, fs.HEIGHTS, None, low=low, high=high)
        panel.set_title(title)
        if is_sphere:
            _contours(panel, field, data.window, low, high)

    def bar(figure: Any) -> None:  # one scale for all: what changes is the disc, not the colours
        shared_bar(figure, figure.axes[0].images[0], label, extend=extend)

    return maps_of([*zip(titles, fields, strict=True)], draw, finish=bar)


def _contours(panel: Any, field: FloatArray, window: Window, low: float, high: float) -> None:
    """Draw lines of equal height [µm] over a map: where they lie far apart the body is flat."""
    coarse, _ = coarsen(np.nan_to_num(field, nan=low), CONTOURED)
    x0, x1, y0, y1 = window.extent
    (nx, ny), places = coarse.shape, np.linspace(x0, x1, 2 * coarse.shape[0] + 1)[1::2]
    assert (nx, x0, x1) == (ny, y0, y1)  # what is shown of a contact is a square
    levels = MaxNLocator(CONTOURS).tick_values(low, high)
    panel.contour(
        places, places, coarse.T, levels=levels, colors="black", linewidths=0.4, linestyles="-", alpha=0.7
    )


def _surfaces(data: "FigureData", body: str) -> Figure:
    last = data.bodies[-1]
    states = {"unworn": _unworn(data, body), fs.after(data.distances[-1]): getattr(last, body)}
    states = {state: coarsen(field, RELIEF)[0] for state, field in states.items()}
    name, turned = data.about.name_of(body), ", turned over" if body == "sphere" else ""
    is_sphere = name == "sphere"
    worn = coarsen((getattr(last, f"wear_{body}") > 0.0).astype(float), RELIEF)[0] if is_sphere else None
    # A cap's corners do not set the scale.
    shown = [_cap(field) if is_sphere else field for field in states.values()]
    low = min(float(np.nanmin(field)) for field in shown)
    high = max(float(np.nanmax(field)) for field in shown)
    figure, panels = new_3d_figure(2)
    for axes, (state, field) in zip(panels, states.items(), strict=True):
        scar = worn if state != "unworn" else None
        draw_surface(axes, field, data.window, COLOURS[body], low=low, high=high, scar=scar, cap=is_sphere)
        axes.set_zlim(1e3 * low, 1e3 * high)
        scale = exaggeration(axes, data.window)
        told = " (pale: worn)" if scar is not None else ""
        title = f"{name}{turned}, {state}{told}\nheights drawn {scale:g} times as large"
        finish_3d(axes, data.window, "height, µm", title)
    return figure


def _unworn(data: "FigureData", body: str) -> FloatArray:
    """Return the unworn shape of a body [mm]: the mean of the worn shape plus the mean of the wear."""
    worn: FloatArray = getattr(data.bodies[-1], body)
    return worn + getattr(data.bodies[-1], f"wear_{body}")


def _cap(field: FloatArray) -> FloatArray:
    """Return a field with NaN beyond the largest circle."""
    x, y = (np.linspace(-1.0, 1.0, n) for n in field.shape)
    return np.where(np.add.outer(x**2, y**2) <= 1.0, field, np.nan)


def _profiles(axes: Any, data: "FigureData", body: str) -> None:
    views = data.views
    sign = -1.0 if body == "sphere" else 1.0  # heights are positive out of the material

    def heights(profile: Profile) -> FloatArray:
        return np.asarray(sign * getattr(profile, body))

    for panel, cut in zip(axes, ("along", "across"), strict=True):
        first: Profile = getattr(views[0], cut)
        unworn = heights(first) + getattr(first, f"wear_{body}")
        panel.plot(first.place, 1e3 * unworn, color="#999999", lw=0.5, label="unworn")
        for view, line in zip(views, fs.in_time(COLOURS[body], len(views)), strict=True):
            profile: Profile = getattr(view, cut)
            panel.plot(profile.place, 1e3 * heights(profile), label=fs.after(view.distance), **line)
    finish_sections(axes, heights=True)
    axes[0].set_ylabel("height, µm")
    fs.legend_above(axes[0], columns=len(views) + 1)


@panels(2)
def profiles(axes: Any, data: "FigureData") -> None:
    """Both bodies along and across the sliding direction through the middle, in contact, at the end."""
    last = data.views[-1]
    approach = float(data.history["approach"][last.row])
    cuts = (last.along, last.across)
    worn = any(lost.any() for cut in cuts for lost in (cut.wear_sphere, cut.wear_disc))
    slider = data.about.name_of("sphere")
    seen = [
        _both(panel, cut, approach, slider=slider, worn=worn) for panel, cut in zip(axes, cuts, strict=True)
    ]
    finish_sections(axes, heights=True)
    low, high = min(low for low, _ in seen), max(high for _, high in seen)
    room = 0.05 * (high - low)
    axes[0].set_ylim(1e3 * (low - room), 1e3 * (high + room))
    axes[0].set_ylabel("height over the disc, µm")
    fs.legend_above(axes[0], columns=4)


def _both(panel: Any, cut: Profile, approach: float, *, slider: str, worn: bool) -> tuple[float, float]:
    """Draw both bodies; returns the heights between which they are to be seen [mm]."""
    sphere, disc = cut.sphere - approach, cut.disc
    unworn_sphere, unworn_disc = sphere - cut.wear_sphere, disc + cut.wear_disc

    def line(heights: FloatArray, colour: Any, label: str, **style: Any) -> None:
        panel.plot(cut.place, 1e3 * heights, color=colour, label=label, **style)

    if worn:
        line(unworn_disc, fs.shades(fs.DISC)(0.0), "disc, unworn", lw=0.5)
        line(unworn_sphere, fs.SPHERE, f"{slider}, unworn", lw=0.7, ls="--")
    state = ", worn" if worn else ""
    line(sphere, fs.SPHERE, f"{slider}{state}", lw=2.6, alpha=0.4)
    line(disc, fs.DISC, f"disc{state}", lw=0.8)
    bottom = min(float(np.nanmin(heights)) for heights in (unworn_disc, disc, unworn_sphere))
    rise = float(np.nanmax(sphere) - np.nanmin(sphere))
    return bottom, max(float(np.nanmax(unworn_disc)), float(np.nanmin(sphere)) + 0.25 * rise)
