"""All features of a contact, asked in one order, and what they make of its cells."""

import importlib
import math
import pkgutil
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import AbstractContextManager, ExitStack, contextmanager
from copy import copy
from types import MappingProxyType
from typing import Any, ClassVar, Self

import numpy as np

from warpwear.engine import state
from warpwear.engine.executor import Arguments, Executor, Field, arguments
from warpwear.engine.program import Program
from warpwear.grid import FloatArray
from warpwear.history import quantities
from warpwear.kernels.cells import CellProperties, Sources
from warpwear.laws.task import ContactTask
from warpwear.models import features as folder
from warpwear.models.features.feature import Feature, Place, Site
from warpwear.models.features.recession import UnequalStiffness

# Features are asked in the order of their files, each of which registers its own.
for file in pkgutil.iter_modules(folder.__path__, f"{folder.__name__}."):
    importlib.import_module(file.name)

NONE: Mapping[str, Field] = MappingProxyType({})


class Features:
    """Holds the features of a contact by name, in the order in which each is asked.

    by_name: of which no two set one property of cells or write one column. own: columns of the history before
    theirs. bodies: as of a `Site`.

    Raises ValueError for two that set or write the same, TypeError for one that does not declare what it has.
    """

    STATE: ClassVar = {"by_name": dict}
    SCRATCH: ClassVar = ("cells", "sources", "pressed")

    def __init__(
        self, by_name: Mapping[str, Feature], *, own: tuple[str, ...] = (), bodies: Mapping[str, Field] = NONE
    ) -> None:
        self.by_name = dict(by_name)
        #: Columns of the history: a contact's own, and theirs.
        self.columns = give_columns(self.by_name, own)
        for name, one in self.by_name.items():
            check(one, name, bodies.values())
        self._merge(disc_rows=bodies["disc"].shape[0] if "disc" in bodies else 0)
        #: Adds to a program that bounds are made anew, after a feature that raises a surface.
        self.refresh: Callable[[Program], None] | None = None

    @classmethod
    def of(
        cls,
        task: ContactTask,
        executor: Executor,
        bodies: Mapping[str, Field],
        *,
        own: tuple[str, ...] = (),
        **others: Any,
    ) -> Self:
        """Return those that a task asks for. bodies, others: as of a `Site`. own: as of the class.

        Raises TypeError for a law that no feature follows, or none of patches.
        """
        site = Site(task, executor, bodies, **others)
        laws = {name: law for name, law in site.laws.items() if law is not None}
        if lost := laws.keys() - Feature.REGISTERED.keys():
            raise TypeError(f"no feature is called {', '.join(sorted(lost))}")
        if "worn" in bodies and task.features:
            raise TypeError(f"patches follow no {', '.join(task.features)}, and their keys do not say so")
        features = {n: make(laws[n], site) for n, make in Feature.REGISTERED.items() if n in laws}
        curve, distances = site.curve, site.distances
        materials: Any = features.get("materials")
        by_materials = materials is not None and materials.gives and not task.half_space  # which has yields
        if task.implicit and not (curve is None and distances is None and not by_materials):
            alike = curve is None and distances is not None and distances.shape[0] == 1
            features["stiffness"] = UnequalStiffness(executor, bodies, curve, alike=alike)
        return cls(features, own=own, bodies=bodies)

    def _merge(self, *, disc_rows: int) -> None:
        """Bring together what cells have of their own, and what that is made from, for kernels."""
        self.cells: Arguments = arguments(CellProperties, **self._merged("properties"))
        self.sources: Arguments = arguments(Sources, disc_rows=disc_rows, **self._merged("sources"))
        self.pressed = self._merged("pressed")

    def without(self, *names: str) -> "Features":
        """Return the others alone, among the columns of all."""
        others = copy(self)
        others.by_name = {name: one for name, one in self.by_name.items() if name not in names}
        others._merge(disc_rows=self.sources.disc_rows)
        return others

    def __iter__(self) -> Iterator[Feature]:
        return iter(self.by_name.values())

    def __bool__(self) -> bool:
        return bool(self.by_name)

    def _merged(self, of: str) -> dict[str, Any]:
        """Return what all of them have by name."""
        merged: dict[str, Any] = {}
        for one in self:
            if twice := sorted(merged.keys() & getattr(one, of).keys()):
                raise ValueError(f"{of} of cells that two would set: {', '.join(twice)}")
            merged |= getattr(one, of)
        return merged

    @property
    def changes_heights(self) -> bool:
        """Tell whether more than the pass that wears changes heights, so that no list or gap stays."""
        return any(one.changes_heights or one.raises for one in self)

    @property
    def moves_pressure(self) -> bool:
        """Tell whether pressures move with the counter-body, so that the disc sees their mean."""
        return any(one.moves_pressure for one in self)

    def value_of(self, name: str) -> Any:
        """Return the `window`, `yields` or `book` of the one that has it; None where none does."""
        return next((said for one in self if (said := getattr(one, name)) is not None), None)

    def ratios(self, window: int) -> tuple[float, float]:
        """Return K of both bodies by which all cells lend compliance, over that of a step."""
        counter, disc = zip((1.0, 1.0), *(one.ratios(window) for one in self), strict=True)
        return math.prod(counter), math.prod(disc)

    def beside(self, columns: tuple[int, int]) -> tuple[int, int]:
        """Return the first column that they may change beside these, and the one after the last."""
        for one in self:
            columns = one.beside(columns)
        return columns

    def softest(self, executor: Executor, slides: Field) -> float | None:
        """Find the smallest stiffness of a cell in the step in an array [N/mm³]; None of cells alike."""
        stiffness = self.by_name.get("stiffness")
        assert stiffness is None or isinstance(stiffness, UnequalStiffness)
        if stiffness is None:
            return None
        program = Program(executor, records=False)
        stiffness.add_to(program, Place(slides, sources=self.sources, cells=self.cells))
        program.run()
        values = self.cells.stiffness.numpy()
        return float(np.min(values[values > 0.0]))

    def ask(self, hook: str, program: Program, place: Place) -> None:
        """Let each add its part; after one that may close gaps the bounds are made anew."""
        place = place._replace(sources=self.sources, cells=self.cells)
        for one in self:
            getattr(one, hook)(program, place)
            if self.refresh and one.raises and asks(one, hook):
                self.refresh(program)

    @contextmanager
    def enclosing(self, hook: str, program: Program) -> Iterator[None]:
        """Enter the blocks by which each encloses a part of a program, one within another."""
        with ExitStack() as stack:
            for one in self:
                block: AbstractContextManager[None] = getattr(one, hook)(program)
                stack.enter_context(block)
            yield

    def drain(self) -> bool:
        """Let each take over what a program has left; tell whether it is to go on in its step."""
        return sum(one.drain() for one in self) > 0  # all of them

    def end_steps(self, count: int) -> None:
        """Let each take note that a program has made so many steps."""
        for one in self:
            one.end_steps(count)

    def row(self, increment: float, total: Mapping[str, float]) -> dict[str, float]:
        """Return columns of a part of a step over an increment [mm], which follow from its sums."""
        return {name: value for one in self for name, value in one.row(increment, total).items()}

    def worn(self, removals: tuple[float, float], row: Mapping[str, float]) -> tuple[float, float]:
        """Return K ΔL [mm³/N] by which bodies have worn in a part with that row."""
        for one in self:
            removals = one.worn(removals, row)
        return removals

    def enter(self, columns: Mapping[str, Any], total: dict[str, Any], most: dict[str, Any]) -> None:
        """Let each enter among sums and maxima what the columns of the history say of it.

        Raises TypeError where one has written more columns than it declares.
        """
        for name, one in self.by_name.items():
            if one.columns and np.any(columns.get(end_of(name), 0.0)):
                raise TypeError(f"{name} writes more columns of the history than it declares")
            one.enter(columns, total, most)

    def fields(self, pressure: FloatArray) -> dict[str, Any]:
        """Return their fields of a snapshot under a pressure [MPa]."""
        return {name: field for one in self for name, field in one.fields(pressure).items()}


