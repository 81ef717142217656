"""Stresses at a depth of a half-space under loads of its surface, by Fourier transforms.

z points into the body. A pressure p > 0 pushes along z, a traction (qx, qy) acts on the body, tension is
positive. Where nothing lies beside the cells each of them is a square of uniform load (Love 1929, Phil.
Trans. R. Soc. A 228, 377; for tractions by Cerruti's potentials: Johnson, Contact Mechanics, 1985, section
3.6). Where the surface repeats each wave of the load has its own stress; where it repeats along y alone all
images of a square count. None depends on Young's modulus.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.grid import FloatArray, blocks_of_rows

fft = lazy.module("scipy.fft")

#: The components of a stress, in the order of all arrays of them, and where x and y change places.
COMPONENTS = ("xx", "yy", "zz", "xy", "xz", "yz")
SWAPPED = (1, 0, 2, 3, 5, 4)
#: Images of a cell on either side that are added one by one where loads repeat along y alone, and a distance
#: from which more images change nothing [cells].
IMAGES, FAR = 8, 1.0e12
#: Numbers that a thread works on at once, which stay in its cache.
TOGETHER = 2**15


class Loads:
    """Holds the modes of the loads on a surface of nx × ny cells, for stresses at any depth.

    loads: by "p", "x" and "y" the pressure and the tractions along x and y, each of shape (nx, ny). cell:
    width of a cell, in the unit of the depths. boundary: "free", where nothing lies beside the cells,
    "periodic", where they repeat, or "line", where they repeat along y and end along x.
    """

    def __init__(
        self, loads: dict[str, FloatArray], cell: float, *, poisson: float, boundary: str, threads: int
    ) -> None:
        self._cell, self._poisson, self._boundary, self._threads = cell, poisson, boundary, threads
        self._shape = next(iter(loads.values())).shape
        is_padded = boundary != "periodic", boundary == "free"
        rows, columns = (
            2 * fft.next_fast_len(n) if pads else n for n, pads in zip(self._shape, is_padded, strict=True)
        )
        self._padded = rows, columns
        #: Modes of each load, and the same times −i, for stresses that are odd along one axis.
        self._modes: dict[str, tuple[Any, Any]] = {}
        for name, values in loads.items():
            lines = fft.rfft(values, columns, axis=1, workers=threads)
            modes = fft.fft(lines, rows, axis=0, workers=threads)
            self._modes[name] = modes, -1j * modes

    def at(self, depth: float) -> FloatArray:
        """Return the six components at a depth, shape (6, nx, ny), in the unit of the loads."""
        (rows, columns), (nx, ny) = self._padded, self._shape
        stress = np.empty((len(COMPONENTS), nx, ny))
        total = np.empty((rows, columns // 2 + 1), complex)
        distances = rows // 2 + 1, columns if self._boundary == "line" else columns // 2 + 1
        tables = {load: np.empty((len(COMPONENTS), *distances)) for load in self._modes}
        with ThreadPoolExecutor(self._threads) as pool:
            each = columns * (2 * IMAGES + 1 if self._boundary == "line" else 1)
            blocks = blocks_of_rows(distances[0], values=each, together=TOGETHER)
            list(pool.map(partial(self._fill, tables, depth / self._cell), blocks))
            blocks = blocks_of_rows(rows, values=columns, together=TOGETHER)
            for number, component in enumerate(COMPONENTS):
                terms = []
                for load, modes in self._modes.items():
                    is_odd = [(component + load).count(axis) % 2 == 1 for axis in "xy"]
                    table = self._transform(tables[load][number], is_odd)
                    terms.append((modes[is_odd[0] != is_odd[1]], table, is_odd[0]))
                list(pool.map(partial(_add_up, total, terms), blocks))
                lines = fft.ifft(total, axis=0, workers=self._threads)[:nx]
                stress[number] = fft.irfft(lines, columns, axis=1, workers=self._threads)[:, :ny]
        return stress

    def _fill(self, tables: dict[str, FloatArray], depth: float, block: slice) -> None:
        """Set rows of tables to what a unit of each load makes at a depth [cells], by distance or by wave."""
        for load, table in tables.items():
            if self._boundary == "periodic":
                x, y = (2.0 * np.pi / n * np.arange(n // 2 + 1) for n in self._padded)
                table[:, block] = _under(
                    load, (pressed_wave, sheared_wave), x[block], y, depth, self._poisson
                )
            else:
                table[:, block] = self._of_squares(load, depth, block)

    def _of_squares(self, load: str, depth: float, block: slice) -> FloatArray:
        """Return the stress under a square and its images, if any, by distance: a part of a table's rows."""
        x = np.arange(block.start, block.stop + 1) - 0.5
        period = self._padded[1]

        def strips(y: FloatArray) -> FloatArray:
            corners = _under(load, (pressed_corner, sheared_corner), x, y, depth, self._poisson)
            return np.diff(corners, axis=1)

        if self._boundary == "free":
            return np.diff(strips(np.arange(period // 2 + 2) - 0.5))
        first, start = IMAGES * period, np.arange(period)
        near = np.diff(strips(np.arange(-first, first + period + 1) - 0.5))
        images: FloatArray = near.reshape(*near.shape[:2], 2 * IMAGES + 1, period).sum(axis=2)
        # Further images: their loads spread out evenly, corrected by a derivative where they begin (Euler and
        # Maclaurin; a period of one cell is spread out already).
        ends, reach, half = strips(np.array([-FAR, FAR])), first + 0.5 * period, 0.5 * period
        part = (1.0 - 1.0 / period**2) / 6.0
        for begin, end, sign in ((start + reach, ends[..., 1:], 1.0), (start - reach, ends[..., :1], -1.0)):
            at = strips(begin)
            bend = strips(begin + half) - 2.0 * at + strips(begin - half)
            images += sign * (end - at + part * bend) / period
        return images

    def _transform(self, table: FloatArray, is_odd: list[bool]) -> FloatArray:
        """Return a table by wave number, of one by distance less −i for each axis along which it is odd."""
        for axis, odd in enumerate(is_odd):
            if axis == 1 and self._boundary == "line":
                modes = fft.rfft(table, axis=1, workers=self._threads)
                table = -modes.imag if odd else modes.real
            lines = np.moveaxis(table, axis, 0)
            inner = lines[1:-1] if odd else lines  # none of one row
            if inner.size and (self._boundary == "free" or (self._boundary == "line" and axis == 0)):
                inner[:] = (fft.dst if odd else fft.dct)(inner, type=1, axis=0, workers=self._threads)
            if odd:
                lines[0] = 0.0
                if self._padded[axis] % 2 == 0:
                    lines[-1] = 0.0
        return -table if all(is_odd) else table  # (−i)²


def _under(
    load: str,
    of: tuple[Callable[..., Any], Callable[..., Any]],
    x: FloatArray,
    y: FloatArray,
    *numbers: float,
) -> FloatArray:
    """Return stresses (6, x, y) by functions of what is pressed and of what is sheared along its x."""
    pressed, sheared = of
    x, y = np.broadcast_arrays(x[:, np.newaxis], y)
    if load == "y":
        stresses = sheared(y, x, *numbers)
        return np.stack([stresses[number] for number in SWAPPED])
    return np.stack((pressed if load == "p" else sheared)(x, y, *numbers))


def _add_up(total: Any, terms: list[tuple[Any, FloatArray, bool]], block: slice) -> None:
    """Set rows of a spectrum to the sum of modes times tables, whose further rows mirror the first half."""
    rows = np.arange(len(total))[block]
    mirrored = np.minimum(rows, len(total) - rows)
    total[block] = 0.0
    for modes, table, is_odd in terms:
        factors = table[mirrored]
        if is_odd:
            factors[rows > mirrored] *= -1.0
        total[block] += modes[block] * factors


def pressed_corner(x: FloatArray, y: FloatArray, z: float, poisson: float) -> list[FloatArray]:
    """Return the stress under a corner of unit pressure, less what depends on x or on y alone.

    A square's is the sum over its corners with signs in turn.
    """
    r, by_x, by_y = np.sqrt(x**2 + y**2 + z**2), x**2 + z**2, y**2 + z**2
    turn = np.arctan2(x * y * (x**2 + y**2) / (r + z), x**2 * r + z * y**2)
    whole = -np.arctan2(x * y, z * r)
    along, across = z * x * y / (r * by_x), z * x * y / (r * by_y)
    rest = 1.0 - 2.0 * poisson
    stresses = [
        2.0 * poisson * whole + along - rest * turn,
        2.0 * poisson * whole + across + rest * (whole + turn),
        whole - along - across,
        -rest * np.log(r + z) - z / r,
        z**2 * y / (r * by_x),
        z**2 * x / (r * by_y),
    ]
    return [values / (2.0 * np.pi) for values in stresses]


def sheared_corner(x: FloatArray, y: FloatArray, z: float, poisson: float) -> list[FloatArray]:
    """Return the stress under a corner of unit traction along x, as `pressed_corner`."""
    r, by_x = np.sqrt(x**2 + y**2 + z**2), x**2 + z**2
    log_y, log_x = np.arcsinh(y / np.sqrt(by_x)), np.arcsinh(x / np.sqrt(y**2 + z**2))
    whole = -np.arctan2(x * y, z * r)
    slope, bend = 2.0 * poisson / (r + z), z / (r * (r + z))
    normal = z**2 * y / (r * by_x)
    stresses = [
        2.0 * log_y + y * (slope + bend) - normal,
        2.0 * poisson * log_y - y * (slope + bend),
        normal,
        log_x - x * (slope + bend),
        whole + z * x * y / (r * by_x),
        -z / r,
    ]
    return [values / (2.0 * np.pi) for values in stresses]


def pressed_wave(x: FloatArray, y: FloatArray, z: float, poisson: float) -> list[FloatArray]:
    """Return the stress under a wave of pressure of unit height, of wave numbers x and y.

    Less −i for each axis along which it is odd. That under the mean is of a body held at its sides.
    """
    c, s, k = _directions(x, y)
    decay = np.exp(-k * z)
    along, across = (k * z - 1.0) * decay, -2.0 * poisson * decay
    stresses = [
        c**2 * along + s**2 * across,
        s**2 * along + c**2 * across,
        -(1.0 + k * z) * decay,
        c * s * (across - along),
        -c * k * z * decay,
        -s * k * z * decay,
    ]
    for values in stresses[:2]:
        values[k == 0.0] = -poisson / (1.0 - poisson)
    return stresses


def sheared_wave(x: FloatArray, y: FloatArray, z: float, poisson: float) -> list[FloatArray]:
    """Return the stress under a wave of traction along x of unit height, as `pressed_wave`."""
    c, s, k = _directions(x, y)
    decay = np.exp(-k * z)
    return [
        -c * ((2.0 - k * z) * c**2 + 2.0 * (1.0 + poisson) * s**2) * decay,
        -c * (2.0 * poisson * c**2 - k * z * s**2) * decay,
        -c * k * z * decay,
        -s * ((1.0 - k * z - 2.0 * poisson) * c**2 + s**2) * decay,
        (c**2 * k * z - 1.0) * decay,
        -c * s * k * z * decay,
    ]


def _directions(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the direction of waves along x and along y, zeros of the mean, and the size of wave numbers."""
    k = np.hypot(x, y)
    inverse = np.divide(1.0, k, out=np.zeros_like(k), where=k > 0.0)
    return x * inverse, y * inverse, k
