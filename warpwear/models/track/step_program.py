"""Parts of a step that follow each other are made by one program: gaps, contacts, wear, and their sums."""

from collections.abc import Callable, Sequence
from typing import Any

from warpwear.contact.half_space.window import Stay
from warpwear.engine.executor import Executor, Field, arguments
from warpwear.engine.numbers import Mirror, Numbers
from warpwear.engine.program import Program
from warpwear.grid import FloatArray
from warpwear.kernels.cells import MAXIMA, PressureSum, names_of
from warpwear.kernels.half_space import parts as kernels
from warpwear.kernels.half_space import passes
from warpwear.kernels.half_space.parts import PartFlag, StepParts
from warpwear.kernels.half_space.solve import Request
from warpwear.models.track.step_means import Made, Substep

#: Parts of a step that are made in one go at most.
MOST = 32
SUMS = names_of(PressureSum)


class StepProgram:
    """Makes parts of steps in one go.

    slides: of the part that is made. laps: where pressures of other laps lie. cap: largest pressure [MPa].
    tables: sums and maxima of the
    pass that wears. add_gaps, add_wear, add_after: add to a program what a part begins with, how it wears,
    and what follows its sums.
    """

    def __init__(
        self,
        executor: Executor,
        slides: Numbers,
        laps: Field,
        tables: tuple[Field, Field],
        *,
        cap: float,
        add_gaps: Callable[[Program], None],
        add_wear: Callable[[Program], None],
        add_after: Callable[[Program], None],
    ) -> None:
        self._slides, self._tables, self._device = slides, tables, executor.device
        self._of_laps = {"laps": laps, "cap": cap}
        self._adds = add_gaps, add_wear, add_after
        left = len(SUMS) + len(MAXIMA) + 2
        shapes: dict[str, Any] = {
            "slides": MOST,
            "requests": (MOST, len(Request)),
            "starts": (MOST, 5),
            "ahead": MOST,
        }
        shapes |= {"left": (MOST, left), "box": 4, "numbers": 2, "flags": len(PartFlag)}
        self._parts = arguments(StepParts, executor.device, **shapes)
        names = "slides", "requests", "starts", "ahead", "box", "numbers", "flags"
        self._inputs = Mirror(*(getattr(self._parts, name) for name in names))
        self._slide = slides.host
        self._outputs = Mirror(self._parts.numbers, self._parts.left)

    def set(
        self,
        parts: Sequence[Substep],
        request: FloatArray,
        starts: Sequence[tuple[int, int, int, bool, bool]],
        ahead: Sequence[float],
        *,
        anew: tuple[bool, bool],
    ) -> None:
        """Say what the next parts are, but for their places as `slides` are now, and where they start.

        request: of any part, by `Request`. starts: of each pressure `first` of a `passes.Lap`, whether it
        starts there, and whether it stays there; ahead: as of that. anew: whether the first and the others
        start from nothing.
        """
        slides, requests, lying, far, *_ = (values[: len(parts)] for values in self._inputs.values)
        slides[:], requests[:], lying[:], far[:] = self._slide[0], request, starts, ahead
        slides["shift"] = [part.shift for part in parts]
        slides["start"] = [part.start for part in parts]
        slides["end"] = [part.start + part.increment for part in parts]
        requests[:, Request.TOLERANCE] = [part.tolerance or request[Request.TOLERANCE] for part in parts]
        requests[-1, Request.CERTIFIED] = parts[-1].certified or False
        requests[0, Request.ANEW], requests[1:, Request.ANEW] = anew

    def run(self, count: int, stay: Stay, name: Any) -> tuple[int, Made | None]:
        """Make so many parts that were set; return how many were made, and what they left."""
        *tables, box, numbers, flags = self._inputs.values
        box[:], numbers[:], flags[PartFlag.GOES_ON] = stay.box, (0, count), 1
        self._inputs.send()
        stay.here.program(name, lambda program: self._add(program, stay), stay.search).run()
        (done, _), left = self._outputs.read()
        certificate = None
        if tables[1][count - 1, Request.CERTIFIED] and done == count:
            stay.search.read()
            certificate = stay.search.certificate()
        *of_cells, approaches, transforms = left[:done].T.copy()
        sums, most = (
            dict(zip(SUMS, of_cells, strict=False)),
            dict(zip(MAXIMA, of_cells[len(SUMS) :], strict=True)),
        )
        return int(done), Made(approaches, int(transforms.sum()), certificate, sums, most) if done else None

    def _add(self, program: Program, stay: Stay) -> None:
        parts, slides, here = self._parts, self._slides.array, stay.here
        lap = arguments(passes.Lap, self._device, first=3, **self._of_laps)
        lap.pressure = here.solver.pressure_field
        solve, (add_gaps, add_wear, add_after) = stay.search.arguments, self._adds

        with program.loop(parts.flags, PartFlag.GOES_ON):
            program.decide(kernels.begin_part, parts, slides, solve, lap)
            add_gaps(program)
            stay.add_to(program, lap, parts.flags, PartFlag.FROM_LAP)
            program.decide(kernels.settle, parts, slides, solve, stay.extents)
            with program.branch(parts.flags, PartFlag.WEARS):
                add_wear(program)
                with program.branch(parts.flags, PartFlag.KEEPS):
                    # Instead of that of the lap before the last.
                    keeps = {"field": lap.pressure, "target": lap.laps, "first": lap.first}
                    here.add(program, passes.give_window, arguments(passes.Transfer, **keeps))
                program.decide(kernels.book_part, parts, slides, solve, *self._tables)
                add_after(program)