def asks(one: Feature, hook: str) -> bool:
    """Tell whether a feature does anything in a hook."""
    return getattr(type(one), hook) is not getattr(Feature, hook)


def end_of(name: str) -> str:
    """Return the name of the column behind those of a feature, which nobody writes."""
    return f"end of {name}"


def check(one: Feature, name: str, others: Collection[Any]) -> None:
    """Raise TypeError for a feature that does not declare what it has. others: arrays that are another's."""
    state.check(one, name, others)
    if asks(one, "between") and not asks(one, "drain"):
        raise TypeError(
            f"{name} has a hook `between`, which may be asked again, and no `drain`: see `end_step`"
        )
    for column in (quantities.BY_NAME.get(c) for c in one.columns):
        if column and column.units == "mm^3" and column.frame is None:
            raise TypeError(f"{column.name} of {name} does not say of which body it is, as in [mm^3, disc]")


def give_columns(features: Mapping[str, Feature], own: tuple[str, ...]) -> tuple[str, ...]:
    """Give features their columns of the history, behind a contact's own; return the names of all.

    Raises ValueError for two columns of one name.
    """
    names = [*own]
    for name, one in features.items():
        one._first_column = len(names)
        names += (*one.columns, end_of(name)) if one.columns else ()
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise ValueError(f"columns of the history that two would write: {', '.join(twice)}")
    return tuple(names)
