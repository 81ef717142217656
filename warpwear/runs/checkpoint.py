"""Checkpoints: one HDF5 file in the run folder, from which a run goes on as if it had never stopped.

The file is sealed (see `seal`) with the mark "warpwear checkpoint FORMAT". Then:

- /model/NAME        arrays of the model (fields, lists of tiles)
- /heights           of the disc before any wear [mm]
- /rows              the history so far, (steps, columns), names in the attribute `columns`
- /snapshots         as in result.h5
- /about             JSON: version, study, device, surface, warnings, elapsed time, the model's numbers, and
                     `kinds`: types of these, types and shapes of its arrays

It is written under another name, flushed to the disk and moved into place: a good one is always there.
"""

import json
import os
import time
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from warpwear.errors import OVERWRITE_IT, RESUME_IT, InputError, sentences
from warpwear.grid import FloatArray
from warpwear.history.rows import Rows
from warpwear.laws.form import Given
from warpwear.laws.passes import Block
from warpwear.results.check import check_snapshots
from warpwear.results.ensemble import NO_MATTER
from warpwear.results.seal import HEADER, digest_of, has_mark, read_header, seal
from warpwear.results.writer import SPACE_FOR_THE_REST, ResultWriter, require_free_space
from warpwear.runs.order import RunOrder
from warpwear.study.keys import dotted
from warpwear.study.study import Study
from warpwear.version import __version__

say = sentences("runs")
FILE_NAME = "checkpoint.h5"
#: Number of the content's layout. A file of another one is refused.
FORMAT = 15
MAGIC = "warpwear checkpoint"
#: Heights that differ by no more are of the same surface, made on another kind of processor [mm].
SAME_HEIGHTS = 1.0e-12
#: Fields of a `Checkpoint` beside its arrays and rows.
OF_THE_RUN = ("numbers", "warnings", "reported_violations", "elapsed")
#: Sections and keys that no result depends on.
LABELS = (*(f"study.{key}" for key in NO_MATTER["study"] or ()), "run", "checks", "assumed")
#: Sections and keys that no step depends on: a run may go on with others.
FREE = (*LABELS, "friction", "junctions")
#: Keys of these that steps do depend on, and one more where there are some of these: by them caps of cells
#: change, or shear is booked. By the energy law wear depends on all of friction.
OF_CAPS = ("friction.film", "friction.junction_growth", "friction.largest_coefficient")
OF_SHEAR, SHEARED = "friction.shear_strength", (*OF_CAPS[1:], "counter.layers", "disc.layers")


@dataclass(frozen=True)
class Checkpoint:
    """All that a run needs to go on from one of its steps."""

    arrays: dict[str, Any]  # of the model, by name
    numbers: dict[str, Any]  # of the model, by name, as JSON keeps them
    rows: Rows  # of the history
    warnings: list[str]
    reported_violations: list[str]  # names of the invariants whose violation is among the warnings
    elapsed: float  # [s]


