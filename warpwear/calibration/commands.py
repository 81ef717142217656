"""Commands of `warpwear calibrate`: from their options to the text that they print."""

import math
import re
from collections.abc import Callable, Sequence
from inspect import unwrap
from pathlib import Path
from typing import Any

from warpwear.calibration import worn
from warpwear.calibration.coat import calibrate_coat
from warpwear.calibration.coefficient import calibrate_wear
from warpwear.calibration.states import calibrate_states
from warpwear.calibration.strength import calibrate_friction
from warpwear.errors import InputError
from warpwear.measured.options import Options, flag, quantity
from warpwear.measured.surface import Preparation
from warpwear.results.report import to_json

#: Option of a measurement -> key of a test.
SOURCES = {"--volume": "volume", "--diagonals": "scar", "--scar": "scar", "--width": "width"}
SOURCES |= {"--section": "section", "--track": "profile", "--after": "after", "--ball": "ball"}
#: Options whose key has the same name.
SAME = ("--load", "--radius", "--track-radius", "--track-width", "--track-length")
#: Options of a fit of three states.
STATES = ("columns", "radius", "stroke", "speed", "load", "until", "as_json")
_KEY = re.compile(r"\btest\.\d+\.(\w+)")


def printed(function: Callable[..., Any], *, as_json: bool, **options: Any) -> str:
    """Return what a calibration comes to, for people or as JSON; its sentences name options."""
    outcome = unwrap(function)(**options)
    return to_json(outcome.numbers) if as_json else str(outcome)


def friction(*, experiments: Sequence[Path] = (), law: str = "shear-strength", **options: Any) -> str:
    """Find a shear strength, of several courses each: the text for people, or JSON. Raises InputError.

    law: or "states", whose constants are found of all courses at once.
    """
    o = Options(options)
    if law == "states":
        o.refuse("--tests", "--result", "--cof", "--ploughing", "--area", why="does not go with --law states")
        if not experiments:
            raise InputError("--law states needs --experiment, a record of a course of friction")
        given = {key: value for key, value in options.items() if key in STATES}
        return printed(calibrate_states, experiments=experiments, **given)
    o.refuse("--radius", "--until", why="needs --law states")
    options = {key: value for key, value in options.items() if key not in ("radius", "until")}
    if len(experiments) > 1:
        return printed(calibrate_friction, **options | {"tests": [{"record": path} for path in experiments]})
    return printed(calibrate_friction, experiment=next(iter(experiments), None), **options)


def wear(file: Path | None, preparation: Preparation, *, as_json: bool, **texts: Any) -> str:
    """Find a wear coefficient: the text for people, or JSON. Raises InputError.

    file: a list of tests, None where options have what was measured. preparation: keys of [disc], as text,
    for a measured file. texts: options with a unit, None where left out; a source's by test.
    """
    o = Options(texts)
    figure = o["--figure"]
    if o["--source"] == "coat" and file is not None:
        outcome = calibrate_coat(file, **{key[2:]: o[key] for key in ("--load", "--distance") if o[key]})
        if figure is not None:
            outcome.save_figure(figure, overwrite=True)
        return to_json(outcome.numbers) if as_json else str(outcome)
    o.refuse("--figure", why="is for FILE with --source coat")
    sources = {option: _with_errors(option, o[option], o["--uncertainty"]) for option in SOURCES if o[option]}
    if o["--diameter"] is not None:
        o.refuse("--radius", why="and --diameter exclude each other: both say how large the ball is")
        o["radius"] = f"{0.5 * quantity('--diameter', o['--diameter'], 'mm')!r} mm"
    alike = {option[2:].replace("-", "_"): o[option] for option in SAME if o[option] is not None}
    tests: Any = file
    if file is None and not sources:
        raise InputError(f"what was measured is missing: FILE, or one of {', '.join(SOURCES)}")
    if file is None:
        tests = [{SOURCES[option]: value} for option, values in sources.items() for value in values]
        option, before = next(iter(sources)), o["--before"] or ()
        goes = [*worn.SOURCES[SOURCES[option]].needs, *worn.SOURCES[SOURCES[option]].may_have]
        for name in [name for name in alike if name not in (*goes, "load")] if len(sources) == 1 else ():
            allowed = ", ".join(map(flag, goes)) or "no length"
            raise InputError(f"{flag(name)} is not for {option}: allowed with it is {allowed}")
        if before and option not in ("--track", "--after"):
            raise InputError(f"--before is not for {option}: allowed is it with --track and --after")
        if (before or option == "--after") and len(before) != len(tests):
            raise InputError(f"--before is given {len(before)} times, {option} {len(tests)}: each needs one")
        for test, earlier in zip(tests, before, strict=False):
            test["before"] = earlier
        _add_stroke(alike, o, grooves=sources.keys() & {"--section", "--track"})
    elif sources:
        raise InputError(f"{next(iter(sources))} and FILE exclude each other: the file has what was measured")
    if file is None or o["--distance"] or o["--passes"] is not None:
        alike["distance"] = f"{o.distance!r} mm"
    what = {"source": o["--source"], "standard": o["--standard"], "hardness": o["--hardness"]}
    try:
        return printed(calibrate_wear, as_json=as_json, tests=tests, preparation=preparation, **what, **alike)
    except InputError as error:
        if file is not None:
            raise
        options = {key: option for option, key in SOURCES.items() if option in sources}
        text = _KEY.sub(lambda match: options.get(match[1], flag(match[1])), str(error))
        raise InputError(text) from error.__cause__


def _with_errors(option: str, values: Sequence[Any], error: str | None) -> Sequence[Any]:
    """Write the uncertainty behind each value, if one is given for all. Raises InputError."""
    if error is None:
        return values
    if isinstance(values[0], Path):
        raise InputError(f"--uncertainty is not for {option}: a file brings its own standard error")
    if re.search(r"\+-|±", str(values)):
        raise InputError(f"--uncertainty and {option} with +- exclude each other: both say the uncertainty")
    return [f"{v} +- {error}" if isinstance(v, str) else [f"{d} +- {error}" for d in v] for v in values]


def _add_stroke(alike: dict[str, Any], o: Options, *, grooves: set[str]) -> None:
    """Take a groove as long as the stroke unless told otherwise. Raises InputError."""
    stroke = o["--stroke"]
    if grooves and stroke is not None:
        length = quantity("--track-length", alike.setdefault("track_length", stroke), "mm")
        if o["--standard"] == "g133-flat" and not math.isclose(length, quantity("--stroke", stroke, "mm")):
            raise InputError(f"--track-length {length:g} mm is not --stroke {stroke}, which g133-flat takes")
    if not grooves and stroke is not None and o["--passes"] is None:
        raise InputError("--stroke needs --passes")
