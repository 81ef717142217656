"""The load of cells that do not feel each other is balanced as a part of a program."""

from typing import Any

import numpy as np
import warp as wp

from warpwear.contact.balance import TOLERANCE, Balance
from warpwear.engine.executor import Arguments, Executor, Field, arguments
from warpwear.engine.program import Program, launch_once
from warpwear.engine.tiles import TileList
from warpwear.errors import ConvergenceError
from warpwear.grid import FloatArray
from warpwear.kernels import balance, bearing
from warpwear.kernels.contact import Bends
from warpwear.kernels.newton import STUCK

#: Of cells whose K is the same at every pressure.
NO_KNOTS: FloatArray = np.zeros((0, 3))
#: Vectors for the gaps that a slot gathers inside the bracket of a bearing area.
NEAR = 64


def bends_of(knots: FloatArray, executor: Executor, *step: float) -> Arguments:
    """Make what kernels take of K over the pressure. knots: see `laws.archard.knots_of`."""
    arrays: Any = {"knots": knots, "step": (*step, 0.0, 0.0, 0.0)[:3]}
    arrays = {name: wp.array(one, dtype=wp.float64, device=executor.device) for name, one in arrays.items()}
    return arguments(Bends, **arrays)


class LoadSearch:
    """Searches for the approach at which a gap carries a load, in passes over its listed tiles.

    stiffness: 1/c of every cell [N/mm³], one row for all or one a row of cells; None where each search has
    one for all. cap_ratio: of the hardness, that cells bear; None: all of it. tolerance: of a bearing area
    [N], whose cells do not yield; None for springs. knots: of `Bends`, where K goes with the
    pressure. It is made before anything is worn.
    """

    def __init__(
        self,
        executor: Executor,
        gap: Field,
        tiles: TileList,
        *,
        load: float,
        hardness: float,
        stiffness: Field | None = None,
        cap_ratio: Field | None = None,
        tolerance: float | None = None,
        knots: FloatArray = NO_KNOTS,
    ) -> None:
        device = executor.device
        self.is_rigid = tolerance is not None
        self._executor, self._tiles = executor, tiles
        none, slots = executor.zeros(0), executor.slots_of(executor.grid.nx)
        self._gap, self._cap_ratio, self._stiffness = gap, cap_ratio or none, stiffness or none
        gathers = self.is_rigid and self._cap_ratio.shape[0] == 0
        #: For kernels.
        self.springs = arguments(
            balance.Springs,
            device,
            load=load,
            cap=hardness,
            cell_area=executor.grid.cell_area,
            tolerance=TOLERANCE * load if tolerance is None else tolerance,
            lists=tiles.lists.array,
            listing=tiles.listing,
            trial=(5, slots),
            near=(slots if gathers else 0, NEAR),
            bends=bends_of(knots, executor),
        )
        #: What the pressures follow from, when a search has ended.
        self.law: Field = self.springs.law
        if self.is_rigid:
            self._launch_once(bearing.counted_below, self.springs, gap, cap_ratio)
            self.springs.highest = float(self.springs.trial.numpy()[2].max())

    def add_to(self, program: Program, judge: Any = None, *state: Any) -> None:
        """Search in a program until `searching` is 0.

        judge: kernel that decides what follows from a pass, of the springs and a state; by default one that
        only searches.
        """
        if judge is None:
            judge = bearing.judge_area if self.is_rigid else balance.judge
        fields = (
            [self._gap, self._cap_ratio] if self.is_rigid else [self._gap, self._stiffness, self._cap_ratio]
        )
        look, tiles = bearing.counted_below if self.is_rigid else balance.carried, self._tiles
        with program.loop(self.springs.searching):
            tiles.add_to(program)
            program.launch(look, tiles.list, tiles.count, self.springs, *fields, chunks=lambda: tiles.chunks)
            program.decide(judge, self.springs, *state)

    def solve(self) -> Balance:
        """Search where nothing is known, on springs of a field of stiffnesses. Raises ConvergenceError."""
        program, smallest = Program(self._executor, records=False), self._tiles.smallest
        if self.is_rigid:
            program.decide(bearing.begin, self.springs, smallest)
        else:
            values = self._stiffness.numpy()
            program.decide(balance.begin, self.springs, smallest, float(values[values > 0.0].min()))
        self.add_to(program)
        program.run()
        law, search = self.law.numpy()[0], self.springs.search.numpy()[0]
        self.check()
        numbers = {name: float(law[name]) for name in law.dtype.names}
        return Balance(
            load_residual=float(search["residual"]), evaluations=int(search["evaluations"]), **numbers
        )

    def pressures(self, at: Balance | None = None) -> FloatArray:
        """Return the pressure of every cell [MPa], shape (nx, ny). at: a balance; None: the one found."""
        field = self._executor.zeros()
        if at is not None:
            law = self.law.numpy()
            for name in law.dtype.names:
                law[name] = getattr(at, name)
            self.law.assign(law)
        self._launch_once(balance.pressures, self.springs, self._gap, self._stiffness, self._cap_ratio, field)
        return self._executor.to_numpy(field)

    def _launch_once(self, kernel: Any, *arguments: Any) -> None:
        """Launch a kernel over the listed tiles."""
        listed = self._tiles.list, self._tiles.count
        launch_once(self._executor, kernel, *listed, *arguments, chunks=self._tiles.chunks)

    def check(self) -> None:
        """Raise ConvergenceError where the last search has found no balance."""
        search = self.springs.search.numpy()[0]
        if search["bracket"]["state"] != STUCK:
            return
        load, approach = self.springs.load, float(search["base"] + search["bracket"]["offset"])
        if not self.is_rigid:
            raise ConvergenceError(
                f"the load balance did not converge: {search['residual']:.3g} N of {load:.6g} N are left "
                f"(allowed {TOLERANCE * load:.1g} N) near an approach of {approach:.9g} mm."
            )
        where = f"the bearing area has no balance near an approach of {approach:.9g} mm"
        if search["phase"] != bearing.UP_TO_TIE:
            raise ConvergenceError(f"{where}.")
        below, tied = float(search["below"]), float(search["above"] - search["below"])
        needed = load / (self.springs.cap * self.springs.cell_area)
        raise ConvergenceError(
            f"{where}: {below:.0f} cells lie below it, {tied:.0f} are tied with it, and the load asks for "
            f"{needed:.3f}."
        )