class Checkpoints:
    """Writes the checkpoints of one run.

    path: of the file; work: a folder of the same disk; heights: of the disc [mm], stored but for those of a
    track, which the result holds.
    """

    def __init__(self, path: Path, work: Path, order: RunOrder, heights: FloatArray, *, device: str) -> None:
        self.path = path
        self._heights = None if order.study.is_swept else heights
        self._new = work / FILE_NAME
        self._about = {
            "version": __version__,
            "study": order.toml,
            "device": device,
            "surface": checksum(heights),
            "counter": _of_counter(order),
            "files": order.files,
        }
        self._every = order.study.run.checkpoint
        self._last = time.monotonic()

    @property
    def due(self) -> bool:
        """Whether it is time for the next."""
        return time.monotonic() - self._last >= self._every

    def write(self, now: Checkpoint, snapshots: ResultWriter) -> None:
        """Replace the last checkpoint. Raises OSError, and leaves that one, where the disk is too full."""
        try:
            self._check_space(now, snapshots)
            with h5py.File(self._new, "w", userblock_size=HEADER) as file:
                for name, values in now.arrays.items():
                    file.create_dataset(f"model/{name}", data=values)
                file.create_dataset("rows", data=now.rows.table).attrs["columns"] = now.rows.names
                if self._heights is not None:
                    file.create_dataset("heights", data=self._heights)
                snapshots.copy_to(file)
                of_the_run = {name: getattr(now, name) for name in OF_THE_RUN}
                numbers = json.loads(json.dumps(now.numbers))
                kinds = {"arrays": _kinds(now.arrays), "numbers": _kinds(numbers)}
                file["about"] = json.dumps(self._about | of_the_run | {"kinds": kinds})
            with self._new.open("r+b") as whole:
                seal(whole, f"{MAGIC} {FORMAT}")
                whole.flush()
                os.fsync(whole.fileno())
            self._new.replace(self.path)
            _flush_folder(self.path.parent)
        finally:
            self._new.unlink(missing_ok=True)
            self._last = time.monotonic()

    def remove(self) -> None:
        """Remove the file: the run needs none any more."""
        self.path.unlink(missing_ok=True)

    def _check_space(self, now: Checkpoint, snapshots: ResultWriter) -> None:
        size = sum(values.nbytes for values in now.arrays.values()) + snapshots.copied_bytes
        size += now.rows.table.nbytes + SPACE_FOR_THE_REST
        size += 0 if self._heights is None else self._heights.nbytes
        require_free_space(self._new.parent, size)


class StoredCheckpoint:
    """A checkpoint in a file, which is whole and of this format."""

    def __init__(self, path: Path, file: h5py.File) -> None:
        self._path = path
        self.file = file
        #: Whether the heights made anew differ from the stored ones, by rounding.
        self.heights_differ = False
        with self.reading():
            about = json.loads(file["about"][()])
            names = *OF_THE_RUN, "version", "study", "device", "surface", "kinds", "counter", "files"
            self._about = {name: about[name] for name in names}
            self._order = RunOrder(Study.stored(about["study"]))
            self._rows = Rows(map(str, file["rows"].attrs["columns"]), file["rows"][()])
            if not isinstance(self._about["device"], str):
                raise ValueError("its device is no text")
            if file["rows"].dtype != np.float64 or file["rows"].shape[1] != len(self._rows.names):
                raise ValueError("its rows are none")

    @contextmanager
    def reading(self) -> Iterator[None]:
        """Raise InputError for whatever a file sealed by hand may lack or hold instead."""
        try:
            yield
        except InputError:
            raise
        except (OSError, LookupError, ValueError, TypeError, AttributeError, RuntimeError) as error:
            raise InputError(f"{self._path} is no checkpoint that can be read: {error}.") from error

    def _refused(self, why: str, **values: Any) -> InputError:
        """Return the error of a run that cannot go on from here, by the name of its sentence."""
        how = {"path": self._path, "resume_it": RESUME_IT, "overwrite_it": OVERWRITE_IT}
        return InputError(say(why, **how, **values))

    @property
    def version(self) -> str:
        """Return the version of warpwear that wrote it."""
        return str(self._about["version"])

    def refuse_changes(self, order: RunOrder, *, device: str) -> None:
        """Raise InputError for a run that would not go on where this one stopped."""
        # What the pieces are follows from the junctions where they are as large as these.
        free = (*LABELS, "friction") if order.study.wear.particle == "critical" else FREE
        changed = changed_keys(self._order.keys, order.keys, free=free)
        if changed:
            raise self._refused("other_study", changed=", ".join(changed))
        if self._about["counter"] != _of_counter(order):
            raise self._refused("other_counter")
        if order.study.checks.strict and (failed := self._about["reported_violations"]):
            raise self._refused("failed_check", failed=", ".join(failed))
        if self._about["device"].split(":")[0] != device.split(":")[0]:
            raise self._refused("other_device", device=device, before=self._about["device"])

    def refuse_other_files(self, files: Mapping[str, str]) -> None:
        """Raise InputError where files are not what they were. files: their digests by keys."""
        if self._about["files"] != files:
            raise self._refused("other_file", keys=" or ".join(files))

    def heights_for(self, new: FloatArray) -> FloatArray:
        """Return the heights to go on with [mm]: new ones, or those stored where they differ by rounding.

        Raises InputError where they differ by more.
        """
        if checksum(new) == self._about["surface"]:
            return new
        with self.reading():
            stored: FloatArray = np.asarray(self.file["heights"][()], dtype=np.float64)
        if stored.shape != new.shape or not np.abs(stored - new).max() <= SAME_HEIGHTS:
            raise self._refused("other_heights")
        self.heights_differ = True
        return stored

    def block_of(self, blocks: Iterable[Block]) -> Block:
        """Return the one of the study's blocks that the run was in."""
        with self.reading():
            return {block.number: block for block in blocks}[int(self._rows.last["block"])]

    def read(self) -> Checkpoint:
        """Where the run was: all that is stored but the snapshots."""
        arrays = {name: np.asarray(dataset[()]) for name, dataset in self.file["model"].items()}
        kinds = dotted({"arrays": _kinds(arrays), "numbers": _kinds(self._about["numbers"])})
        stored_kinds = dotted(self._about["kinds"])
        for name in stored_kinds | kinds:
            is_now, was = (each.get(name, "missing") for each in (kinds, stored_kinds))
            if is_now != was:
                sentence = f"{name} is {is_now} instead of {was}"
                raise ValueError(sentence.replace("NoneType", "nothing"))
        check_snapshots(self.file, self._order.study)
        return Checkpoint(arrays, rows=self._rows, **{name: self._about[name] for name in OF_THE_RUN})


