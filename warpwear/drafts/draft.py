"""A draft is the text of a commented study of one rig, filled in from a measured surface and from changes."""

import math
import os
import re
import warnings
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit
from tomlkit.items import Item, Table

from warpwear import lazy
from warpwear.errors import InputError, StudyWarning, escaped, explained, named_in_python, unescaped
from warpwear.laws.elastic import asperities
from warpwear.runs.plan import contacts_of
from warpwear.study.keys import dotted, value_of
from warpwear.study.loading import change
from warpwear.study.rules_track import summits, widths_with
from warpwear.study.study import Study
from warpwear.study.surface import surface_of
from warpwear.study.units import parse
from warpwear.surfaces.measured import Measured
from warpwear.surfaces.roughness import roughness

filling = lazy.module("warpwear.drafts.from_tests")
measurements = lazy.module("warpwear.calibration.measurements")

#: Extent of the domain over the width of the contact that smooth bodies are expected to have.
MARGIN = 1.3
#: Length of a track over the domain's, where the draft's own is shorter than the domain.
TRACK = 2
#: The rigs: where the text of each lies. The first is a preset too, so that a first run needs no file.
RIGS = {
    "reciprocating": "presets/first.toml",
    **{kind: f"drafts/{kind}.toml" for kind in ("rotating", "fretting", "pin", "block-on-ring")},
}
#: Column of a draft at which comments begin, where a value is short enough.
COLUMN = 32
#: Most cells along a side that are looked at for the height of the roughness.
MOST_SIDE = 2000
#: A commented table, and keys that were set below it, which are the section's above.
_BELOW_COMMENT = re.compile(r"(^\n(?:^# .*\n)+)((?:^\w+ = .*\n)+)", re.MULTILINE)
#: A section right below the last key of another.
_CLOSE = re.compile(r"(?<!\n)\n\[")
#: How far a cell may be off a file's pixel, as a part of it, to be a number of few digits.
NEAR = 0.13
#: Fewest and most cells over the width of that contact, between which a file's pixel is taken as the cell.
CELLS = (20, 400)


@named_in_python()
def new_study(
    path: str | Path | None = None,
    *,
    like: str = "reciprocating",
    surface: str | Path | None = None,
    changes: Mapping[str, Any] | None = None,
    tests: Any = None,
    columns: str | None = None,
    preparation: Mapping[str, Any] | None = None,
    overwrite: bool = False,
) -> Study:
    """Make a study of a rig, with the keys that such a test needs, and write it as a commented file.

    Parameters
    ----------
    path
        A file to write, named .toml; without it nothing is written.
    like
        The rig: "reciprocating", "rotating", "fretting", "pin" or "block-on-ring".
    surface
        File of a measured surface of the disc or flat. Its pixel becomes grid.cell; without a file a
        synthetic surface is used.
    changes
        Keys to change, by their names with dots, as `Study.replace` takes them.
    tests
        Tests of one pair, as `repeats` takes them, that fill in load, way, speed, distance, wear coefficients
        and friction; each comment says where a number is from. In a TOML file of tests there may be sections
        of a study, too, as changes. What neither says is refused by name.
    columns, preparation
        How records and profiles of tests are read, as of `repeats`.
    overwrite
        Whether to replace the file that is there.

    Returns
    -------
    Study
        The study, as it is in the file.

    Raises
    ------
    InputError
        For what is no study or says too little of one, and for a file that is there; nothing is written then.

    Examples
    --------
    >>> study = warpwear.new_study("my-test.toml", like="rotating", changes={"contact.load": "5 N"})
    >>> study.study.name, study.contact.load
    ('my-test', 5.0)
    """
    if like not in RIGS:
        raise InputError(f"--like is {like!r}: allowed is {', '.join(RIGS)}")
    file = Path(f"{like}.toml" if path is None else path)
    if file.suffix != ".toml":
        raise InputError(f"{file}: a study is a file named .toml, such as {file.name or 'my-test'}.toml.")
    if path is not None and file.exists() and not file.is_file():  # a pipe would be waited for without end
        raise InputError(f"{file} is no file that can be replaced; give another name.")
    if path is not None and file.exists() and not overwrite:
        raise InputError(f"{file} is there already; --overwrite replaces it.")
    of_file: Any = {"name": file.stem, "folder": file.parent, "surface": surface and Path(surface)}
    given, origins = dict(changes or {}), None
    if tests is not None:
        origins = dict.fromkeys(given, "given")
        if isinstance(tests, str | Path):
            sections, tests = measurements.in_file(tests)
            own = dotted({name: keys for name, keys in sections.items() if name not in ("infer", "sweep")})
            origins, given = dict.fromkeys(own, "given beside the tests") | origins, own | given
        example, how = Study.stored(draft(like, **of_file, changes=given)), (columns, preparation)
        filled, origins, doubts = filling.from_tests(tests, like, example, origins, *how)
        given = filled | given
        for doubt in doubts:
            warnings.warn(doubt, StudyWarning, stacklevel=2)
    text = draft(like, **of_file, changes=given, origins=origins)
    if path is None:
        return Study.stored(text)
    with explained(f"{file} cannot be written"):
        file.write_text(text, encoding="utf-8")
    return Study.load(file)


