"""What every surface can do: give its heights at any points, say what it is, warn about a sampling."""

from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from warpwear.errors import InputError, sentences
from warpwear.grid import FloatArray

BoolArray = npt.NDArray[np.bool_]
IntArray = npt.NDArray[np.int64]
say = sentences("measurements")


def refused(why: str, /, **values: Any) -> InputError:
    """Return the error of a measurement that cannot be used, as `say` gives its sentence."""
    return InputError(say(why, **values))


class Surface(Protocol):
    """A surface is a function of place: the same one at any cell size and in any window.

    Implementations are frozen dataclasses: nothing is regenerated for a mesh, nothing remembered of one.
    """

    def heights(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return heights [mm] over the mean plane, positive out of the material, shape (x.size, y.size).

        x (along the sliding direction) and y are the points of the grid x × y [mm]: 1-D, uniform, increasing,
        0 = the middle of the contact.
        """

    def notices(self, x: FloatArray, y: FloatArray) -> list[str]:
        """Say what a user must know about this surface on the grid x × y [mm], such as repeats or filters."""

    def record(self) -> dict[str, Any]:
        """Say what the surface is and what was done to it, JSON-ready, units in the key names (``sq_um``).

        ``kind`` is always there. What depends on the points asked for is said by `notices` instead.
        """


def spacing(points: FloatArray) -> float:
    """Return the mean distance [mm] of uniform, increasing points [mm], shape (n,); 0 for a single point."""
    return float(points[-1] - points[0]) / (points.size - 1) if points.size > 1 else 0.0
