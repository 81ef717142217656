"""A part that a test adds to the steps of a contact on springs: debris that lies on the disc."""

from collections import deque
from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np
import pytest
import warp as wp
from cases_track import rough, small

from warpwear.engine.executor import Executor, Field
from warpwear.engine.program import Program
from warpwear.engine.state import InFrame
from warpwear.grid import FloatArray
from warpwear.kernels.cells import Cells
from warpwear.kernels.sliding import Slide
from warpwear.models.features.feature import Feature, Place
from warpwear.models.features.features import Features
from warpwear.models.model import Model
from warpwear.models.track.half_space import SlidingHalfSpace
from warpwear.models.track.local import SlidingContact
from warpwear.runs.order import RunOrder
from warpwear.study.study import Study

SMALL = {"grid.cell": "20 um", "grid.extent": "0.6 mm", "sliding.distance": "3 mm", "output.snapshots": []}
REST = SMALL | {"stepping.first": "30 um", "counter.radius": "1 mm"}
PATCHES = SMALL | {"stepping.first": "30 um", "patches.macro_cell": "100 um"}
HALF_SPACE = {"contact.law": "half-space"}
PARTICLES = {"wear.particle": "60 um", "wear.particle_thickness": "0.6 um"}
STEPS = 20
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


class Debris(Feature):
    """Lies on the disc, everywhere under the ball, a little deeper after every step."""

    STATE: ClassVar = {"depth": InFrame("disc")}
    columns = "debris", "debris_negated"
    raises = True
    #: That a step lays [mm].
    of_step = 1.0e-9

    def __init__(self, executor: Executor, rows: int) -> None:
        self.depth: Field = executor.zeros(rows)
        self.executor = executor
        #: What was entered.
        self.entered: list[tuple[float, float]] = []

    def before_wear(self, program: Program, place: Place) -> None:
        program.decide(note, place.slides, self.first_column, place.steps.history)

    def after_part(self, program: Program, place: Place) -> None:
        program.launch(lay, place.slides, self.of_step, self.depth, place.bodies.disc)

    def enter(self, columns: Mapping[str, FloatArray], total: dict[str, Any], most: dict[str, Any]) -> None:
        values = (np.atleast_1d(columns[name]).tolist() for name in self.columns)
        self.entered += zip(*values, strict=True)


def attach(monkeypatch: pytest.MonkeyPatch, kind: type[Debris] = Debris) -> list[Debris]:
    """Let every contact on a disc have debris before its features; return those made from here on."""
    made: list[Debris] = []
    of = Features.of

    def with_debris(task: Any, executor: Executor, bodies: Mapping[str, Field], **options: Any) -> Features:
        rows = bodies["disc"].shape[0]
        made.append(kind(executor, rows))
        by_name = {"debris": made[-1], **of(task, executor, bodies, **options).by_name}
        return Features(by_name, own=options.get("own", ()), bodies=bodies)

    monkeypatch.setattr(Features, "of", with_debris)
    return made


def model_of(study: Study, executor: Executor) -> Model:
    """The model of a study's first block, on unworn bodies."""
    order = RunOrder(study)
    return order.model(executor, block=order.study.blocks[0]).model


def rows_of(law: str, device: str) -> list[dict[str, Any]]:
    """Steps of wear in particles."""
    scheme = {"stepping.scheme": "explicit" if law == "local" else "implicit"}
    study = small("full", stepping__force=True).replace(PARTICLES | scheme | {"contact.law": law})
    shifts, increments = [study.track.row(step) for step in range(STEPS)], [0.5] * STEPS
    with Executor(study.cells, device=device) as executor:
        task, disc = study.contact_task, rough(study.track.rows)
        if law == "local":
            return [step.row for step in SlidingContact(task, disc, executor).replay(shifts, increments)[1]]
        contact = SlidingHalfSpace(task, disc, executor)
        return [contact.step(*move).row for move in zip(shifts, increments, strict=True)]


def arrays_of(owner: Any) -> dict[str, "np.ndarray[Any, Any]"]:
    """Copies of all arrays that an object of warpwear holds, by the way to them, but for its scratch.

    Parts, structs and containers are gone through; what a class names in `SCRATCH` is not.
    """
    found: dict[str, np.ndarray[Any, Any]] = {}
    seen: set[int] = set()

    def look(value: Any, path: str) -> None:
        if isinstance(value, wp.array | np.ndarray):
            found[path] = np.array(value.numpy() if isinstance(value, wp.array) else value)
            return
        if id(value) in seen or isinstance(value, Executor | Program):
            return
        seen.add(id(value))
        if isinstance(value, Mapping):
            members = {str(name): item for name, item in value.items()}
        elif isinstance(value, list | tuple | deque):
            members = {str(number): item for number, item in enumerate(value)}
        elif hasattr(value, "_cls") and hasattr(value, "__ctype__"):  # a struct of Warp
            members = {name: getattr(value, name) for name in value._cls.vars}
        elif type(value).__module__.startswith("warpwear."):
            scratch = getattr(type(value), "SCRATCH", ())
            members = {name: item for name, item in vars(value).items() if name not in scratch}
        else:
            return
        for name, item in members.items():
            look(item, f"{path}.{name}" if path else name)

    look(owner, "")
    return found
