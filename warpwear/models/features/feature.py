"""What a study may add to the steps of a contact: each feature adds its part to a program, and books it."""

from collections.abc import Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar, NamedTuple, Protocol

from warpwear.contact.half_space.solver import HalfSpaceContact
from warpwear.engine.executor import Arguments, Executor, Field
from warpwear.engine.numbers import Numbers
from warpwear.engine.program import Program
from warpwear.grid import FloatArray
from warpwear.history.pieces import PieceBook
from warpwear.history.recorder import Ledger
from warpwear.laws.bearing_curve import Logistic
from warpwear.laws.task import ContactTask


class Place(NamedTuple):
    """Holds what the passes of a step work on, as kernels take it; hosts have some of it."""

    slides: Field  # a `Slide` in an array
    steps: Arguments = None  # their history and flags
    springs: Arguments = None  # of the search for the load
    listed: tuple[Field, ...] = ()  # the list of tiles, and how many each row has
    sources: Arguments = None  # what properties of cells follow from
    cells: Arguments = None  # `CellProperties`
    bodies: Arguments = None
    tables: Arguments = None
    pressed: Arguments = None  # what a search leaves of a contact, where it is stored


@dataclass(frozen=True)
class Site:
    """Holds what features are made from: a task, and the contact that they are added to.

    bodies: fields by the names of `Bodies`, or `worn` by both, where they wear in one proportion [mm].
    periodic, track_fraction: as of `SlidingContact`. distances: factor of those that cells of the disc slide,
    where they differ. curve: of a roughness that the grid does not resolve.
    """

    task: ContactTask
    executor: Executor
    bodies: Mapping[str, Field]
    periodic: bool = False
    track_fraction: float = 1.0
    distances: Field | None = None
    curve: Logistic | None = None

    @property
    def laws(self) -> dict[str, Any]:
        """Return the laws of features by their names; None where nothing asks for them."""
        task = self.task
        own: dict[str, Any] = {"film": task.film, "particles": task.pieces, "fretting": task.fretting}
        shears = () if task.shears_unalike else None  # whatever bodies are made of
        own |= {"materials": task.profiles or shears, "recession": self.curve, "distances": self.distances}
        return {**own, **task.features}


class Host(Protocol):
    """What a host on the half-space lends a feature before the wear of a part of a step."""

    gap: Field
    slides: Numbers
    ledger: Ledger

    def make_gap(self) -> None:
        """Make the gap that cells meet, by the numbers in `slides`."""

    def solve(self) -> HalfSpaceContact:
        """Solve the contact on that gap as it lies, without the wear of a step."""


