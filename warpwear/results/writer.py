"""Writes a result: one HDF5 file a run, snapshot by snapshot, its history at the end.

Room is made sure of before anything is written: the HDF5 library does not survive a full disk.
"""

import errno
import json
import os
import shutil
import tempfile
import zlib
from collections.abc import Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np
import psutil

from warpwear.grid import FloatArray
from warpwear.history import quantities
from warpwear.history.pieces import PieceBook
from warpwear.history.snapshot import EXACT, Snapshot
from warpwear.results.file import PATCH
from warpwear.study.study import Study
from warpwear.version import __version__

if TYPE_CHECKING:
    from warpwear.history.recorder_patches import PatchBook

#: Room for attributes, tables and the log beside what is counted [B].
SPACE_FOR_THE_REST = 2 * 2**20
#: Cells along a side of a compressed block.
CHUNK = 256
#: Level of deflate.
LEVEL = 1
#: How a stream of zlib begins (RFC 1950).
ZLIB = b"\x78\x01"
#: Bytes that repeat the one before, of all, below which those of one place of the words are stored as noise.
REPEATS = 0.2
#: Bytes from one that is looked at to the next.
SAMPLED = 16
#: Part of the memory that is free which a snapshot may take to be kept.
AT_HAND = 0.1
#: Errors of a file system that cannot set room aside.
NO_PREALLOCATION = (errno.EOPNOTSUPP, errno.ENOSYS, errno.EINVAL, errno.EPERM)


