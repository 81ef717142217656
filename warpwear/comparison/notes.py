"""What is to be said about runs and measured courses that are laid over each other."""

from collections.abc import Callable, Iterator, Sequence

from warpwear.comparison.groups import MOST_NAMES, Group, RunData, listed, names_by_sentence
from warpwear.measured.course import check_coverage
from warpwear.measured.experiment import Experiment
from warpwear.study.keys import declarations, value_of
from warpwear.study.study import Study

INTERRUPTED = "interrupted before the end."
NO_COF = "no coefficient of friction: its end calibrates it."
NO_SNAPSHOT = "no snapshot, so no profile."
NO_FIELD = "no whole field, so no profile."


#: What makes two runs unlike tests, keys where they apply -> unit and value; None where a run has none.
CONDITIONS: dict[str, tuple[str, Callable[[Study], float | str | None]]] = {
    "model": ("", lambda s: s.study.model),
    "kinematics": ("", lambda s: s.kinematics),
    "contact.law": ("", lambda s: s.contact.law),
    "patches.macro_cell": ("µm", lambda s: 1.0e3 * s.patches.macro_cell),
    "patches.width": ("µm", lambda s: 1.0e3 * s.patches.patch_width),
    "patches.coupling": ("", lambda s: s.patches.coupling),
    "patches.bulk": ("", lambda s: s.patches.bulk),
    "contact.boundary": ("", lambda s: s.boundary),
    "sliding.plastic": ("", lambda s: s.sliding.plastic),
    "length of the track": ("mm", lambda s: s.lap if s.is_swept else None),
    "load": ("N", lambda s: s.same_load),
    "programme of blocks": ("", lambda s: s.programme),
    "sliding distance": ("mm", lambda s: s.sliding.total),
    "wear coefficient of the counter-body": ("mm³/(N·m)", lambda s: 1.0e3 * s.wear_coefficients[0]),
    "wear coefficient of the disc": ("mm³/(N·m)", lambda s: 1.0e3 * s.wear_coefficients[1]),
    "counter-body's curvature": ("1/mm", lambda s: max(s.counter.form.along, s.counter.form.across)),
}
#: Sections whose keys make runs unlike too, and those of them that stand above.
DEPTHS = tuple(f"{body}.{key}" for body in ("counter", "disc") for key in ("layers", "gradient"))
LAWS, ABOVE = ("wear.", "friction.", *DEPTHS), ("wear.counter", "wear.disc")


def _conditions_of(study: Study) -> dict[str, str]:
    """Return what makes runs unlike tests -> its value, for all that this one has."""
    written, unused = study.model_dump(), study.unused_keys
    above = {what: (of(study), unit) for what, (unit, of) in CONDITIONS.items() if what not in unused}
    keys = [key for key, declared in declarations(Study).items() if key.startswith(LAWS) and key not in ABOVE]
    laws = {key: value_of(written, key) for key in keys if key not in unused}
    texts = {what: f"{v:.6g} {unit}" if isinstance(v, float) else v for what, (v, unit) in above.items()}
    texts |= {key: "none" if v is None else str(v) for key, v in laws.items() if not isinstance(v, dict)}
    return {what: text.rstrip() for what, text in texts.items() if text is not None}


def notes_of(
    groups: Sequence[Group], runs: Sequence[RunData], experiments: Sequence[Experiment]
) -> Iterator[str]:
    """Say in which way runs are unlike, what misleads of each, what is an input, and what is missing."""
    for experiment in experiments:
        yield from (f"{experiment.name}: {warning}" for warning in experiment.warnings)
    yield from _differences(groups)
    yield from _of_runs([(run, INTERRUPTED) for run in runs if not run.summary.finished], runs)
    yield from _of_runs([(run, text) for run in runs for text in run.summary.warnings], runs)
    for way, key in (("end", "calibrate = 'end'"), ("coulomb", "law = 'coulomb'")):
        if inputs := [r.name for r in runs if r.study.friction.fitted == way and r.cof is not None]:
            yield (
                f"The CoF at the end of {listed(inputs, len(runs))} is an input (friction.{key}), "
                "not a result: compare the shear strengths, or run all with one friction.shear_strength."
            )
    yield from _of_runs([(run, NO_COF) for run in runs if run.cof is None], runs)
    missing = [(run, NO_FIELD if run.study.samples_area else NO_SNAPSHOT) for run in runs if not run.wear]
    yield from _of_runs(missing, runs)
    for e in experiments:
        yield from (f"{e.name}: {note}" for note in (*e.notes, *_lengths(e, runs), *_gaps(e, runs)))


def _of_runs(sentences: Sequence[tuple[RunData, str]], runs: Sequence[RunData]) -> Iterator[str]:
    """Make one note of all runs that have the same sentence."""
    names = names_by_sentence(sentences)
    return (f"{listed(who, len(runs))}: {sentence}" for sentence, who in names.items())


def _lengths(experiment: Experiment, runs: Sequence[RunData]) -> list[str]:
    """Say whether it is far shorter or longer than every run, as in a wrong unit."""
    whole, totals = float(experiment.distance[-1]), [run.summary.distance for run in runs]
    if not totals or any(0.5 * total <= whole <= 2.0 * total for total in totals):
        return []
    lengths = ", ".join(dict.fromkeys(f"{total:.4g}" for total in totals))
    text = f"the {'run' if len(runs) == 1 else 'runs'} {lengths} mm"
    if experiment.cycles is not None:  # the whole is not known: a point stands for a cycle
        return [f"The middle of its last cycle is at {whole:.4g} mm, {text} long."]
    return [f"It is {whole:.4g} mm long, {text}."]


def _gaps(experiment: Experiment, runs: Sequence[RunData]) -> list[str]:
    """Say what is to be said of its gaps, over the distance that it shares with any run."""
    known = [run.history["distance"] for run in runs if run.cof is not None]
    start = max(min((float(d[0]) for d in known), default=0.0), float(experiment.distance[0]))
    end = min(max((float(d[-1]) for d in known), default=0.0), float(experiment.distance[-1]))
    return check_coverage(experiment, start, end) if end > start else []


def _differences(groups: Sequence[Group]) -> Iterator[str]:
    """List conditions in which groups differ: they are then unlike tests."""
    conditions = {group.name: [_conditions_of(run.study) for run in group.runs] for group in groups}
    for what in dict.fromkeys(what for runs in conditions.values() for run in runs for what in run):
        every = {name: dict.fromkeys(r[what] for r in runs if what in r) for name, runs in conditions.items()}
        texts = {name: ", ".join(values) for name, values in every.items() if values}
        if len(set(texts.values())) > 1:
            named = [f"{name} {text}".rstrip() for name, text in texts.items()]
            each_once = named if len(named) <= MOST_NAMES else list(dict.fromkeys(texts.values()))
            yield f"Unlike tests: the runs differ in {what} ({', '.join(each_once)})."