class Feature:
    """Adds an optional part to a step: a host asks all that it has, in their order, and none by its name.

    A step is a search, the wear of both bodies where it has found a balance, and a row of the history. On
    springs it has one part, on the half-space one or more. Hosts of patches ask only some of the hooks.

    ============= ====================================================== ===============================
    hook          on springs (`track.local`)                             on the half-space
    ============= ====================================================== ===============================
    prepare       never                                                  on the host, before each part
    before_search once a step, before it is known to be balanced         before each part
    make_all      in steps that are asked for their pressure             never
    before_wear   once, of balanced steps                                in each part
    after_wear    once, of balanced steps                                in each part
    between       after the wear, and again while `drain` says so        after all parts, and likewise
    end_step      once, of balanced steps, before their row              once, after all parts
    after_part    once, after the row                                    after each part, before `between`
    drain         on the host, after each program                        on the host, after `between`
    ============= ====================================================== ===============================

    What may be asked again may change nothing by that: all else belongs into `end_step`.
    """

    #: Those that studies may ask for, by the names of their laws in a task.
    REGISTERED: ClassVar[dict[str, Any]] = {}
    name: ClassVar[str] = ""
    #: What steps change of it, and what else is an array, see `warpwear.engine.state`.
    STATE: ClassVar[Mapping[str, Any]] = {}
    SCRATCH: ClassVar[tuple[str, ...]] = ()
    #: What cells have of their own by it, by the names of `CellProperties`, and what that is made from, by
    #: those of `Sources`.
    properties: Mapping[str, Field] = MappingProxyType({})
    sources: Mapping[str, Any] = MappingProxyType({})
    #: Whether it changes heights after the pass that wears, and whether it may raise a surface so that gaps
    #: close: its host then makes the bounds of tiles anew after it.
    changes_heights = False
    raises = False
    #: Columns beside those touched that it may change, and cells along an edge that must not be touched.
    margin = 0
    edge = 1
    #: Its own columns of the history, after those of every contact, and the index of the first of them.
    columns: ClassVar[tuple[str, ...]] = ()
    _first_column = 0
    #: What it adds to `Pressed`, by its names, and whether pressures move with the counter-body by it, so
    #: that the disc sees their mean.
    pressed: Mapping[str, Field] = MappingProxyType({})
    moves_pressure = False
    #: Rows of the disc that pass over one of the counter-body in a step; None: as many as a step goes over.
    window: int | None = None
    #: Compliance that it lends each cell in a step [mm/MPa]; None where it lends none.
    yields: Field | None = None
    #: What has left the bodies piece by piece; None where nothing does.
    book: PieceBook | None = None

    def __init_subclass__(cls, *, name: str = "") -> None:
        """Register a feature that studies may ask for, by name. What it makes for cells is always scratch."""
        cls.SCRATCH = tuple({*cls.SCRATCH, "properties", "sources", "pressed", "yields"})
        if name:
            cls.name = name
            cls.REGISTERED[name] = cls

    @property
    def first_column(self) -> int:
        """Return the index of the first of its columns. Raises TypeError where it declares none."""
        if not self.columns:
            raise TypeError(f"{type(self).__name__} declares no columns of the history")
        return self._first_column

    def beside(self, columns: tuple[int, int]) -> tuple[int, int]:
        """Return the first column that the part may change beside these, and the one after the last."""
        return columns

    def prepare(self, host: Host, increment: float, removals: tuple[float, float]) -> None:
        """Prepare a part of a step, on the host. removals: K ΔL of both bodies [mm³/N]."""

    def wears(self, removals: tuple[float, float]) -> dict[str, Any]:
        """Return what of a `Slide` it changes in a part of a step that would wear by K ΔL [mm³/N]."""
        return {}

    def ratios(self, window: int) -> tuple[float, float]:
        """Return K of both bodies by which all cells lend compliance, over that of a step.

        window: rows whose mean pressure wears one of both.
        """
        return 1.0, 1.0

    def note(self, contact: HalfSpaceContact) -> None:
        """Take note of a contact on the half-space that was solved under the load."""

    def row(self, increment: float, total: Mapping[str, float]) -> dict[str, float]:
        """Return columns of a part of a step over an increment [mm], which follow from its sums."""
        return {}

    def worn(self, removals: tuple[float, float], row: Mapping[str, float]) -> tuple[float, float]:
        """Return K ΔL [mm³/N] by which bodies have worn in a part with that row."""
        return removals

    def at_beginning(self, program: Program) -> AbstractContextManager[None]:
        """Enclose what is done once in a step up to its wear, where it may stop a step on its way."""
        return nullcontext()

    def before_search(self, program: Program, place: Place) -> None:
        """Add to a program what comes before the search."""

    def make_all(self, program: Program, place: Place) -> None:
        """Add to a program that the properties of all cells are made: of other than listed tiles and gaps."""

    def before_wear(self, program: Program, place: Place) -> None:
        """Add to a program what comes between a balance and the wear by it."""

    def after_wear(self, program: Program, place: Place) -> None:
        """Add to a program what follows the wear."""

    def between(self, program: Program, place: Place) -> None:
        """Add to a program what comes between the wear and the row of the history, and may stop the step.

        It is asked again after each stop.
        """

    def end_step(self, program: Program, place: Place) -> None:
        """Add to a program what is done exactly once in a step, before its row of the history."""

    def at_end(self, program: Program) -> AbstractContextManager[None]:
        """Enclose the row of the history, and what follows it."""
        return nullcontext()

    def after_part(self, program: Program, place: Place) -> None:
        """Add to a program what follows a part of a step; on springs after the row of the history."""

    def drain(self) -> bool:
        """Take over what a program has left; tell whether it stopped on its way and is to be run again."""
        return False

    def end_steps(self, count: int) -> None:
        """Take note that a program has made so many steps."""

    def enter(self, columns: Mapping[str, FloatArray], total: dict[str, Any], most: dict[str, Any]) -> None:
        """Enter among the sums and maxima of steps what the columns of their history say: all, by name."""
        total |= {name: columns[name] for name in self.columns}

    def fields(self, pressure: FloatArray) -> dict[str, FloatArray]:
        """Return its fields of a snapshot under a pressure [MPa], by their names."""
        return {}
