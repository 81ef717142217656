"""Fill in a draft from files of tests of one pair: what they say, each number with where it is from."""

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from warpwear.calibration.measurements import OFF
from warpwear.calibration.repeats import RepeatedTests, repeats
from warpwear.calibration.repeats_text import with_s
from warpwear.calibration.scatter import PairTest
from warpwear.calibration.worn import SOURCES
from warpwear.errors import InputError, prose, reworded
from warpwear.measured.friction.states import StatesFit, fit_states, part_of, untold
from warpwear.study.content import Content
from warpwear.study.keys import alternatives_of, attribute_of, dotted
from warpwear.study.study import Study
from warpwear.study.units import TINIEST

#: Rigs whose tests are read -> key of the way, its length over that of the track, and how that is found.
CIRCLE = ("sliding.track_radius", 0.5 / math.pi, "a lap over 2π")
WAYS = {"reciprocating": ("sliding.stroke", 1.0, "stroke"), "rotating": CIRCLE, "pin": CIRCLE}
#: Keys of a study -> conditions of a test, their units, and where they are from.
CONDITIONS = prose("reports")["draft"]["conditions"]
#: Keys of a draft that are choices and no facts of a test, and of facts what stands for them, too.
CHOICES = {"study.name", "study.description", "counter.shape", "contact.law", "disc.synthetic.kind"}
CHOICES |= {"disc.synthetic.cut_off", "grid.cell", "grid.extent", "sliding.track"}
STANDS = {f"{body}.material": f"{body}.young" for body in ("counter", "disc")}
#: How records are read -> the keys of a study that say it.
READ = {"load": "contact.load", "radius": CIRCLE[0], "stroke": "sliding.stroke", "speed": "sliding.speed"}


def from_tests(
    tests: Sequence[Any], like: str, study: Study, given: Mapping[str, str], *how: Any
) -> tuple[dict[str, Any], dict[str, str], Sequence[str]]:
    """Find what tests of one pair say of a study: keys, where they are from, and doubts of records.

    given: key that was given, and stays -> where it is from. how: columns and preparation, as of `repeats`.
    Raises InputError for what cannot be read, and where tests differ in what a study has once.
    """
    if like not in WAYS:
        raise InputError(f"tests fill in a draft of {', '.join(WAYS)}: --like {like} takes none")
    known: dict[str, Any] = {name: attribute_of(study, key) for name, key in READ.items() if key in given}
    if "sliding.frequency" in given:
        given = {READ["speed"]: "", **given}  # as it says that
        known |= {"speed": study.sliding.mean_speed} if known.keys() & {"radius", "stroke"} else {}
    read = known | dict(zip(("columns", "preparation"), how, strict=True))
    sized = {"counter.radius", "counter.diameter"} & given.keys()
    ball = {"radius": (study.counter.nominal_radius, "mm")} if sized else {}
    listed = [ball | dict(test if isinstance(test, Mapping) else {"record": test}) for test in tests]
    with reworded({f"--{option} '": f"--set {key}='" for option, key in READ.items()}):
        found = repeats(listed, **read)
        if "load" in known and _differ([test.conditions.get("load", math.nan) for test in found.tests]):
            found = repeats(listed, at={"load": known["load"]}, **read)
    values, origins = {"study.description": f"measured: {found.numbers['sentence']}"}, dict(given)
    conditions = _conditions(found.tests, like, listed, given)
    for name, value, origin in (*conditions, *_numbers(found, listed, given)):
        if not {name, *alternatives_of(Content, name)} & given.keys():
            values[name], origins[name] = value, origin
    return values, origins, found.numbers["notes"]


def unknown(document: Mapping[str, Any], known: Mapping[str, Any]) -> list[str]:
    """Write the facts that a draft has examples of, and neither files nor a person say."""
    examples = dotted(document)
    if examples.get("disc.synthetic.kind") == "flat":
        del examples["disc.synthetic.sq"]  # which plays no part
    return [
        f"{name}={value!r}"
        for name, value in examples.items()
        if name not in CHOICES and not any(key.startswith((name, STANDS.get(name, name))) for key in known)
    ]


def _differ(values: Sequence[float]) -> bool:
    """Tell whether numbers of tests are too far apart for one study."""
    return bool(np.max(values) > (1.0 + OFF) * np.min(values))


