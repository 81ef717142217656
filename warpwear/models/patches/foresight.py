"""Where the approaches of the next step of patches will be: the bodies' as of one, and the springs behind."""

from typing import ClassVar

from warpwear.contact.foresight import Foresight
from warpwear.grid import FloatArray
from warpwear.models.patches.shares import Shares


class PatchForesight:
    """Continues the rate of the common approach, and of every spring's deflection the last one."""

    STATE: ClassVar = {"_common": Foresight, "_giving": FloatArray}

    def __init__(self) -> None:
        self._common = Foresight()
        #: How fast each spring gave way, over what a unit of pressure removes [MPa].
        self._giving: FloatArray | None = None

    def note(self, shares: Shares, last: Shares | None, removal: float, *, sprung: bool) -> None:
        """Learn from a step that ended with shares, after the last one; removal: its K ΔL [mm³/N]."""
        self._giving = None
        if sprung and last is not None and removal > 0.0:
            deflection, before = (s.approach - s.bases for s in (shares, last))
            self._giving = (deflection - before) / removal
        self._common.note(shares.approach, removal)

    def expected(self, removal: float) -> tuple[float | None, FloatArray | None]:
        """Tell how far a step of K ΔL = removal [mm³/N] goes on [mm]: the bodies, each patch from its base.

        None before it can be told, and of patches where they go with the bodies.
        """
        step = self._common.expected(removal)
        if step is None or self._giving is None:
            return step, None
        return step, step - removal * self._giving
