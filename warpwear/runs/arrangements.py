"""What a run of each arrangement is made of: its model, its memory, and what its executor and heights cover.

A new one is a name of `warpwear.history.arrangements` and a class here, which registers itself.
"""

import math
from dataclasses import asdict, dataclass, replace
from typing import Any, ClassVar, TypeAlias

from warpwear import lazy
from warpwear.engine.executor import FIELDS_NEEDED, Executor, require_memory
from warpwear.grid import FloatArray
from warpwear.history.arrangements import ARRANGEMENTS, name_of
from warpwear.history.recorder_patches import bytes_of_book
from warpwear.laws.bearing_curve import Logistic
from warpwear.laws.passes import Block
from warpwear.laws.task import ContactTask
from warpwear.laws.track import Track
from warpwear.models.model import Model
from warpwear.runs.plan import plan_of
from warpwear.study.study import Study
from warpwear.study.surface import bearing_curve_of

# The models, each with its kernels, of which a run needs one: reading them all takes longer than a short run.
models_rest = lazy.module("warpwear.models.rest.local")
models_track = lazy.module("warpwear.models.track.model")
models_two_scale = lazy.module("warpwear.models.patches.local")
models_patches = lazy.module("warpwear.models.patches.half_space")
width = lazy.module("warpwear.models.patches.width")

#: Fields at the peak of a run on the half-space, by its boundary, and more on a GPU, whose transforms copy.
HALF_SPACE_FIELDS, GPU_FIELDS = {"periodic": 16.0, "free": 22.0, "line": 22.0}, 12.0
#: More on the host where stresses below the surface are computed, a depth at a time.
STRESS_FIELDS = {"periodic": 70.0, "free": 85.0, "line": 80.0}
#: More where the disc slides: a mean along x, and what it takes to follow the disc.
SLIDING_FIELDS = 3.0
#: More with a film: what is bare and its caps; and of each body whose film forms anew.
FILM_FIELDS, HEALING_FIELDS = 2.0, 3.0
#: More of fretting: a mean along x, slips, and a contact of its own under P*.
FRETTING_FIELDS = 28.0
#: More of each body that wears in pieces: what is pending, its sums, and lists of cells.
PIECES_FIELDS = 2.5


Record: TypeAlias = dict[str, Any]  # of the surface, for the result


@dataclass(frozen=True)
class Parts:
    """What a model of a block is made of."""

    study: Study
    task: ContactTask
    block: Block
    heights: FloatArray  # of the unworn disc [mm], shape (nx, ny), or of the track, (rows, ny)
    executor: Executor
    record: Record  # of the surface, to which who makes the model may add


class Maker:
    """Makes runs of one arrangement, and by default those of a disc that lies still."""

    REGISTERED: ClassVar[dict[str, "Maker"]] = {}

    def __init_subclass__(cls, *, name: str) -> None:
        """Register an arrangement. Raises KeyError for one that `ARRANGEMENTS` does not have."""
        if name not in ARRANGEMENTS:
            raise KeyError(f"{name!r} is not one of warpwear.history.arrangements: {', '.join(ARRANGEMENTS)}")
        cls.REGISTERED[name] = cls()

    def executor(self, study: Study, *, device: str, threads: int | None) -> Executor:
        """Make what the kernels are launched on. Raises InputError as `Executor` does."""
        fields = self.needed(study, device=device)
        return Executor(study.cells, device=device, threads=threads, fields_needed=fields)

    def fields(self, study: Study, *, device: str) -> float:
        """Estimate the fields of the grid's size at the peak of a run."""
        fields, bodies = FIELDS_NEEDED + PIECES_FIELDS * study.wear.sheds, self.rows_of_bodies(study)
        if study.contact.law == "half-space":
            fields += HALF_SPACE_FIELDS[study.boundary] + GPU_FIELDS * (device != "cpu") - FIELDS_NEEDED
        if study.has_stresses:
            fields += STRESS_FIELDS[study.boundary]
        if study.pair.film is not None:
            fields += FILM_FIELDS + HEALING_FIELDS * bodies * math.isfinite(study.pair.film.regrowth)
        return fields

    def needed(self, study: Study, *, device: str) -> float:
        """Estimate those of a programme: where its load or track changes a model takes over from another."""
        same_track = not study.is_swept or len(set(study.tracks)) == 1
        return self.fields(study, device=device) * (
            1.0 if study.same_load is not None and same_track else 2.0
        )

    def rows_of_bodies(self, study: Study) -> float:
        """Return rows of both bodies over those of the grid."""
        return 2.0

    def model(self, parts: Parts) -> Model:
        """Make the model, here of one grid at rest. Raises InputError for heights that it cannot use."""
        curve = bearing_curve_of(parts.study) if parts.study.wear.law == "bearing-curve" else None
        if curve is not None:
            parts.record["bearing_curve"] = asdict(curve)
        return model_at_rest(parts.task, parts.heights, parts.executor, bearing_curve=curve)


