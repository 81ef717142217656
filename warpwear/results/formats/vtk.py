"""Write snapshots for ParaView: images of the fields, surfaces of the bodies, and films, as VTK's XML."""

import base64
import struct
import zlib
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.errors import escaped
from warpwear.grid import FloatArray
from warpwear.history.quantities import UNITS
from warpwear.results.formats.bodies import WRITABLE, Files, Job
from warpwear.results.formats.forms import filled
from warpwear.version import __version__

stresses = lazy.module("warpwear.history.stresses")

#: Bytes that are packed together.
BLOCK = 2**20
#: How densely: the lowest level takes a third of the time of the usual one for files a tenth larger.
LEVEL = 1
#: Names of NumPy's types in VTK.
TYPES = {"f4": "Float32", "f8": "Float64", "u1": "UInt8"}
#: Value of vtkGhostType for a point that is not shown.
HIDDEN = 2
#: What a body's surface does not show, by the end of a field's name: the other body, and what lies between.
OTHERS = {"counter": ("_disc", "gap"), "disc": ("_counter", "gap"), "track": ("_counter", "gap")}


def vti_files(job: Job) -> Files:
    """Name an image of the fields and a surface of each body for every snapshot, and a film of each."""
    writers = dict.fromkeys(job.sheets, ("vti", _write_image))
    writers |= dict.fromkeys(job.bodies, ("vts", _write_surface))
    if job.result.study.has_stresses:
        writers["stresses"] = ("vtr", _write_stresses)
    films: dict[str, dict[int, str]] = {name: {} for name in writers}
    for number in job.numbers:
        for name, (ending, write) in writers.items():
            films[name][number] = f"{name}_{number:04d}.{ending}"
            yield films[name][number], partial(write, job, name, number)
    for name, film in films.items():
        yield f"{name}.pvd", partial(_write_film, job, film)


def _write_film(job: Job, film: dict[int, str], path: Path) -> None:
    """Write the list of a film's files: its time is the sliding distance [mm]."""
    distances = job.result.snapshot_distances
    files = [(float(distances[number]), file) for number, file in film.items()]
    path.write_text(filled("pvd.xml", files=files), encoding="utf-8", errors="backslashreplace", newline="\n")


def _write_image(job: Job, name: str, number: int, path: Path) -> None:
    """Write fields as an image whose points are the middles of the cells [mm]."""
    sheet = job.sheet(name, number)
    shift = 0.0 if name == "track_fields" else job.along(number)
    spacing = [float(np.ptp(side)) / max(side.size - 1, 1) or 1.0 for side in (sheet.x, sheet.y)]
    image = {
        "Origin": _numbers(sheet.x[0] + shift, sheet.y[0], 0.0),
        "Spacing": _numbers(*spacing, min(spacing)),
    }
    about = _about(job, sheet.distance, (sheet.x.size, sheet.y.size))
    _write(path, {"PointData": _labelled(sheet.fields)}, kind="ImageData", attributes=image, **about)


def _write_surface(job: Job, name: str, number: int, path: Path) -> None:
    """Write a body as a surface in space [mm], with its fields; points that it lacks are hidden.

    Places in space are float32, which are to be seen, and heights as they were computed.
    """
    body, snapshot = job.body(name, number), job.snapshot(number)
    sheet = job.sheet("track_fields" if name == "track" else "fields", number)
    fields = {key: v for key, v in sheet.fields.items() if not key.endswith(OTHERS[name])}
    data: dict[str, Any] = _labelled({f"height_{name}": body.heights} | fields)
    there = np.isfinite(body.heights)
    if not there.all():
        data["vtkGhostType"] = np.where(there, 0, HIDDEN).astype(np.uint8)
    z = np.where(there, body.z, np.nanmin(body.z) if there.any() else 0.0)
    shift = 0.0 if name == "track" else job.along(number)
    x, y = np.meshgrid(body.x + shift, body.y, indexing="ij")
    groups = {"PointData": data, "Points": {"points [mm]": np.stack([x, y, z], axis=-1).astype(np.float32)}}
    _write(path, groups, kind="StructuredGrid", attributes={}, **_about(job, snapshot.distance, x.shape))


def _write_stresses(job: Job, name: str, number: int, path: Path) -> None:
    """Write the stresses below the disc [MPa] as a volume, for surfaces of equal stress; z is up [mm]."""
    result, snapshot = job.result, job.snapshot(number)
    below = stresses.volume(result.study, snapshot, result.history)
    fields = {"mises": below.mises, "max_shear": below.shear, "principal": below.principal}
    count, nx, ny = below.mises.shape
    axes = {"x": result.x + job.along(number), "y": result.y, "z": -below.depths[::-1]}
    data = {
        f"{key} [{UNITS[key]}]": of[::-1].swapaxes(0, 1).reshape(nx, count * ny) for key, of in fields.items()
    }
    places = {f"{axis} [mm]": values[:, np.newaxis] for axis, values in axes.items()}
    about = _about(job, snapshot.distance, (nx, ny)) | {"extent": f"0 {nx - 1} 0 {ny - 1} 0 {count - 1}"}
    _write(path, {"PointData": data, "Coordinates": places}, kind="RectilinearGrid", attributes={}, **about)


def _numbers(*values: float) -> str:
    return " ".join(repr(float(value)) for value in values)


def _about(job: Job, distance: float, shape: tuple[int, ...]) -> dict[str, Any]:
    """Return what a file of a grid (nx, ny) says of itself: a distance [mm] is the time of a film."""
    source = f"warpwear {job.result.attributes['version']}, written by {__version__}"
    texts = {"study": job.result.study.study.name, "source": source}
    extent = f"0 {shape[0] - 1} 0 {shape[1] - 1} 0 0"
    return {"distance": float(distance), "texts": texts, "extent": extent}


def _write(path: Path, groups: Mapping[str, Mapping[str, Any]], **about: Any) -> None:
    """Write a file whose arrays stand packed at its end in base64. about: what its form takes besides.

    groups: group -> name -> array of shape (nx, ny) or (nx, ny, components); x is the fastest in the file.
    """
    appended: list[bytes] = []
    described: dict[str, list[dict[str, Any]]] = {group: [] for group in groups}
    for group, name, values in ((group, *one) for group, of in groups.items() for one in of.items()):
        entry = {"name": name, "type": TYPES[values.dtype.str[1:]], "offset": sum(map(len, appended))}
        described[group].append(entry | {"components": values.shape[2] if values.ndim == 3 else 1})
        appended.append(_packed(np.ascontiguousarray(values.swapaxes(0, 1))))
    before, _, after = filled("vtk.xml", groups=described, **about).rpartition("\n")
    with path.open("wb") as file:
        file.writelines([escaped(before).encode(), *appended, b"\n", escaped(after).encode()])


def _labelled(fields: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    """Put the unit of each field into its name."""
    return {f"{name} [{WRITABLE[name].units}]": values for name, values in fields.items()}


def _packed(values: "np.ndarray[Any, Any]") -> bytes:
    """Pack an array as VTK does: number, size, last size and packed sizes of blocks, and these, in base64."""
    content = values.astype(values.dtype.newbyteorder("<"), copy=False).tobytes()
    blocks = [zlib.compress(content[at : at + BLOCK], LEVEL) for at in range(0, len(content), BLOCK)]
    sizes = (len(blocks), BLOCK, len(content) % BLOCK, *map(len, blocks))
    return base64.b64encode(struct.pack(f"<{len(sizes)}Q", *sizes)) + base64.b64encode(b"".join(blocks))