def outlook(study: Study) -> str:
    """Say how many steps a run of a study computes, and how the asperities of its disc yield."""
    number, grid = contacts_of(study), study.cells
    text = f"{'at most ' if study.jumps else ''}{number} step{'s' * (number != 1)} to compute"
    heights = surface_of(study.disc).heights(grid.x, grid.y) if study.is_rough else np.zeros((2, 2))
    slope = roughness(heights, pixel=(grid.cell, grid.cell))["rms_slope"]
    if not slope or math.isinf(study.hardness):
        return text
    ratio, kind = asperities(study.hardness, study.pair.effective_modulus, slope)
    return f"{text}; asperities {kind}, H/(E*·rms slope) = {ratio:.2g}"


def draft(
    kind: str,
    *,
    name: str,
    folder: Path,
    surface: Path | None = None,
    changes: Mapping[str, Any] | None = None,
    origins: Mapping[str, str] | None = None,
) -> str:
    """Return the text of a study of a kind of rig.

    folder: where it will lie, to which the measured surface's path is relative. changes: dotted keys to
    values, which replace those of the draft. origins: where each is from, of a study of tests, which has no
    examples. Cell and extent follow from the surface's pixel and the contact's width where they are not among
    the changes. Raises InputError for what is no study.
    """
    document: Any = tomlkit.parse((resources.files("warpwear") / RIGS[kind]).read_text(encoding="utf-8"))
    document["study"].pop("description", None)  # of the preset
    wanted = {"study.name": name, **(changes or {})}
    if surface is not None:
        document["disc"].pop("synthetic", None)
        wanted["disc.surface"] = escaped(os.path.relpath(surface, folder))
    if origins is not None:
        document["sliding"].pop("frequency", None)  # of no test
    change(document, wanted)
    if origins is not None:
        _explain(document, wanted, origins)
    if not all(isinstance(section, dict) for section in document.values()):
        Study(**document.unwrap())  # refuses a value in the place of a section
    if "sliding.track" not in wanted and _is_longer_than_lap(document["sliding"]):
        document["sliding"]["track"] = "full"
    if document["counter"].get("shape") in ("ball", "pin") and "contact.boundary" not in wanted:
        _unlined(document)
    change(document, _grid(document, wanted, folder))
    _study(document.unwrap(), folder)  # what is no study is refused before anything is written
    _align(document)
    return _CLOSE.sub("\n\n[", _BELOW_COMMENT.sub(r"\2\1", tomlkit.dumps(document)))


def _explain(document: Any, wanted: Mapping[str, Any], origins: Mapping[str, str]) -> None:
    """Say behind each number where it is from. Raises InputError where that is nowhere."""
    if left := filling.unknown(document, wanted):
        names = ", ".join(example.partition("=")[0] for example in left)
        raise InputError(f"no file says {names}: give each as a change, such as --set {left[0]}")
    for name, origin in origins.items():
        item = value_of(document, name)
        if isinstance(item, Item):
            item.comment(origin)


def _unlined(document: Any) -> None:
    """Make a draft of a line contact one of a body that is round across sliding too."""
    grid = document["grid"]
    if document["contact"].pop("boundary", None) and isinstance(grid.get("extent"), list):
        grid["extent"] = grid["extent"][0]
        side: Any = grid["extent"]
        side.comment("wider than the contact at the end")


def _align(tables: Any) -> None:
    """Begin the comments of a draft at one column again, after values of other lengths."""
    for key, item in tables.items():
        if isinstance(item, Table):
            _align(item)
        elif isinstance(item, Item) and item.trivia.comment:
            item.trivia.comment_ws = " " * max(COLUMN - len(f"{key} = {item.as_string()}"), 2)


