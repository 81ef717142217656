"""The fine cells of all patches: what they answer to an approach of each patch, and their wear."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import warp as wp
from numpy.typing import NDArray

from warpwear.engine.executor import Arguments, Executor, Field, arguments
from warpwear.grid import FloatArray
from warpwear.history.recorder_patches import Worn
from warpwear.kernels import patches as kernels
from warpwear.kernels.cells import PATCH_MAXIMA, PATCH_SUMS, TILE_VECTORS
from warpwear.kernels.running_in.film import difference
from warpwear.laws.film import Film
from warpwear.laws.patches import Patches
from warpwear.models.film import BareCells
from warpwear.models.patches.shares import PatchResponse

#: Work of a patch where no cell has touched yet, over that of one where all have.
LEAST_WORK = 0.05
#: Among the maxima: lowest indices are stored negated.
EXTENTS = ("first_row", "last_row", "first_column", "last_column")


@dataclass(frozen=True, eq=False)
class Lookahead:
    """What was evaluated before its step begins, in the pass that ended the last one."""

    stiffness: float  # that it is made for [N/mm³]
    base: FloatArray
    offset: FloatArray
    response: PatchResponse


def unworn(
    patches: Patches, heights: FloatArray, executor: Executor, *, curvature: float
) -> tuple[Field, Arguments]:
    """Gap of the fine cells before any wear [mm], and where the patches lie, with the lowest of their tiles.

    executor: on `patches.grid`. heights: of the disc over its mean plane [mm], shape of the domain.
    """
    domain, device = patches.domain, executor.device
    executor.load(kernels.gap)
    tiles = patches.side * -(-patches.vectors // int(TILE_VECTORS))
    layout = arguments(
        kernels.Layout,
        vectors=patches.vectors,
        first_row=wp.array(patches.first_row, dtype=wp.int32, device=device),
        first_column=wp.array(patches.first_column, dtype=wp.int32, device=device),
        lowest=wp.zeros((patches.count, tiles), dtype=wp.float64, device=device),
    )
    ball = arguments(
        kernels.Ball,
        cell=domain.cell,
        x_first=float(domain.x[0]),
        y_first=float(domain.y[0]),
        curvature=curvature,
    )
    gap = executor.zeros()
    roughness = executor.field(patches.stored(heights))
    executor.launch(kernels.gap, inputs=[patches.side, ball, layout, roughness], outputs=[gap])
    return gap, layout


class PatchContact:
    """The gap of every fine cell on a capped foundation, patch by patch: the micro law of two scales.

    executor: on `patches.grid`. heights: of the disc over its mean plane [mm], shape of the domain. film: on
    bodies of which sphere and disc lose these fractions of what is worn.
    """

    STATE: ClassVar = {"gap": Field, "reached": FloatArray, "lookahead": Lookahead, "film": BareCells}

    def __init__(
        self,
        patches: Patches,
        heights: FloatArray,
        executor: Executor,
        *,
        curvature: float,
        hardness: float,
        film: Film | None = None,
        fractions: tuple[float, float] = (0.5, 0.5),
    ) -> None:
        self.patches, self._executor, self._hardness = patches, executor, hardness
        count, device = patches.count, executor.device
        self.initial, self._layout = unworn(patches, heights, executor, curvature=curvature)
        self.gap: Field = wp.clone(self.initial)
        #: Lowest gap of each patch before any wear [mm]: below that approach it carries nothing.
        self.lowest: FloatArray = self._layout.lowest.numpy().min(axis=1)
        #: Largest approach that each patch has had [mm].
        self.reached = np.full(count, -np.inf)
        self._cells = float(patches.side**2)
        self._work = np.full(count, LEAST_WORK * self._cells)
        self._visited = np.zeros(count, dtype=bool)
        self._chunks: list[tuple[int, int]] = []
        self._listed = np.empty(0, dtype=np.intp)
        self._list = wp.zeros(count, dtype=wp.int32, device=device)
        names = ("base", "offset", "reached", "base_next", "offset_next")
        zeros = {name: wp.zeros(count, dtype=wp.float64, device=device) for name in names}
        self._at = arguments(kernels.Approaches, **zeros)
        #: Worn by both bodies [mm], where a film asks for it.
        self._worn = executor.zeros(None if film else 0)
        self.film = BareCells.of_both(film, executor, self._worn, fractions)
        if self.film is not None and self.film.parts is not None:
            self._at.parts = self.film.parts
        self._law, self._increment = arguments(kernels.Law, cap=hardness), arguments(kernels.Increment)
        sums, maxima = executor.partials(len(PATCH_SUMS)), executor.partials(len(PATCH_MAXIMA))
        self._tables = arguments(kernels.Tables, sums=sums, maxima=maxima, ahead=executor.partials(3))
        #: 1/c of the cells [N/mm³].
        self.stiffness = np.inf
        #: Of the step to come, where its approaches were foreseen.
        self.lookahead: Lookahead | None = None
        #: Passes over the gap that answered so far.
        self.evaluations = 0

    def look(self, distance: float) -> None:
        """See which cells are bare of film as a step begins at a sliding distance [mm]."""
        if self.film is not None:
            self._measure_wear()
            self.film.look(distance)

    def rub(self, distance: float) -> None:
        """Note what a step that ends at a sliding distance [mm] has worn."""
        if self.film is not None:
            self._measure_wear()
            self.film.rub(distance)

    def _measure_wear(self) -> None:
        inputs = [self.gap, self.initial]
        self._executor.launch(difference, inputs=inputs, outputs=[self._worn])

    def response(self, base: FloatArray, offset: FloatArray) -> PatchResponse:
        """Respond to an approach base + offset of each patch [mm]."""
        known = self.lookahead
        if (
            known is not None
            and known.stiffness == self.stiffness
            and np.array_equal(known.offset, offset)
            and np.array_equal(known.base, base)
        ):
            return known.response
        self.evaluations += 1
        self._visit((base - self.lowest) + offset > 0.0)
        if self._listed.size:
            self._send(base, offset)
            self._executor.launch(
                kernels.carried,
                inputs=[self._list, self._layout, self._at, self._law, self._increment, self.gap],
                outputs=[self._tables.sums],
                chunks=self._chunks,
                often=True,
            )
        return self._response_in(self._tables.sums, base, offset, self.stiffness)

    def _response_in(
        self, sums: Field, base: FloatArray, offset: FloatArray, stiffness: float
    ) -> PatchResponse:
        """What a table says of the patches visited; the others carry nothing."""
        pressure, slope = np.zeros_like(base), np.zeros_like(base)
        straight = (self.lowest - base) - offset
        if self._listed.size:
            table = self._of_patches(sums)[:3]
            pressure[self._listed], slope[self._listed] = table[:2].sum(axis=2) / self._cells
            straight[self._listed] = table[2].min(axis=1) / stiffness
        return PatchResponse(pressure, slope, straight)

    def bare(self, base: FloatArray, offset: FloatArray) -> float | None:
        """Bare cells among those that approaches press; None without a film."""
        return None if self.film is None else self.film.under(self._pressed(base, offset))

    def pressures(self, base: FloatArray, offset: FloatArray) -> FloatArray:
        """The pressure of every cell [MPa], as stored."""
        return self._executor.to_numpy(self._pressed(base, offset))

    def _pressed(self, base: FloatArray, offset: FloatArray) -> Field:
        field = self._executor.zeros()
        self._visit((base - self.lowest) + offset > 0.0)
        self._send(base, offset)
        self._executor.launch(
            kernels.pressures,
            inputs=[self._list, self._at, self._law, self._increment, self.gap],
            outputs=[field],
            chunks=self._chunks,
        )
        return field

    def wear(
        self,
        base: FloatArray,
        offset: FloatArray,
        *,
        removal: float,
        reference: float,
        known: Mapping[str, float],
        foreseen: tuple[float, FloatArray, FloatArray] | None = None,
    ) -> Worn:
        """Wear both bodies by removal [mm³/N] times the pressure. reference: squares count from it [MPa].

        known: extents of the cells touched so far, by the names of `MAXIMA`. foreseen: of the next step, 1/c
        [N/mm³], base and offset [mm] of its first evaluation: `response` then has its answer.
        """
        stiffness_next, base_next, offset_next = foreseen or (self.stiffness, base, offset)
        touching = ((base - self.lowest) + offset > 0.0) | ((base_next - self.lowest) + offset_next > 0.0)
        self._visit(touching | (self.lowest < self.reached))
        self._send(base, offset)
        self._put(self._at.base_next, base_next)
        self._put(self._at.offset_next, offset_next)
        self._put(self._at.reached, self.reached)
        now = self._increment
        now.wear_per_pressure, now.reference, now.stiffness_next = removal, reference, stiffness_next
        now.first_row, now.last_row, now.first_column, now.last_column = self._between(known)
        self._executor.launch(
            kernels.wear_step,
            inputs=[self._list, self._layout, self._at, self._law, now, self.initial],
            outputs=[self.gap, self._tables],
            chunks=self._chunks,
            often=True,
        )
        self.reached = np.maximum(self.reached, base + offset)
        sums = np.zeros((len(PATCH_SUMS), self.patches.count))
        sums[:, self._listed] = self._of_patches(self._tables.sums).sum(axis=2)
        self._work = sums[PATCH_SUMS.index("touched")] + LEAST_WORK * self._cells
        most = self._of_patches(self._tables.maxima).max(axis=(1, 2)).tolist()
        self.lookahead = None
        if foreseen is not None:
            response = self._response_in(self._tables.ahead, base_next, offset_next, stiffness_next)
            self.lookahead = Lookahead(stiffness_next, base_next, offset_next, response)
        return Worn(dict(zip(PATCH_SUMS, sums, strict=True)), dict(zip(PATCH_MAXIMA, most, strict=True)))

    def _between(self, known: Mapping[str, float]) -> tuple[int, int, int, int]:
        """First and last row, first and last column."""
        if not math.isfinite(known["first_row"]):
            size = self.patches.domain.nx
            return size, -1, size, -1
        first_row, last_row, first_column, last_column = (int(abs(known[name])) for name in EXTENTS)
        return first_row, last_row, first_column, last_column

    def _visit(self, which: NDArray[np.bool_]) -> None:
        """List patches for the next launches."""
        if not np.array_equal(which, self._visited):
            self._visited = which
            self._listed = np.flatnonzero(which)
            numbers = np.zeros(which.size, dtype=np.int32)
            numbers[: self._listed.size] = self._listed
            self._put(self._list, numbers)
        self._chunks = self._executor.split_rows(self._work[self._listed])

    def _send(self, base: FloatArray, offset: FloatArray) -> None:
        self._put(self._at.base, base)
        self._put(self._at.offset, offset)
        self._increment.stiffness = self.stiffness

    def _put(self, array: Field, values: NDArray[np.float64] | NDArray[np.int32]) -> None:
        if self._executor.device.is_cpu:
            array.numpy()[:] = values
        else:
            array.assign(values)

    def _of_patches(self, table: Field) -> FloatArray:
        """What the last launch wrote of the patches visited, shape (quantities, visited, slots of each)."""
        slots = self._executor.slots_per_row
        found: FloatArray = table.numpy()[:, : self._listed.size * slots]
        return found.reshape(found.shape[0], self._listed.size, slots)