class ResultWriter:
    """Writes a run into an open HDF5 file. Raises OSError before it writes what the disk may not hold.

    toml: the study's text. snapshots: whether to keep any.
    """

    def __init__(
        self, file: h5py.File, study: Study, toml: str, *, device: str, threads: int, snapshots: bool = True
    ) -> None:
        self._file, self._study, self._keeps_snapshots = file, study, snapshots
        self._in_memory = file.driver == "core"  # where nobody but this process reads
        self._pool = ThreadPoolExecutor(threads) if threads > 1 and not self._in_memory else None
        self._waiting: list[tuple[h5py.Dataset, tuple[int, ...], Future[bytes | None]]] = []
        #: Number -> snapshot, of those whose files need not be read back.
        self.at_hand: dict[int, Snapshot] = {}
        self._require_space(0)
        about = {"version": __version__, "study": toml, "device": device, "threads": threads}
        file.attrs.update(about | {"precision": "float64", "finished": False})
        self._add_axis("grid/x", study.cells.x)
        self._add_axis("grid/y", study.cells.y)
        file.create_group("snapshots")

    def add_snapshot(self, snapshot: Snapshot) -> None:
        """Keep the fields of one distance; threads compress them while steps go on, and `flush` waits.

        A run in memory keeps them as they are, at hand, where there is plenty of it.
        """
        if not self._keeps_snapshots:
            return
        single = self._study.output.precision == "single"
        if single:
            snapshot = snapshot.rounded()
        size = sum(values.nbytes for values in snapshot.fields.values())
        self._require_space(size)
        snapshots = self._file["snapshots"]
        plenty = size < AT_HAND * psutil.virtual_memory().available
        if plenty:
            snapshot = self.at_hand[len(snapshots)] = snapshot if single else snapshot.lasting()
        group = snapshots.create_group(f"{len(snapshots):04d}")
        for name in ("distance", "row", "load_on_filled"):
            if (value := getattr(snapshot, name)) is not None:
                group.attrs[name] = value
        if self._in_memory and plenty:
            return
        for name, values in snapshot.fields.items():
            chunks = tuple(min(CHUNK, n) for n in values.shape)
            how = {"compression": "gzip", "compression_opts": LEVEL, "shuffle": True}
            dtype = np.float32 if single and name not in EXACT else values.dtype
            dataset = group.create_dataset(name, values.shape, dtype, chunks=chunks, **how)
            dataset.attrs.update(
                units=quantities.FIELDS[name].units, long_name=quantities.FIELDS[name].meaning
            )
            for place in dataset.iter_chunks():
                part, start = values[place].astype(dtype, copy=False), tuple(along.start for along in place)
                if self._pool is not None and plenty:
                    self._waiting.append((dataset, start, self._pool.submit(_compressed, part, chunks)))
                elif (block := _compressed(part, chunks)) is not None:
                    dataset.id.write_direct_chunk(start, block)

    def flush(self) -> None:
        """Write what was compressed meanwhile, and wait for the rest."""
        blocks = [(dataset, start, packed.result()) for dataset, start, packed in self._waiting]
        self._waiting.clear()
        if blocks:
            self._require_space(sum(len(block) for *_, block in blocks if block))
        for dataset, start, block in blocks:
            if block is not None:
                dataset.id.write_direct_chunk(start, block)

    def add_track(self, x: FloatArray, heights: FloatArray) -> None:
        """Keep the disc of a swept run: places of its rows [mm], heights before any wear [mm]."""
        self._require_space(heights.nbytes)
        group = self._file.create_group("track")
        group["x"] = self._add_axis("grid/track_x", x)
        # As it is: roughness gains a tenth by compression, at many times the time.
        dataset = group.create_dataset("heights", data=heights)
        dataset.attrs["units"] = "mm"
        _label(dataset, self._file["grid"], "track_x", "y")

    def add_counter(self, heights: FloatArray) -> None:
        """Keep a measured counter-body's form on the domain's cells [mm], before any wear."""
        self._require_space(heights.nbytes)
        self._file.create_dataset("counter/heights", data=heights).attrs["units"] = "mm"

    def add_stresses(self, tables: Mapping[str, FloatArray]) -> None:
        """Keep what the stresses below the surface come to, a dataset a quantity, snapshots first."""
        self._require_space(sum(values.nbytes for values in tables.values()))
        group = self._file.create_group("stresses")
        for name, values in tables.items():
            self._add(group, quantities.BY_NAME[name], values)

    @property
    def copied_bytes(self) -> int:
        """Return the size of what `copy_to` copies [B]."""
        self.flush()
        groups = [*self._file["snapshots"].values(), self._file.get("track", {})]
        return sum(dataset.id.get_storage_size() for group in groups for dataset in group.values())

    def copy_to(self, file: h5py.File) -> None:
        """Keep the snapshots so far, and the heights of a track, in another file, compressed as they are."""
        self.flush()
        self._file.copy("snapshots", file)
        if "track" in self._file:
            self._file.copy("track/heights", file, "heights", without_attrs=True)

    def take_snapshots_from(self, file: h5py.File) -> None:
        """Begin with the snapshots of another file."""
        self._require_space(Path(file.filename).stat().st_size)
        del self._file["snapshots"]
        file.copy("snapshots", self._file)

    def finish(
        self,
        history: Mapping[str, FloatArray],
        record: Mapping[str, Any],
        *,
        finished: bool,
        book: "PatchBook | None" = None,
        pieces: PieceBook | None = None,
    ) -> None:
        """Keep the history and what else the run recorded, and mark it as finished or interrupted.

        book: of what each patch did, in a run that has patches. pieces: those that bodies have worn in.
        """
        self._require_space(sum(values.nbytes for values in history.values()))
        group = self._file.create_group("history")
        for column in quantities.columns_of(self._study):
            self._add(group, column, history[column.name])
        if book is not None:
            self._add_patches(book)
        if pieces is not None:
            self._add_pieces(pieces)
        if not self._in_memory:
            self._label_all()
        self._file.attrs["record"] = json.dumps(record)
        self._file.attrs["finished"] = finished
        self._file.flush()

    def _label_all(self) -> None:
        """Say of every dataset what its axes are, for other programs."""
        group = self._file["history"]
        group["distance"].make_scale("distance")
        for name in group.keys() - {"distance", PATCH}:
            _label(group[name], group, "distance", *([PATCH] if group[name].ndim > 1 else []))
        track = "track" in self._file
        for snapshot in self._file["snapshots"].values():  # only now: checkpoints hold them without labels
            for name in snapshot.keys() & quantities.FIELDS.keys():
                along = "track_x" if track and quantities.FIELDS[name].frame == "disc" else "x"
                _label(snapshot[name], self._file["grid"], along, "y")

    def _add_patches(self, book: "PatchBook") -> None:
        """Keep what each patch did, and where the macro cells lie."""
        self._add_axis(f"history/{PATCH}", np.arange(book.patches.count), units="1")
        history = self._file["history"]
        for quantity in quantities.PATCH_TABLES:
            table = book.table(quantity.name)
            self._require_space(table.nbytes)
            self._add(history, quantity, table)
        for name, centres in zip(("x", "y"), book.patches.centres, strict=True):
            self._file.create_dataset(f"macro/{name}", data=centres).attrs["units"] = "mm"

    def _add(self, group: h5py.Group, quantity: quantities.Quantity, values: FloatArray) -> None:
        """Keep a quantity, compressed in a file, with its unit and meaning, by which xarray plots."""
        how: dict[str, Any] = {"chunks": True, "compression": "gzip", "shuffle": True}
        dataset = group.create_dataset(quantity.name, data=values, **({} if self._in_memory else how))
        dataset.attrs.update(units=quantity.units, long_name=quantity.meaning)

    def _add_pieces(self, pieces: PieceBook) -> None:
        """Keep a table of the pieces, a dataset a column."""
        table, grid = pieces.table, self._study.cells
        self._require_space(table.nbytes)
        step, body, row, column, volume, diameter = table.T
        x = grid.x[np.where(body == 0.0, row, 0.0).astype(int)]
        of_disc = self._study.track.x if self._study.is_swept else grid.x
        x = np.where(body == 0.0, x, of_disc[np.where(body == 1.0, row, 0.0).astype(int)])
        values = step, body, x, grid.y[column.astype(int)], volume, diameter
        group = self._file.create_group("pieces")
        for quantity, column_values in zip(quantities.OF_PIECES.values(), values, strict=True):
            self._add(group, quantity, column_values)

    def _add_axis(self, path: str, values: "np.ndarray[Any, Any]", *, units: str = "mm") -> h5py.Dataset:
        """Make the scale of an axis, which is named by the last part of its path."""
        axis = self._file.create_dataset(path, data=values)
        axis.attrs["units"] = units
        axis.make_scale(path.rpartition("/")[2])
        return axis

    def _require_space(self, nbytes: int) -> None:
        """Raise OSError unless the file can grow by what is to be written, before compression [B]."""
        if not self._in_memory:
            path = Path(self._file.filename)
            require_free_space(path.parent, nbytes + SPACE_FOR_THE_REST, offset=path.stat().st_size)