class AtRest(Maker, name="rest"):
    """A ball that stays on the same cells."""

    def executor(self, study: Study, *, device: str, threads: int | None) -> Executor:
        """Make it, and begin to compile while the surface is made."""
        executor, task = super().executor(study, device=device, threads=threads), study.contact_task
        if is_alike(task, study.wear.law == "bearing-curve"):
            models_rest.foresee(task, executor)
        return executor

    def fields(self, study: Study, *, device: str) -> float:
        """Estimate more where cells differ: by a track's model, a radial factor, and the stiffness."""
        differs = not study.contact_task.is_uniform or study.wear.law == "bearing-curve"
        fields = FRETTING_FIELDS * (study.fretting is not None)
        return super().fields(study, device=device) + (SLIDING_FIELDS + 2.0) * differs + fields


class OnTrack(Maker, name="track"):
    """A ball that slides over a track."""

    def executor(self, study: Study, *, device: str, threads: int | None) -> Executor:
        """Make it where host and device hold the track."""
        whole = study.sliding.track == "full"
        shorter = "a representative track, such as sliding.track = '3.2 mm', or " if whole else ""
        cells = f"{study.track.rows} × {study.cells.ny} cells"
        what = f"sliding.track = {study.sliding.track!r} makes a disc of {cells}"
        needed = 8.0 * self.needed(study, device=device) * study.cells.cells
        require_memory(device, needed, what, f"{shorter}larger cells are needed.")
        return Executor(study.cells, device=device, threads=threads)

    def fields(self, study: Study, *, device: str) -> float:
        """Estimate more of the disc's size: heights, wear, dents, what is pending; and of the way."""
        of_disc = models_track.DISC_FIELDS + (study.sliding.plastic == "keep")
        of_disc += PIECES_FIELDS * study.wear.sheds
        of_disc *= 3.0 if study.jumps and device == "cpu" else 1.0  # both states of jumps are kept as copies
        fields = super().fields(study, device=device) + SLIDING_FIELDS * (study.contact.law == "half-space")
        return float(fields + of_disc * study.track.rows / study.cells.nx)

    def rows_of_bodies(self, study: Study) -> float:
        """Count the disc's rows."""
        return study.track.rows / study.cells.nx + 1.0

    def model(self, parts: Parts) -> Model:
        """Make a model of the whole track."""
        track = parts.study.tracks[parts.block.number - 1]
        return models_track.SweptModel(parts.task, track, parts.heights, parts.executor)


class OfPatches(AtRest, name="patches"):
    """A ball on patches that share the load."""

    def executor(self, study: Study, *, device: str, threads: int | None) -> Executor:
        """Make it on the grid of the patches, where the host holds their history too."""
        patches, fields = study.patch_layout, self.needed(study, device=device)
        executor = Executor(patches.grid, device=device, threads=threads, fields_needed=fields)
        steps, size = len(plan_of(study)), f"patches.macro_cell = {1e3 * study.patches.macro_cell:g} µm"
        what = f"{size} makes {patches.count} patches, with loads and areas over {steps} steps"
        beside = 8.0 * FIELDS_NEEDED * patches.grid.cells * (device == "cpu")
        needed = bytes_of_book(steps, patches.count) + beside
        require_memory("cpu", needed, what, "a larger patches.macro_cell is needed.")
        return executor

    def model(self, parts: Parts) -> Model:
        """Make a model of all patches."""
        patches, half_space = parts.study.patch_layout, parts.task.half_space
        width.refuse_unsuitable(parts.study, patches, parts.heights)
        of_law = models_patches.HalfSpacePatches if half_space else models_two_scale.TwoScaleModel
        return of_law(parts.task, patches, parts.heights, parts.executor)


def arrangement_of(study: Study) -> Maker:
    """Find what makes the runs of a study."""
    return Maker.REGISTERED[name_of(study)]


def is_alike(task: ContactTask, recedes: bool) -> bool:
    """Tell whether all cells at rest follow one law. recedes: by a bearing curve of what no cell resolves."""
    return task.is_uniform and not (task.half_space or recedes or task.pieces is not None)


def model_at_rest(
    task: ContactTask, heights: FloatArray, executor: Executor, *, bearing_curve: Logistic | None = None
) -> Model:
    """Return the model of one grid that lies still. Laws cell by cell are those of a track that lies still.

    heights: of the disc over its mean plane [mm], shape (nx, ny). bearing_curve: of a roughness that the grid
    does not resolve.
    """
    if is_alike(task, bearing_curve is not None):
        return models_rest.OneScaleModel(task, heights, executor)
    # The asperities spring back: a dent that stays would be pressed anew in each step.
    task = replace(task, keeps_dents=False)
    track = Track.at_rest(executor.grid)
    return models_track.SweptModel(task, track, heights, executor, bearing_curve=bearing_curve)
