"""What figures need of a result, read once and reduced to what paper shows, see `view.py`.

A field of 1500² cells is drawn on some 700 pixels, and matplotlib takes an image's memory several times.
So a snapshot is cropped to the scar, reduced block by block, and let go.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, Self

import numpy as np

from warpwear import lazy
from warpwear.figures.of_run.view import Cutout, Fields, FilmState, PatchLoads, State, View, or_nan
from warpwear.figures.wording import after, chosen, short
from warpwear.grid import FloatArray, Grid
from warpwear.history.snapshot import Snapshot
from warpwear.laws.archard import BODIES
from warpwear.laws.depth_profile import DepthProfile, of_materials
from warpwear.laws.patches import Patches
from warpwear.results.evolution import SurfaceEvolution, spectrum_in_scar, surface_evolution
from warpwear.results.file import ResultFile
from warpwear.results.formats.bodies import worn_heights
from warpwear.results.track import is_short, whole_steps
from warpwear.surfaces.spectrum import Spectrum

execution = lazy.module("warpwear.engine.executor")
shares = lazy.module("warpwear.models.patches.shares")

#: Most blocks along a side of a map, and of the relief in 3-D.
MAP_BLOCKS, SURFACE_BLOCKS = 500, 60
#: Bins along a line of pressures.
BINS = 50
#: Snapshots in one figure.
SHOWN = 4
#: Side of what is shown over the scar's largest extent.
MARGIN = 1.15
#: Width of a strip of pressures over the side of what is shown.
STRIP = 0.125
#: Room around the macro contact [macro cells].
ROOM = 1


class FigureData:
    """History, study and reduced snapshots of a result, each made when it is first asked for."""

    def __init__(
        self, result: ResultFile, snapshots: Sequence[int] | None = None, *, blocks: int = MAP_BLOCKS
    ) -> None:
        """Look at a result. snapshots: numbers of those that figures show; blocks: most along a side."""
        self.result = result
        self.study = result.study
        self.history: dict[str, FloatArray] = dict(result.history)
        count = result.snapshot_distances.size
        self.indices = chosen(count, SHOWN) if snapshots is None else [*snapshots]
        self.blocks = blocks
        self._read: tuple[int, Snapshot] | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        """Let go the snapshot at hand."""
        self._read = None

    def with_snapshots(self, snapshots: Sequence[int], blocks: int) -> "FigureData":
        """Look at more of the same result's snapshots, in at most so many blocks along a side."""
        same = [*snapshots] == self.indices and blocks == self.blocks
        return self if same else FigureData(self.result, snapshots, blocks=blocks)

    @property
    def slider(self) -> str:
        """What figures call the body that slides."""
        return self.study.counter.name

    @property
    def groove(self) -> str:
        """What figures call the place where the disc wears: a groove where the contact leaves it."""
        return "groove" if self.study.is_swept and not is_short(self.result) else "scar"

    def after(self, distance: float) -> str:
        """Say when a snapshot was taken, of fretting in cycles. distance: in mm."""
        if self.study.fretting is None or not distance:
            return after(distance)
        return f"after {short(float(f'{distance / self.study.fretting.cycle:.3g}'))} cycles"

    def name_of(self, body: str) -> str:
        """Return what a figure calls the body "counter" or "disc"."""
        return self.slider if body == "counter" else body

    @property
    def layered(self) -> dict[str, DepthProfile]:
        """Return what bodies with layers are made of by worn depth, by "counter" and "disc"."""
        pairs = zip(BODIES, self.study.pair.profiles or (), strict=False)
        return {body: profile for body, profile in pairs if of_materials(body, profile)}

    @property
    def shear(self) -> str:
        """Say where the shear strength comes from."""
        study, friction = self.study, self.study.friction
        if friction.fitted == "coulomb":
            return f"constant, {friction.coefficient:g}, an input"
        if friction.fitted == "states":
            return "by film, bare metal and cover, an input"
        if friction.shear_strength is not None:
            return f"shear strength {friction.shear_strength:g} MPa{study.pair.other_shear}, as given"
        at_end = friction.calibrate == "end"
        if study.lap is None:
            return f"calibrated to {friction.coefficient:g} at the {'end' if at_end else 'start'}"
        return f"calibrated to {friction.coefficient:g} in the {'last' if at_end else 'first'} pass"

    @cached_property
    def course(self) -> dict[str, FloatArray]:
        """The history's columns at the steps that are drawn over the distance, those not cut short."""
        whole = whole_steps(self.result)
        return {name: values[whole] for name, values in self.history.items()}

    @cached_property
    def distances(self) -> list[float]:
        """Return the distances of the snapshots shown [mm]."""
        return [float(self.result.snapshot_distances[index]) for index in self.indices]

    def snapshot(self, index: int) -> Snapshot:
        """Return snapshot number `index`, from 0; the one asked for last is at hand."""
        if self._read is None or self._read[0] != index:
            self._read = None  # let go before another is read
            self._read = index, self.result.snapshot(index)
        return self._read[1]

    @cached_property
    def views(self) -> list[View]:
        """Read the contact at the snapshots shown, in order of distance."""
        return [self.view(index) for index in reversed(self.indices)][::-1]  # the last has set the window

    def view(self, index: int) -> View:
        """Return the contact at snapshot number `index`."""
        snapshot, window = self.snapshot(index), self.window
        row = self.row_of(snapshot.distance)
        pressure = window.largest(snapshot.pressure)
        caps = self._caps(snapshot) * (1.0 - 1e-9)
        # The bearing area scales its pressure to the load, so that the hardness is met within a tolerance.
        if self.history["area_plastic"][row] >= self.history["area_contact"][row] * (1.0 - 1e-9):
            caps = 0.0
        state = window.largest(snapshot.touched).astype(np.uint8)
        state[pressure > 0.0] = State.IN_CONTACT
        state[(pressure > 0.0) & window.largest(snapshot.pressure >= caps)] = State.AT_HARDNESS
        cuts = {"along": self._cut(snapshot, 0), "across": self._cut(snapshot, 1)}
        return View(snapshot.distance, row, pressure, state, cuts, self._film(snapshot, window))

    def _caps(self, snapshot: Snapshot) -> Any:
        """Return the largest pressures of the cells [MPa]: of a film, or of the materials that lie bare."""
        if self.study.pair.profiles is not None:
            pairs = zip(self.study.pair.profiles, (snapshot.wear_counter, snapshot.wear_beneath), strict=True)
            return np.minimum(*(profile.hardness_at(worn) for profile, worn in pairs))
        filmed, bare = self.study.pair.caps
        return bare if snapshot.bare is None else np.where(snapshot.bare > 0.0, bare, filmed)

    def _film(self, snapshot: Snapshot, window: Cutout) -> Any:
        if snapshot.bare is None:
            return None
        film = np.where(snapshot.bare > 0.0, FilmState.BARE_BESIDE, FilmState.ELSEWHERE).astype(np.uint8)
        pressed = snapshot.pressure > 0.0
        film[pressed] = np.where(snapshot.bare[pressed] > 0.0, FilmState.ON_METAL, FilmState.ON_FILM)
        return window.largest(film)

    @cached_property
    def bodies(self) -> list[Fields]:
        """Read both bodies at the snapshots shown, in order of distance."""
        return [self.bodies_at(index) for index in reversed(self.indices)][::-1]

    def bodies_at(self, index: int, *, most: int = 0) -> Fields:
        """Return both bodies at snapshot number `index`, in at most `most` blocks along a side.

        Heights are positive out of the material.
        """
        snapshot, window = self.snapshot(index), self.window_of(most or self.blocks)
        fields = {body: worn_heights(self.result, snapshot, body) for body in BODIES}
        fields |= {"wear_counter": snapshot.wear_counter, "wear_disc": snapshot.lost_beneath}
        return {name: window.means(field) for name, field in fields.items()}

    def row_of(self, distance: float) -> int:
        """Return the row of the history whose step ends at a snapshot's distance [mm]."""
        return min(int(np.searchsorted(self.history["distance"], distance)), self.steps - 1)

    @property
    def steps(self) -> int:
        """Return the number of rows of the history."""
        return int(self.history["distance"].size)

    @cached_property
    def window(self) -> Cutout:
        """The scar at the end and some room: what maps show. Touched cells only ever become more."""
        return self.window_of(self.blocks)

    def window_of(self, most: int) -> Cutout:
        """Return the scar at the end and some room, in at most `most` blocks along a side."""
        return self._centred(self._halves, most)

    @cached_property
    def relief(self) -> tuple[FloatArray, Cutout]:
        """Return heights [mm] of the unworn disc over the whole domain, for 3-D."""
        snapshot, window = self.snapshot(0), self._centred((np.inf, np.inf), SURFACE_BLOCKS)
        worn = worn_heights(self.result, snapshot, "disc")
        return window.means(worn + snapshot.lost_beneath), window

    @cached_property
    def strips(self) -> tuple[float, float]:
        """Widths [mm] of the strips along and across whose pressures are averaged for a line."""
        cell = self.study.grid.cell
        along, across = (max(1, round(STRIP * 2.0 * half / cell)) * cell for half in self._halves[::-1])
        return along, across

    @cached_property
    def evolution(self) -> SurfaceEvolution:
        """Measure the roughness inside the scar and islands of contact at every snapshot."""
        return surface_evolution(self.result)

    @cached_property
    def spectra(self) -> dict[str, list[tuple[float, Spectrum]]]:
        """Return distance [mm] and power spectrum in the inner scar of the snapshots shown, by body."""
        spectra: dict[str, list[tuple[float, Spectrum]]] = {body: [] for body in BODIES}
        for index in self.indices:
            snapshot = self.snapshot(index)
            for body in BODIES:
                spectrum = spectrum_in_scar(self.result, index, snapshot, body)
                if spectrum is not None:
                    spectra[body].append((snapshot.distance, spectrum))
        return spectra

    @cached_property
    def pieces(self) -> dict[str, FloatArray]:
        """Return the pieces' diameters as cut by body, rising [mm]."""
        table = self.result.pieces
        return {
            body: np.sort(table["diameter"][table["body"] == number]) for number, body in enumerate(BODIES)
        }

    @cached_property
    def loads(self) -> PatchLoads:
        """Loads of the patches at the snapshots shown, beside those of a smooth contact with its own wear."""
        patches, rows = self.study.patch_layout, [self.row_of(distance) for distance in self.distances]
        shares = {"patches": self.result.load_share[rows]}
        smooth = smooth_shares(self.result, rows)
        apart: tuple[float, ...] = ()
        if smooth is not None:
            apart = tuple(load_share_error(*both) for both in zip(smooth, shares["patches"], strict=True))
            shares["smooth contact"] = smooth
        window = macro_window(patches, np.array([*shares.values()]).max(axis=(0, 1)))
        square = (len(rows), patches.across, patches.across)
        pressures = {
            name: share.reshape(square)[:, window.x, window.y] / patches.area
            for name, share in shares.items()
        }
        return PatchLoads(pressures, apart, window, self.study.patches.coupling == "load")

    @cached_property
    def _halves(self) -> tuple[float, float]:
        """Half the sides [mm] of what is shown, along and across: a square of a domain that is one."""
        cell, rises = self.study.grid.cell, self.study.counter.form.rises
        along, across = self.study.grid.sides
        sides = 0.5 * along, 0.5 * across
        is_square = sides[0] == sides[1]
        if not (all(rises) if is_square else any(rises)):
            return sides
        touched, halves = self.snapshot(self.indices[-1]).touched, []
        for axis, places in enumerate((self.result.x, self.result.y)):
            reach = float(np.abs(places[touched.any(axis=1 - axis)]).max())
            halves.append(min(MARGIN * reach + cell, float(places[-1])) if rises[axis] else sides[axis])
        return (max(halves), max(halves)) if is_square else (halves[0], halves[1])

    def _centred(self, halves: tuple[float, float], most: int) -> Cutout:
        """Cut the middle into at most `most` blocks a side, unless it is narrow; part of one is left out."""
        axes = self.result.x, self.result.y
        counts = [int((np.abs(places) <= half).sum()) for places, half in zip(axes, halves, strict=True)]
        factor = min(-(-max(counts) // most), *counts)
        wholes = [count // factor * factor for count in counts]
        firsts = [(places.size - whole) // 2 for places, whole in zip(axes, wholes, strict=True)]
        parts = [slice(first, first + whole) for first, whole in zip(firsts, wholes, strict=True)]
        return Cutout.of(self.study.cells, *parts, factor=factor)

    def _cut(self, snapshot: Snapshot, axis: int) -> Fields:
        """Cut through the middle of a snapshot. axis: 0 along sliding, 1 across it."""
        axes, parts = (self.result.x, self.result.y), (self.window.x, self.window.y)
        places, part, across = axes[axis], parts[axis], axes[1 - axis]

        def line(field: FloatArray) -> FloatArray:
            return np.asarray(np.take(field, across.size // 2, axis=1 - axis)[part])

        strip = np.compress(np.abs(across) <= 0.5 * self.strips[axis], snapshot.pressure, axis=1 - axis)
        pressure = strip.mean(axis=1 - axis)[part]
        cells = -(-pressure.size // BINS)
        bins = pressure.size // cells
        first = (pressure.size - bins * cells) // 2
        whole = slice(first, first + bins * cells)
        cut = places[part], np.zeros(1)
        unworn = self.result.unworn_counter(*(cut if axis == 0 else cut[::-1])).ravel()
        counter = or_nan(unworn) + line(snapshot.wear_counter)
        means = {"bins": places[part], "pressure": pressure}
        return {
            "place": places[part],
            "counter": counter,
            "disc": counter - line(snapshot.gap),
            "wear_counter": line(snapshot.wear_counter),
            "wear_disc": line(snapshot.lost_beneath),
            **{name: values[whole].reshape(bins, cells).mean(axis=1) for name, values in means.items()},
        }


def macro_window(patches: Patches, carried: FloatArray) -> Cutout:
    """Find the macro cells around the middle that ever carry something, and some room. carried: (patches,)"""
    across = patches.across
    square = carried.reshape(across, across) > 0.0
    places = np.abs(np.arange(across) - 0.5 * (across - 1))
    reach = max(float(places[square.any(axis=axis)].max(initial=0.0)) for axis in (0, 1)) + ROOM
    first = max(math.floor(0.5 * (across - 1) - reach), 0)
    part = slice(first, across - first)
    return Cutout.of(Grid(across, across, patches.pitch * patches.domain.cell), part, part)


def load_share_error(shares: FloatArray, others: FloatArray) -> float:
    """Return ½ Σ|ΔF_k| / F: the part of the load that two distributions put on different patches."""
    return float(0.5 * np.abs(shares - others).sum() / others.sum())


def smooth_shares(result: ResultFile, rows: Sequence[int]) -> FloatArray | None:
    """Return the loads [N] that a smooth macro contact with a wear of its own would give the patches.

    rows: of the history; the loads have the shape (rows, patches). None where the study has no bulk stiffness
    K_N: its elastic constants are not known.
    """
    study = result.study
    if isinstance(study.contact.bulk_stiffness, str) and study.hertz is None:
        return None
    patches, task = study.patch_layout, replace(study.contact_task, form=result.form)
    loads, slid = [], 0.0
    with execution.Executor(Grid(patches.count, 1, patches.domain.cell), threads=1) as executor:
        smooth = shares.SmoothContact(task, patches, executor)
        for increment in result.history["increment"][: max(rows) + 1].tolist():
            removal = sum(law.wear_per_pressure(slid, increment) for law in study.wear_laws)
            loads.append(smooth.area * smooth.press(foundation=study.pair.bulk_stiffness, removal=removal))
            slid += increment
    return np.array(loads)[[*rows]]