def _study(sections: dict[str, Any], folder: Path) -> Study:
    """Return the study of sections that will lie in a folder. Raises InputError."""
    if sections["disc"].get("surface"):
        sections["disc"]["surface"] = str(folder / unescaped(sections["disc"]["surface"]))
    return Study(**sections)


def _roomy(document: Any, wanted: Mapping[str, Any], folder: Path) -> Study:
    """Return the study in the smallest of some domains that holds its contact. Raises InputError."""
    try:
        return _study(document.unwrap(), folder)
    except InputError as error:
        refusal = error
    for cells in (64, 128, 256, 512, 1024) if "grid.extent" not in wanted else ():
        sections = document.unwrap()
        with suppress(InputError, ValueError):
            cell = parse(sections["grid"].get("cell"), "mm")
            along = f"{cells * cell!r} mm"
            line = isinstance(sections["grid"].get("extent"), list)
            sections["grid"]["extent"] = [along, f"{cell!r} mm"] if line else along
            if _is_short(document, wanted, cells * cell):
                sections["sliding"]["track"] = f"{TRACK * cells * cell!r} mm"
            return _study(sections, folder)
    raise refusal


def _grid(document: Any, wanted: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return cell and extent, where they are not wanted otherwise, and how a small file goes on."""
    study = _roomy(document, wanted, folder)
    grid, surface = study.cells, surface_of(study.disc)
    if isinstance(surface, Measured):
        surface = replace(surface, extend="mirror")
    summit = summits(study)
    if study.disc.synthetic is None or study.disc.synthetic.kind == "profile":
        heights = surface.heights(grid.x[:MOST_SIDE], grid.y[:MOST_SIDE])
        summit = float(np.ptp(heights))
    widths = np.array(widths_with(study, summit))
    cell, change_of = grid.cell, dict[str, Any]()
    if isinstance(surface, Measured):
        if "grid.cell" not in wanted:
            widest = widths.max()
            cell = float(f"{min(max(*surface.pixel, widest / CELLS[1]), widest / CELLS[0]):.2g}")
            cell = _dividing(study, cell)
            change_of["grid.cell"] = f"{1e3 * cell:.9g} um"
        if "disc.extend" not in wanted:
            change_of["disc.extend"] = "mirror"  # a track is longer than most measurements
    if "grid.extent" not in wanted:
        sides = [8 * math.ceil(MARGIN * width / cell / 8) * cell if width else cell for width in widths]
        line = isinstance(study.grid.extent, tuple)
        change_of["grid.extent"] = [f"{s:.9g} mm" for s in sides] if line else f"{max(sides):.9g} mm"
        if _is_short(document, wanted, max(study.grid.sides[0], sides[0])):
            change_of["sliding.track"] = f"{TRACK * sides[0]:.9g} mm"
    return change_of


def _is_short(document: Any, wanted: Mapping[str, Any], side: float) -> bool:
    """Tell whether the draft's own track is shorter than a domain [mm] along sliding."""
    track = document["sliding"].get("track", "full")
    return "sliding.track" not in wanted and track != "full" and parse(track, "mm") < side


def _is_longer_than_lap(sliding: Mapping[str, Any]) -> bool:
    """Tell whether the draft's own track is longer than the stroke or lap of a study."""
    with suppress(ValueError):  # what is no length is refused with the study
        track = parse(sliding.get("track", "full"), "mm")
        laps = ("stroke", 1.0), ("track_radius", 2.0 * math.pi)
        return any(key in sliding and track > times * parse(sliding[key], "mm") for key, times in laps)
    return False


def _dividing(study: Study, cell: float) -> float:
    """Return the cell [mm] of fewest digits near one, of which the track or stroke holds whole steps."""
    if not study.is_swept or study.sliding.lap is None:
        return cell
    track = study.sliding.track
    length = study.sliding.lap if track == "full" else float(track)
    steps = study.shift if track != "full" else 1
    exact = length / cell / steps
    counts = range(max(math.floor((1.0 - NEAR) * exact), 1), math.ceil((1.0 + NEAR) * exact) + 1)
    cells = (length / (steps * count) for count in counts)
    return min(cells, key=lambda size: (len(f"{1e3 * size:.9g}"), abs(size - cell)))