@contextmanager
def opened(path: Path | None) -> Iterator[StoredCheckpoint | None]:
    """Return the checkpoint in a file, None without one. Raises InputError for one damaged or too new."""
    if path is None or not path.exists():
        yield None
        return
    damaged = f"{path} is damaged: it is not what was written; {OVERWRITE_IT}."
    with path.open("rb") as whole:
        words = read_header(whole)
        if len(words) != 4 or " ".join(words[:2]) != MAGIC:
            raise InputError(damaged)
        if words[2] != str(FORMAT):
            how = {"path": path, "overwrite_it": OVERWRITE_IT}
            raise InputError(say("other_format", **how, format=words[2], ours=FORMAT))
        if words[3] != digest_of(whole):
            raise InputError(damaged)
    with h5py.File(path, "r") as file:
        yield StoredCheckpoint(path, file)


def holds_checkpoint(folder: Path) -> bool:
    """Whether a run folder holds a checkpoint of warpwear."""
    return is_one(folder / FILE_NAME)


def is_one(path: Path) -> bool:
    """Whether a file calls itself a checkpoint of warpwear."""
    return has_mark(path, MAGIC)


def _of_counter(order: RunOrder) -> int | None:
    """Return a number that tells what was measured of the counter-body; None where nothing was."""
    return checksum(order.form.values) if isinstance(order.form, Given) else None


def checksum(heights: FloatArray) -> int:
    """Return a number that tells the heights of one surface from those of another."""
    return zlib.crc32(np.ascontiguousarray(heights).data)


def changed_keys(
    before: Mapping[str, Any], after: Mapping[str, Any], *, free: Sequence[str] = FREE
) -> list[str]:
    """Keys whose values differ, but for those that are free to: by default, that no step depends on."""
    names = sorted(name for name in before.keys() | after.keys() if before.get(name) != after.get(name))
    sheared = any(keys.get(name) for keys in (before, after) for name in SHEARED)
    bound: tuple[str, ...] = (*OF_CAPS, OF_SHEAR) if sheared else OF_CAPS
    if "energy" in (before.get("wear.law"), after.get("wear.law")):
        bound = ("friction",)

    def under(name: str, keys: Sequence[str]) -> bool:
        return any(name == key or name.startswith(f"{key}.") for key in keys)

    return [name for name in names if under(name, bound) or not under(name, free)]


def _kinds(value: Any) -> Any:
    """Tell the type of a value, with the shape of an array; in a mapping or list, of each that it holds."""
    if isinstance(value, dict):
        return {name: _kinds(item) for name, item in value.items()}
    if isinstance(value, list):
        return [_kinds(item) for item in value]
    return f"{value.dtype} {value.shape}" if isinstance(value, np.ndarray) else type(value).__name__


def _flush_folder(folder: Path) -> None:
    """Make sure that the new name survives a power failure; not every system can."""
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
