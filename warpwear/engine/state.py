"""Each part of a model declares once what steps change of it, which is saved and restored bit for bit.

A part is an object with a `STATE`, which names the attributes that steps change, with their types:

    STATE = {"gap": InFrame("contact"), "tiles": Tiles, "_last": Balance, "_done": int}

Arrays on a device are restored in place; parts of a part by their own `STATE`; dataclasses of numbers, arrays
and None are made anew. What cells, tiles or rows of a body have declares its frame, by
which it follows a disc that is changed: see `frames`. A part that must do more, once it is restored, does it
in `restored()`. What else steps change of it is made anew before it is read: these attributes are its
`SCRATCH`.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any, Protocol, get_args, get_origin

import numpy as np
import warp as wp

from warpwear.grid import Frame


@dataclass(frozen=True)
class InFrame:
    """Declares on which body an array lies; of a part or of a dictionary all arrays in it do.

    columns: whether only the columns first … last − 1 of the part's `columns` are saved, of a field.
    """

    frame: Frame
    columns: bool = False


@dataclass(frozen=True)
class Aside:
    """Declares what a run has learnt, and not its bodies: whole copies leave it out, and as it is.

    kind: its type, as others have it.
    """

    kind: Any


@dataclass(frozen=True)
class _Entries:
    """Holds the arrays of a state by dotted name, and the frames of those that declare one."""

    whole: bool
    aside: bool
    arrays: dict[str, np.ndarray] = field(default_factory=dict)
    frames: dict[str, Frame] = field(default_factory=dict)


class Part(Protocol):
    """Something that steps change."""

    @property
    def STATE(self) -> Mapping[str, Any]:
        """Names and types of the attributes that steps change."""


def save(
    part: Part, *, whole: bool = False, aside: bool | None = None
) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """Return arrays by dotted name, and numbers as JSON keeps them: all that `restore` needs.

    Arrays of a CPU are views, which the next step changes. whole: whether they are copies, of all columns,
    so that `restore` takes back what steps have done since. aside: whether what is `Aside` is there, too; by
    default not among copies.
    """
    entries = _Entries(whole, not whole if aside is None else aside)
    numbers = _saved(part, "", entries)
    arrays = entries.arrays
    return {name: values.copy() for name, values in arrays.items()} if whole else arrays, numbers


def frames(part: Part) -> dict[str, Frame]:
    """Return the frames of the arrays that `save` returns, by the same names, of those that declare one."""
    entries = _Entries(whole=True, aside=True)
    _saved(part, "", entries)
    return entries.frames


def check(part: Any, name: str, others: Collection[Any] = ()) -> None:
    """Raise TypeError for an array that a part does not declare, or has in its state without a frame.

    name: of the part. others: arrays that it uses and are another's. Members of mappings, sequences and
    structs are gone through; of parts of it those in its state.
    """
    declared = {*part.STATE, *getattr(part, "SCRATCH", ())}
    known = {id(one) for one in others} | {id(getattr(part, member, None)) for member in declared}
    for member, value in vars(part).items():
        if member not in declared and _has_array(value, known):
            raise TypeError(f"neither STATE nor SCRATCH of {name} has {member}, which holds an array")
    entries = _Entries(whole=True, aside=True)
    _saved(part, "", entries)
    if lost := {path for path, values in entries.arrays.items() if values.size} - entries.frames.keys():
        raise TypeError(f"STATE of {name} declares no frame (InFrame) of {', '.join(sorted(lost))}")


def _has_array(value: Any, known: set[int]) -> bool:
    """Tell whether a value is or holds an array that is not known."""
    if id(value) in known:
        return False
    if isinstance(value, Mapping):
        value = [*value.values()]
    elif hasattr(value, "_cls") and hasattr(value, "__ctype__"):  # a struct of Warp
        value = [getattr(value, member) for member in value._cls.vars]
    if isinstance(value, list | tuple):
        return any(_has_array(item, known) for item in value)
    return isinstance(value, wp.array | np.ndarray) or hasattr(value, "STATE")


def restore(part: Part, arrays: Mapping[str, np.ndarray], numbers: Mapping[str, Any]) -> None:
    """Give a part the state that another one of the same make saved.

    arrays, numbers: what `save` returned, the numbers perhaps by way of JSON. Raises KeyError, TypeError or
    ValueError for what `save` did not return.
    """
    _restore(part, "", arrays, numbers)


def _saved(part: Any, path: str, entries: _Entries, frame: Frame | None = None) -> dict[str, Any]:
    numbers: dict[str, Any] = {}
    for name, kind in part.STATE.items():
        if isinstance(kind, Aside):
            if not entries.aside:
                continue
            kind = kind.kind
        value, place = getattr(part, name), path + name.lstrip("_")
        numbers[name] = _put(value, kind, place, entries, frame)
        if isinstance(kind, InFrame) and kind.columns:
            entries.arrays[place] = _columns(part, entries.arrays[place], whole=entries.whole)
    return numbers


def _put(value: Any, kind: Any, path: str, entries: _Entries, frame: Frame | None) -> Any:
    """Enter the arrays of a value, in a frame if not in its kind's; return its numbers, None for arrays."""
    if isinstance(kind, InFrame):
        frame = kind.frame
    if hasattr(value, "STATE"):
        return _saved(value, f"{path}.", entries, frame)
    if isinstance(value, wp.array | np.ndarray):
        entries.arrays[path] = value.numpy() if isinstance(value, wp.array) else value
        if frame is not None:
            entries.frames[path] = frame
        return None
    if is_dataclass(value):
        value = {field.name: getattr(value, field.name) for field in fields(value)}
    if isinstance(value, Mapping):
        kinds = kind if isinstance(kind, Mapping) else {}
        return {n: _put(item, kinds.get(n), f"{path}.{n}", entries, frame) for n, item in value.items()}
    if isinstance(value, list | tuple):
        return [_put(item, None, f"{path}.{n}", entries, frame) for n, item in enumerate(value)]
    return value


