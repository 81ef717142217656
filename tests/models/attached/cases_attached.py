"""A part that a test adds to the steps of a contact on springs: debris that lies on the disc."""

from collections.abc import Mapping
from typing import Any, ClassVar

import pytest
import warp as wp
from cases_track import small

from warpwear.engine.executor import Executor, Field
from warpwear.engine.program import Program
from warpwear.engine.state import InFrame
from warpwear.grid import FloatArray
from warpwear.kernels.cells import Cells
from warpwear.kernels.sliding import Slide
from warpwear.models.attachment import Attachment, Place
from warpwear.models.film import BareCells
from warpwear.models.model import Model
from warpwear.runs.order import RunOrder
from warpwear.study.study import Study

SMALL = {"grid.cell": "20 um", "grid.extent": "0.6 mm", "sliding.distance": "3 mm", "output.snapshots": []}
REST = SMALL | {"stepping.first": "30 um", "counter.radius": "1 mm"}
PATCHES = SMALL | {"stepping.first": "30 um", "patches.macro_cell": "100 um"}
HALF_SPACE = {"contact.law": "half-space"}
#: A study of every model.
STUDIES = {
    "track": small("representative"),
    "track, bearing area": small("full", stepping__scheme="explicit", stepping__force=True),
    "track, half-space": small("representative").replace(HALF_SPACE),
    "rest": Study.load("v3-fine").replace(REST),
    "rest, across": Study.load("v3-fine").replace(REST | {"wear.distance_factor": "across"}),
    "rest, half-space": Study.load("v3-fine").replace(REST | HALF_SPACE),
    "patches": Study.load("two-scale").replace(PATCHES),
    "patches, load": Study.load("two-scale").replace(PATCHES | {"patches.coupling": "load"}),
    "patches, half-space": Study.load("two-scale").replace(
        PATCHES | HALF_SPACE | {"patches.bulk": "none", "contact.boundary": "free"}
    ),
}


def needs_transforms(study: Study, device: str) -> None:
    if device != "cpu" and study.contact.law == "half-space":
        pytest.importorskip("cupy")


@wp.kernel
def lay(
    first_slot: wp.int32,
    slots: wp.int32,
    slides: wp.array(dtype=Slide),
    depth: wp.float64,
    debris: wp.array2d(dtype=Cells),
    disc: wp.array2d(dtype=Cells),
):
    """Lays a depth [mm] on the disc's cells under the counter-body."""
    every = slides[0].rows * debris.shape[1]
    for n in range(first_slot * wp.block_dim() + wp.tid(), every, slots * wp.block_dim()):
        row = (slides[0].shift + n // debris.shape[1]) % debris.shape[0]
        column = n % debris.shape[1]
        debris[row, column] = debris[row, column] + Cells(depth)
        disc[row, column] = disc[row, column] + Cells(depth)


@wp.kernel
def note(slides: wp.array(dtype=Slide), first: wp.int32, history: wp.array2d(dtype=wp.float64)):
    """Enters numbers that tell the step."""
    if wp.tid() == 0:
        history[slides[0].number, first] = slides[0].end
        history[slides[0].number, first + 1] = -slides[0].end


class Debris(Attachment):
    """Lies on the disc, everywhere under the ball, a little deeper after every step."""

    STATE: ClassVar = {"depth": InFrame("disc")}
    columns = "debris", "debris_negated"
    raises = True
    #: That a step lays [mm].
    of_step = 1.0e-9

    def __init__(self, executor: Executor, rows: int) -> None:
        self.depth: Field = executor.zeros(rows)
        self.bare = executor.zeros()  # as a film has it
        self.executor = executor
        #: What was entered.
        self.entered: list[tuple[float, float]] = []

    def before_wear(self, program: Program, place: Place) -> None:
        program.decide(note, place.slides, self.first_column, place.steps.history)

    def after_step(self, program: Program, place: Place) -> None:
        program.launch(lay, place.slides, self.of_step, self.depth, place.bodies.disc)

    def enter(self, columns: Mapping[str, FloatArray], total: dict[str, Any], most: dict[str, Any]) -> None:
        self.entered += zip(*(columns[name].tolist() for name in self.columns), strict=True)


def attach(monkeypatch: pytest.MonkeyPatch, kind: type[Debris] = Debris) -> list[Debris]:
    """Let every contact have debris in the place of a film; return those made from here on."""
    made: list[Debris] = []

    def of_bodies(film: Any, executor: Executor, counter: Field, disc: Field) -> Debris:
        made.append(kind(executor, disc.shape[0]))
        return made[-1]

    monkeypatch.setattr(BareCells, "of_bodies", of_bodies)
    return made


def model_of(study: Study, executor: Executor) -> Model:
    """The model of a study's first block, on unworn bodies."""
    order = RunOrder(study)
    return order.model(executor, block=order.blocks[0]).model
