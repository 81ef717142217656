"""Write snapshots for ParaView: images of the fields, surfaces of the bodies, and films, as VTK's XML."""

import base64
import struct
import zlib
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from warpwear.grid import FloatArray
from warpwear.results.formats.bodies import WRITABLE, Files, Job
from warpwear.version import __version__

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
    root = _root("Collection")
    collection = ElementTree.SubElement(root, "Collection")
    for number, file in film.items():
        entry = {"timestep": repr(float(distances[number])), "group": "", "part": "0", "file": file}
        ElementTree.SubElement(collection, "DataSet", entry)
    ElementTree.ElementTree(root).write(path, encoding="UTF-8", xml_declaration=True)


def _write_image(job: Job, name: str, number: int, path: Path) -> None:
    """Write fields as an image whose points are the middles of the cells [mm]."""
    sheet = job.sheet(name, number)
    shift = 0.0 if name == "track_fields" else job.along(number)
    spacing = [float(np.ptp(side)) / max(side.size - 1, 1) or 1.0 for side in (sheet.x, sheet.y)]
    image = {
        "Origin": _numbers(sheet.x[0] + shift, sheet.y[0], 0.0),
        "Spacing": _numbers(*spacing, min(spacing)),
    }
    file = _File("ImageData", (sheet.x.size, sheet.y.size), image)
    file.say(job, sheet.distance)
    file.point_data(sheet.fields)
    file.write(path)


def _write_surface(job: Job, name: str, number: int, path: Path) -> None:
    """Write a body as a surface in space [mm], with its fields; points that it lacks are hidden.

    Places in space are float32, which are to be seen, and heights as they were computed.
    """
    body, snapshot = job.body(name, number), job.snapshot(number)
    sheet = job.sheet("track_fields" if name == "track" else "fields", number)
    fields = {key: v for key, v in sheet.fields.items() if not key.endswith(OTHERS[name])}
    there = np.isfinite(body.heights)
    z = job.exaggeration * body.z
    z = np.where(there, z, np.nanmin(z) if there.any() else 0.0)
    shift = 0.0 if name == "track" else job.along(number)
    x, y = np.meshgrid(body.x + shift, body.y, indexing="ij")
    file = _File("StructuredGrid", body.heights.shape, {})
    file.say(job, snapshot.distance)
    file.point_data({f"height_{name}": body.heights} | fields, hidden=None if there.all() else ~there)
    points = ElementTree.SubElement(file.piece, "Points")
    file.array(points, "points [mm]", np.stack([x, y, z], axis=-1).astype(np.float32))
    file.write(path)


def _root(kind: str) -> ElementTree.Element:
    about = {"type": kind, "version": "1.0", "byte_order": "LittleEndian", "header_type": "UInt64"}
    return ElementTree.Element("VTKFile", about | {"compressor": "vtkZLibDataCompressor"})


def _numbers(*values: float) -> str:
    return " ".join(repr(float(value)) for value in values)


class _File:
    """One of VTK's XML files of a grid of points (nx, ny), whose arrays stand packed at its end in base64."""

    def __init__(self, kind: str, shape: tuple[int, ...], attributes: dict[str, str]) -> None:
        extent = f"0 {shape[0] - 1} 0 {shape[1] - 1} 0 0"
        self._root = _root(kind)
        self._grid = ElementTree.SubElement(self._root, kind, {"WholeExtent": extent} | attributes)
        self._appended: list[bytes] = []
        self._size = 0
        self._about = ElementTree.SubElement(self._grid, "FieldData")
        self.piece = ElementTree.SubElement(self._grid, "Piece", {"Extent": extent})

    def say(self, job: Job, distance: float) -> None:
        """Note the sliding distance [mm], which is the time of a film, and what made the file."""
        time = {"type": "Float64", "Name": "TimeValue", "NumberOfTuples": "1", "format": "ascii"}
        ElementTree.SubElement(self._about, "DataArray", time).text = repr(float(distance))
        version = job.result.attributes["version"]
        texts = {
            "study": job.result.study.study.name,
            "source": f"warpwear {version}, written by {__version__}",
        }
        for name, text in texts.items():  # as VTK has texts: codes of bytes, ended by a zero
            about = {"type": "String", "Name": name, "NumberOfTuples": "1", "format": "ascii"}
            codes = " ".join(map(str, (*text.encode(), 0)))
            ElementTree.SubElement(self._about, "Array", about).text = codes

    def point_data(self, fields: Mapping[str, FloatArray], *, hidden: Any = None) -> None:
        """Add fields with a value a point, each with its unit in its name. hidden: points not to be shown."""
        data = ElementTree.SubElement(self.piece, "PointData", {"Scalars": _label(next(iter(fields), ""))})
        for name, values in fields.items():
            self.array(data, _label(name), values)
        if hidden is not None:
            self.array(data, "vtkGhostType", np.where(hidden, HIDDEN, 0).astype(np.uint8))

    def array(self, parent: ElementTree.Element, name: str, values: Any) -> None:
        """Add an array of shape (nx, ny) or (nx, ny, components); x is the fastest in the file."""
        about = {"type": TYPES[values.dtype.str[1:]], "Name": name, "format": "appended"}
        about["offset"] = str(self._size)
        if values.ndim == 3:
            about["NumberOfComponents"] = str(values.shape[2])
        ElementTree.SubElement(parent, "DataArray", about)
        self._appended.append(_packed(np.ascontiguousarray(values.swapaxes(0, 1))))
        self._size += len(self._appended[-1])

    def write(self, path: Path) -> None:
        """Write the file."""
        appended = ElementTree.SubElement(self._root, "AppendedData", {"encoding": "base64"})
        appended.text = "_\n"
        before, _, after = ElementTree.tostring(
            self._root, encoding="UTF-8", xml_declaration=True
        ).rpartition(b"\n")
        with path.open("wb") as file:
            file.write(before)
            file.writelines(self._appended)
            file.write(b"\n" + after)


def _label(name: str) -> str:
    return f"{name} [{WRITABLE[name].units}]" if name else ""


def _packed(values: "np.ndarray[Any, Any]") -> bytes:
    """Pack an array as VTK does: number, size, last size and packed sizes of blocks, and these, in base64."""
    content = values.astype(values.dtype.newbyteorder("<"), copy=False).tobytes()
    blocks = [zlib.compress(content[at : at + BLOCK], LEVEL) for at in range(0, len(content), BLOCK)]
    sizes = (len(blocks), BLOCK, len(content) % BLOCK, *map(len, blocks))
    return base64.b64encode(struct.pack(f"<{len(sizes)}Q", *sizes)) + base64.b64encode(b"".join(blocks))