def _restore(part: Any, path: str, arrays: Mapping[str, np.ndarray], numbers: Mapping[str, Any]) -> None:
    for name, kind in part.STATE.items():
        if isinstance(kind, Aside):
            if name not in numbers:
                continue
            kind = kind.kind
        before, place = getattr(part, name), path + name.lstrip("_")
        if isinstance(kind, InFrame) and kind.columns:
            host = before.numpy()
            columns = _columns(part, host, whole=arrays[place].size == host.size)
            columns[:] = _alike(arrays[place], columns, place)
            before.assign(host)
            continue
        after = _take(kind, before, numbers[name], place, arrays)
        if after is not before:
            setattr(part, name, after)
    if hasattr(part, "restored"):
        part.restored()


def _take(kind: Any, before: Any, saved: Any, path: str, arrays: Mapping[str, np.ndarray]) -> Any:
    """Return a value of some kind; the one before, where that was changed in place."""
    if hasattr(before, "STATE"):
        _restore(before, f"{path}.", arrays, saved)
        return before
    if isinstance(before, wp.array):
        before.assign(_alike(arrays[path], before.numpy(), path))
        return before
    if path in arrays:
        if isinstance(before, np.ndarray):  # a table may have any number of rows
            _alike(arrays[path][:0], before[:0], path)
        return arrays[path]
    if saved is None:
        return None
    if isinstance(kind, InFrame):
        kind = dict  # of arrays: others were met above
    if isinstance(kind, type) and is_dataclass(kind):
        named = {f.name: f.type for f in fields(kind)}
        return kind(**{n: _take(of, None, saved[n], f"{path}.{n}", arrays) for n, of in named.items()})
    if isinstance(saved, Mapping):
        kinds = kind if isinstance(kind, Mapping) else {}
        if not kinds and (get_origin(kind) or kind) not in (dict, Mapping):
            raise TypeError(f"{path} was saved by the names of its members, which {kind!r} does not have")
        items = before if isinstance(before, Mapping) else {}
        _, of = get_args(kind) or (None, None)
        return {
            n: _take(kinds.get(n, of), items.get(n), item, f"{path}.{n}", arrays) for n, item in saved.items()
        }
    if isinstance(saved, list):
        same = isinstance(before, list) and len(before) == len(saved)
        parts = before if same else [None] * len(saved)
        taken = [_take(None, parts[i], item, f"{path}.{i}", arrays) for i, item in enumerate(saved)]
        return taken if isinstance(before, list) else tuple(taken)
    return saved


def _alike(saved: Any, before: np.ndarray, path: str) -> Any:
    """Return an array that can take the place of another. Raises ValueError."""
    if getattr(saved, "shape", None) != before.shape or saved.dtype != before.dtype:
        raise ValueError(f"{path} is no array of {before.dtype} of the shape {before.shape}")
    return saved


def _columns(part: Any, host: np.ndarray, *, whole: bool) -> np.ndarray:
    """Return the columns of a field that its part names, or all."""
    first, last = (0, None) if whole else part.columns
    return host.reshape(host.shape[0], -1)[:, first:last]