def _compressed(values: FloatArray, chunk: tuple[int, ...]) -> bytes | None:
    """Shuffle and deflate a block as HDF5's filters do, filled up to its size; None where all is zero.

    What is not written reads as zero. Shuffled heights hold runs of equal bytes and nothing else that deflate
    finds: Z_RLE looks for these alone, at half the time. Last digits are noise, which is stored.
    """
    block = values
    if values.shape != chunk:
        block = np.zeros(chunk, values.dtype)
        block[tuple(slice(n) for n in values.shape)] = values
    words = np.ascontiguousarray(block).view(f"u{block.itemsize}")
    if not words.any():
        return None
    planes = np.ascontiguousarray(words.view(np.uint8).reshape(-1, words.itemsize).T)
    repeats = planes[:, 1::SAMPLED] == planes[:, :-1:SAMPLED]
    noise = int((np.count_nonzero(repeats, axis=1) > REPEATS * repeats.shape[1]).argmax())
    stored = zlib.compressobj(0, wbits=-zlib.MAX_WBITS)
    deflated = zlib.compressobj(LEVEL, wbits=-zlib.MAX_WBITS, strategy=zlib.Z_RLE)
    parts = [ZLIB]
    if noise:
        parts += stored.compress(planes[:noise].data), stored.flush(zlib.Z_FULL_FLUSH)
    parts += deflated.compress(planes[noise:].data), deflated.flush()
    return b"".join((*parts, zlib.adler32(planes.data).to_bytes(4, "big")))


def _label(dataset: h5py.Dataset, scales: h5py.Group, *names: str) -> None:
    """Say which scales of a group the axes of a dataset have; the dataset's group gets hard links to them.

    A scale elsewhere does not open in xarray. Written by hand, without the list that each scale would keep of
    its datasets: the HDF5 library copies it whenever it grows, and fails at 4000 of them.
    """
    references = np.empty(len(names), dtype=object)
    for place, name in enumerate(names):
        if name not in dataset.parent:
            dataset.parent[name] = scales[name]
        references[place] = np.array([scales[name].ref], dtype=h5py.ref_dtype)
    dataset.attrs.create("DIMENSION_LIST", references, dtype=h5py.vlen_dtype(h5py.ref_dtype))


def require_free_space(folder: Path, nbytes: int, *, offset: int = 0) -> None:
    """Raise OSError unless a file in the folder can grow by `nbytes` beyond an offset [B].

    Where the system can, the room is set aside for a moment: a quota and a limit to the size of a file show
    only then.
    """
    free = shutil.disk_usage(folder).free
    if free < nbytes:
        raise OSError(errno.ENOSPC, f"{nbytes / 2**20:.0f} MiB are needed, {free / 2**20:.0f} MiB are free")
    if not hasattr(os, "posix_fallocate"):
        return
    with tempfile.TemporaryFile(dir=folder) as file:
        try:
            os.posix_fallocate(file.fileno(), offset, nbytes)
        except OSError as error:
            if error.errno in NO_PREALLOCATION:
                return
            why = os.strerror(error.errno or errno.ENOSPC)
            raise OSError(error.errno, f"{(offset + nbytes) / 2**20:.0f} MiB are needed: {why}") from error
