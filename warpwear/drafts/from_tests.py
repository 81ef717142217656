"""Fill in a draft from files of tests of one pair: what they say, each number with where it is from."""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from warpwear.calibration.measurements import OFF, in_file
from warpwear.calibration.pair_tests import PairTest
from warpwear.calibration.repeats import RepeatedTests, repeats
from warpwear.calibration.repeats_text import with_s
from warpwear.calibration.worn import SOURCES
from warpwear.errors import InputError
from warpwear.measured.friction.states import StatesFit, fit_states, part_of, untold
from warpwear.results.report import shown
from warpwear.study.content import Content
from warpwear.study.keys import alternatives_of, dotted
from warpwear.study.motion import Sliding
from warpwear.study.units import TINIEST, parse

#: Rigs whose tests are read -> key of the way, and its length over that of the track.
WAYS = {
    "reciprocating": ("sliding.stroke", 1.0),
    "rotating": ("sliding.track_radius", 0.5 / math.pi),
    "pin": ("sliding.track_radius", 0.5 / math.pi),
}
#: Keys of a study -> conditions of a test, their units, and where a record has them.
CONDITIONS = {
    "contact.load": ("load", "N", "median normal force"),
    "sliding.speed": ("speed", "mm/s", "median speed, or distance over time"),
    "sliding.distance": ("distance", "mm", "the longest"),
    "counter.radius": ("radius", "mm", "of the ball"),
}
#: Keys of a draft that are facts of a test and no choice: without a file and a person they are asked for.
FACTS = ("counter.diameter", "counter.radius", "counter.edge_radius", "counter.material", "disc.material")
FACTS += ("disc.synthetic.sq", "contact.load", "wear.counter", "wear.disc", "friction.coefficient")
FACTS += ("sliding.stroke", "sliding.track_radius", "sliding.cycles", "sliding.revolutions")
#: Options of a record as sentences name them -> the key of the study that says it here.
_OPTIONS = {"radius": "sliding.track_radius", "stroke": "sliding.stroke", "load": "contact.load"}
_OPTION = re.compile(r"--(radius|stroke|speed|load)\b(?: '([^']*)')?")
#: Names of tests in a comment, at most.
MOST_NAMES = 3


@dataclass(frozen=True)
class FromTests:
    """Files say these keys of a study. origins: key -> where it is from; told: lines for people."""

    changes: Mapping[str, Any]
    origins: Mapping[str, str]
    told: tuple[str, ...]


def from_tests(
    tests: Any,
    like: str,
    changes: Mapping[str, Any],
    *,
    columns: str | None = None,
    preparation: Mapping[str, Any] | None = None,
) -> FromTests:
    """Find what tests of one pair say of a study; `changes`, and sections beside the tests, come first.

    Raises InputError for what cannot be read, and where tests differ in what a study has once.
    """
    if like not in WAYS:
        raise InputError(f"tests fill in a draft of {', '.join(WAYS)}: --like {like} takes none")
    given = dict.fromkeys(changes, "given")
    if isinstance(tests, str | Path):
        sections, where = in_file(tests)
        sections = dotted({name: keys for name, keys in sections.items() if name not in ("infer", "sweep")})
        given |= dict.fromkeys(sections.keys() - changes.keys(), f"given in {Path(tests).name}")
        changes, tests = sections | dict(changes), where
    motion, ball = _alike(changes)
    read: Any = motion | {"load": changes.get("contact.load"), "columns": columns, "preparation": preparation}
    listed = [ball | dict(test if isinstance(test, Mapping) else {"record": test}) for test in tests]
    try:
        found = repeats(listed, **read)
        loads = [test.conditions.get("load", math.nan) for test in found.tests]
        if "contact.load" in changes and _differ(loads):
            found = repeats(listed, at={"load": changes["contact.load"]}, **read)
    except InputError as error:
        raise InputError(_OPTION.sub(_as_change, error.sentence)) from error
    values, origins = dict(changes), dict(given)
    for name, value, origin in (*_conditions(found.tests, like, changes), *_numbers(found, listed, changes)):
        said = {name, *alternatives_of(Content, name)}
        said |= {"sliding.frequency"} if name == "sliding.speed" else set()
        if not said & given.keys():
            values[name], origins[name] = value, origin
    sentence = found.numbers["sentence"]
    values.setdefault("study.description", f"measured: {sentence}")
    return FromTests(values, origins, (sentence, *(f"warning: {note}" for note in found.numbers["notes"])))


