"""Write worn bodies as closed solids of triangles: binary .stl, in mm."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from warpwear.grid import FloatArray
from warpwear.results.formats.bodies import ExportedBody

#: Thickness of a solid at its thinnest, over its shorter side.
THICKNESS = 0.1
#: A triangle in the file: its normal, its corners [mm], and two bytes that mean nothing.
FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("unused", "<u2")])

Triangles = NDArray[np.int64]


def write_stl(path: Path, body: ExportedBody) -> None:
    """Write a body in its place as a closed solid: its worn surface, a flat back, and walls between them.

    The disc's back lies below it, the ball's above. Where a corner of four points is missing there is no
    solid.
    """
    z = body.z
    quads = np.isfinite(z)
    quads = quads[:-1, :-1] & quads[1:, :-1] & quads[1:, 1:] & quads[:-1, 1:]
    thickness = THICKNESS * float(min(np.ptp(body.x), np.ptp(body.y)))
    back = np.nanmin(z) - thickness if body.upwards else np.nanmax(z) + thickness
    triangles = _closed(quads)
    if not body.upwards:  # its outside is the other way round
        triangles = triangles[:, ::-1]
    points = _points(body, z, float(back))
    facets = np.zeros(len(triangles), dtype=FACET)
    facets["corners"] = points[triangles]
    first, second, third = (facets["corners"][:, i].astype(np.float64) for i in range(3))
    normals = np.cross(second - first, third - first)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    facets["normal"] = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0.0)
    about = f"warpwear: worn {body.name}, unit mm"
    with path.open("wb") as file:
        file.write(about.encode("ascii").ljust(80, b" ")[:80])
        file.write(np.uint32(len(facets)).astype("<u4").tobytes())
        file.write(facets.view(np.uint8).data)  # tofile does not name a full disk


def _points(body: ExportedBody, z: FloatArray, back: float) -> FloatArray:
    """Return points of the worn surface by row, and after them those of the back [mm], (2 nx ny, 3)."""
    x, y = np.meshgrid(body.x, body.y, indexing="ij")
    sides = [np.column_stack([x.ravel(), y.ravel(), side.ravel()]) for side in (z, np.full_like(z, back))]
    return np.concatenate(sides)


def _closed(quads: NDArray[np.bool_]) -> Triangles:
    """Return the triangles of a solid below a surface, corners counted from outside against the clock.

    quads: where four neighbouring points make a piece of the surface, shape (nx − 1, ny − 1).
    """
    nx, ny = quads.shape[0] + 1, quads.shape[1] + 1
    number = np.arange(nx * ny).reshape(nx, ny)
    a, b, c, d = (v[quads] for v in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
    top = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    below = nx * ny
    empty = np.pad(~quads, 1, constant_values=True)
    open_sides = (empty[1:-1, :-2], empty[2:, 1:-1], empty[1:-1, 2:], empty[:-2, 1:-1])
    walls = []
    for (start, end), open_side in zip(((a, b), (b, c), (c, d), (d, a)), open_sides, strict=True):
        u, v = start[open_side[quads]], end[open_side[quads]]
        walls += [np.column_stack([v, u, u + below]), np.column_stack([v, u + below, v + below])]
    return np.concatenate([top, top[:, ::-1] + below, *walls])