def _conditions(
    tests: Sequence[PairTest], like: str, listed: Sequence[Mapping[str, Any]], given: Mapping[str, str]
) -> Iterator[tuple[str, Any, str]]:
    """Give conditions of the tests as keys of a study, with where they are from. Raises InputError."""
    way, part, how = WAYS[like]
    for test in tests:
        ways = {step.is_circle for step in test.steps if step.track}
        if (like == "reciprocating") in ways:
            own = "round: --like rotating or pin" if True in ways else "to and fro: --like reciprocating"
            raise InputError(f"{test.name} goes {own} is its rig, not {like}")
        if _differ([step.load or math.nan for step in test.steps] or [1.0]):
            raise InputError(f"{test.name} has steps under several loads: a study of these has [[block]]")
    for name, (key, unit, source) in {**CONDITIONS, way: ("track_length", "mm", how)}.items():
        sizes = {t.name: size for t in tests if (size := t.conditions.get(key, math.nan)) > 0.0}
        if not sizes or name in given:
            continue
        if key != "distance" and _differ([*sizes.values()]):
            ends = f"from {min(sizes.values()):.4g} to {max(sizes.values()):.4g} {unit}"
            raise InputError(f"the tests have a {key} {ends}: --set {name} says which the study is of")
        size = max(sizes.values()) if key == "distance" else float(np.mean([*sizes.values()]))
        source = "as listed" if any(key in test for test in listed) else source
        yield name, f"{size * part if name == way else size:.5g} {unit}", f"{source}: {', '.join(sizes)}"


def _numbers(
    found: RepeatedTests, listed: Sequence[Mapping[str, Any]], given: Mapping[str, str]
) -> Iterator[tuple[str, Any, str]]:
    """Give wear coefficients and friction as keys of a study, with where they are from."""
    text = {}
    for kind, told in found.told.items():
        at = f", at {told['at']['load']:.4g} N by the trend" if "load" in told["at"] else ""
        errors = [test.values[kind].error for test in found.tests if kind in test.values]
        own = f", own error {errors[0]:.2g}" if errors[0] and len(errors) == 1 else ""
        text[kind] = f"{with_s(told)} (n = {told['n']}{own}){at}"
    for name, kind in (("wear.counter", "k_counter"), ("wear.disc", "k_disc")):
        if kind in text:
            worn = [key for key, source in SOURCES.items() if source.worn == kind[2:]]
            files = [f"{key} {Path(str(test[key])).name}" for test in listed for key in worn if key in test]
            value = f"{found.told[kind]['mean']:.4g} mm^3/N/m"
            yield name, value, f"V/(F L) {text[kind]}: {', '.join(files)}"
    fits, why = ([], "") if any(key.startswith("friction.") for key in given) else _states_of(found.tests)
    if fits:
        yield "friction.law", "states", "the records jump; a law that fits, no prediction"
        for key, number, origin in _means_of(fits):
            yield f"friction.states.{key}", number, origin
    elif "level" in text:
        origin = f"steady value {text['level']}: {', '.join(test.name for test in found.tests)}{why}"
        yield "friction.coefficient", float(f"{found.told['level']['mean']:.4g}"), origin


def _states_of(tests: Sequence[PairTest]) -> tuple[list[StatesFit], str]:
    """Fit the three states to all records at once; none, and why, where these do not tell them."""
    steps = [step for test in tests for step in test.steps]
    if not steps or not all(step.states for step in steps):
        return [], ", which do not all jump"
    laps = [step.laps.length / step.laps.laps if step.laps.laps else None for step in steps]
    fits = fit_states([part_of(step.course, lap) for step, lap in zip(steps, laps, strict=True)])
    hardly = [name for fit in fits for name in untold(fit)]
    hardly += ["seed" for fit in fits if fit.numbers["seed"][0] < TINIEST]
    return ([], f", which hardly tell {hardly[0]} of three states") if hardly else (fits, "")


def _means_of(fits: Sequence[StatesFit]) -> Iterator[tuple[str, Any, str]]:
    """Give the constants of three states, means of the tests, with a seed for the mean wait."""
    mean: dict[str, float] = {}
    per = "mm" if fits[0].unit == "mm" else "lap"
    for name in ("film", "slope", "metal", "cover", "spread", "seed", "cover_rate"):
        each = [fit.numbers["wait" if name == "seed" else name] for fit in fits]
        numbers = [number for number, _ in each]
        mean[name] = float(np.mean(numbers))
        origin = f"fit of all, ± {each[0][1]:.2g}"
        if len({*numbers}) > 1:
            origin = f"tests from {min(numbers):.4g} to {max(numbers):.4g}"
        if name == "seed":
            origin = f"for a wait of {mean[name]:.3g} {fits[0].unit}{'s' * (per == 'lap')}; {origin}"
            mean[name] = mean["spread"] * math.exp(-mean["spread"] * mean[name])
        yield name, float(f"{mean[name]:.4g}"), origin
    yield "per", per, "what the rates are of"