def unknown(document: Mapping[str, Any], known: Mapping[str, Any]) -> list[str]:
    """Name the facts of a draft that neither files nor a person say, with the draft's examples."""
    left = {name: value for name, value in dotted(document).items() if name in FACTS and name not in known}
    for body in ("counter", "disc"):
        if {f"{body}.young", f"{body}.poisson", f"{body}.hardness"} <= known.keys():
            left.pop(f"{body}.material", None)
    if any(name.startswith("disc.synthetic.") for name in known):
        left.pop("disc.synthetic.sq", None)
    return [f"{name}={value!r}" for name, value in left.items()]


def _as_change(option: re.Match[str]) -> str:
    """Name the key of a study that says what an option of a record does."""
    key = _OPTIONS.get(option[1], "sliding.speed")
    return f"--set {key}" + (f"='{option[2]}'" if option[2] else "")


def _alike(changes: Mapping[str, Any]) -> tuple[dict[str, str], dict[str, str]]:
    """Return how records are read, and the ball's radius, by the changes of a study."""
    names = ("track_radius", "stroke", "frequency", "speed")
    try:
        sliding = Sliding(**{n: changes[f"sliding.{n}"] for n in names if f"sliding.{n}" in changes})
        balls = {"counter.radius": 1.0, "counter.diameter": 0.5}
        sizes = [part * parse(changes[name], "mm") for name, part in balls.items() if name in changes]
    except ValueError:  # the study says what is wrong with it
        return {}, {}
    motion = {"radius": sliding.track_radius, "stroke": sliding.stroke, "speed": sliding.mean_speed}
    units = {"speed": "mm/s"}
    known = {name: f"{size!r} {units.get(name, 'mm')}" for name, size in motion.items() if size}
    return known, {"radius": f"{sizes[0]!r} mm"} if sizes else {}


def _differ(values: Sequence[float]) -> bool:
    """Tell whether numbers of tests are too far apart for one study."""
    return bool(np.max(values) > (1.0 + OFF) * np.min(values))


def _conditions(
    tests: Sequence[PairTest], like: str, changes: Mapping[str, Any]
) -> Iterator[tuple[str, Any, str]]:
    """Give conditions of the tests as keys of a study, with where they are from. Raises InputError."""
    way, part = WAYS[like]
    to_and_fro = [test.name for test in tests if not all(step.is_round for step in test.steps)]
    if to_and_fro and like != "reciprocating":
        raise InputError(f"{to_and_fro[0]} goes to and fro: --like reciprocating is its rig, not {like}")
    for test in tests:
        if _differ([step.load or math.nan for step in test.steps] or [1.0]):
            raise InputError(
                f"{test.name} has steps under several loads: a study of these has a list [[block]]"
            )
    for name, (key, unit, how) in {**CONDITIONS, way: ("length", "mm", "track of")}.items():
        known = [test.conditions[key] for test in tests if test.conditions.get(key, math.nan) > 0.0]
        if not known or name in changes:
            continue
        if key != "distance" and _differ(known):
            ends = f"from {min(known):.4g} to {max(known):.4g} {unit}"
            raise InputError(f"the tests have a {key} {ends}: --set {name} says which the study is of")
        length = max(known) if key == "distance" else float(np.mean(known))
        size = length * part if name == way else length
        text = f"{how} {length:.4g} mm" if name == way else how
        yield name, f"{size:.5g} {unit}", f"{text}: {_listed([test.name for test in tests])}"


def _numbers(
    found: RepeatedTests, listed: Sequence[Mapping[str, Any]], changes: Mapping[str, Any]
) -> Iterator[tuple[str, Any, str]]:
    """Give wear coefficients and friction as keys of a study, with where they are from."""
    for name, kind in (("wear.counter", "k_counter"), ("wear.disc", "k_disc")):
        if (told := found.told.get(kind)) is not None:
            worn = [s for s, source in SOURCES.items() if source.worn == kind[2:]]
            files = [f"{s} {Path(str(test[s])).name}" for test in listed for s in worn if s in test]
            errors = [test.values[kind].error for test in found.tests if kind in test.values]
            own = f" ± {errors[0]:.2g} by its own error" if told["n"] == 1 and errors[0] else ""
            yield name, f"{told['mean']:.4g} mm^3/N/m", f"V/(F L) {_of(told)}{own}: {_listed(files)}"
    if any(name.startswith("friction.") and name != "friction.law" for name in changes):
        return
    law, fits, why = changes.get("friction.law"), [], ""
    if law in (None, "states"):
        fits, why = _states_of(found.tests)
        if law and not fits:
            raise InputError(f"friction.law = 'states' is not told by the tests: {why}")
    level = found.told.get("level")
    if fits:
        yield "friction.law", "states", "the records jump; a law that fits, no prediction"
        for key, value, origin in _means_of(fits):
            yield f"friction.states.{key}", value, origin
    elif level is not None:
        names = _listed([test.name for test in found.tests if "level" in test.values])
        yield (
            "friction.coefficient",
            float(f"{level['mean']:.4g}"),
            f"steady value {_of(level)}: {names}{why}",
        )


def _states_of(tests: Sequence[PairTest]) -> tuple[list[StatesFit], str]:
    """Fit the three states to all records at once; none, and why, where these do not tell them."""
    steps = [step for test in tests for step in test.steps]
    flat = [test.name for test in tests if any(step.states is None for step in test.steps) or not test.steps]
    if flat or not steps:
        return [], f"; no jump in {flat[0]}" if flat else ""
    laps = [step.laps.length / step.laps.laps if step.laps.laps else None for step in steps]
    fits = fit_states([part_of(step.course, lap) for step, lap in zip(steps, laps, strict=True)])
    for fit in fits:
        if (hardly := untold(fit)) or fit.numbers["seed"][0] < TINIEST:
            return [], f"; three states are not told: {', '.join(hardly) or 'seed'}"
    return fits, ""


def _means_of(fits: Sequence[StatesFit]) -> Iterator[tuple[str, Any, str]]:
    """Give the constants of three states: shared ones, means of the others, a seed for the mean wait."""
    many = fits[0].unit if fits[0].unit == "mm" else f"{fits[0].unit}s"
    mean = {name: float(np.mean([fit.numbers[name][0] for fit in fits])) for name in fits[0].numbers}
    waits = [float(fit.values[5]) for fit in fits]
    mean["seed"] = mean["spread"] * math.exp(-mean["spread"] * float(np.mean(waits)))
    for name in ("film", "slope", "metal", "cover", "spread", "seed", "cover_rate"):
        each = [fit.numbers[name] for fit in fits]
        s = float(np.std([value for value, _ in each], ddof=1)) if len(fits) > 1 else each[0][1]
        kind = "s of the tests" if len(fits) > 1 else "error of the fit"
        if name in ("metal", "spread"):
            s, kind = each[0][1], "one for all tests, error of the fit"
        origin = f"± {s:.2g}, {kind}"
        if name == "seed":
            ends = f"{min(waits):.3g} to {max(waits):.3g}"
            origin = (
                f"ln(r/e)/r is the mean wait, {np.mean(waits):.3g} {many} ({ends}): the next test's scatters"
            )
        yield name, float(f"{mean[name]:.4g}"), origin
    yield "per", "mm" if fits[0].unit == "mm" else "lap", "what the rates are of"


def _of(told: Mapping[str, Any]) -> str:
    """Write mean ± s of tests, and how many they are."""
    at = f", at {told['at']['load']:.4g} N by the trend" if told["at"].get("load") else ""
    return f"{with_s(told)} (n = {told['n']}){at}"


def _listed(names: Sequence[str]) -> str:
    """Write names for a comment, those beyond a few as a number."""
    more = len(names) - MOST_NAMES
    return ", ".join(names[:MOST_NAMES]) + (f" and {shown(more)} more" if more > 0 else "")
