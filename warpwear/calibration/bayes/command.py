"""What `warpwear calibrate bayes` does: from its options, or a study's section [infer], to the text."""

import logging
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import click

from warpwear.batches.batch import LOG
from warpwear.calibration.bayes.data import data_of
from warpwear.calibration.bayes.infer import ROUGHNESS, infer
from warpwear.calibration.bayes.result import CALIBRATED, FITTED, content_of
from warpwear.calibration.bayes.runs import cost_of
from warpwear.calibration.bayes.unknowns import unknowns_of
from warpwear.calibration.measurements import in_file
from warpwear.errors import InputError
from warpwear.results.report import to_json
from warpwear.study.keys import Section, dotted, key
from warpwear.study.study import Study
from warpwear.study.text import read_section


class InferSection(Section):
    """The section [infer] of a study has what the command is else told by its options."""

    unknown: dict[str, str] = key(
        {}, 'unknown keys and their priors, `""` for one within a factor of 5 of the study\'s value'
    )
    target: str | None = key(None, "the unknown that the next test shall tell")
    next: list[str] = key(
        [], 'tests to rank, such as `"contact.load=16 N, repeats=3"`; without them likely ones'
    )


def calibrate_bayes(
    study: str,
    changes: Mapping[str, Any],
    *,
    unknown: Sequence[str],
    experiments: Sequence[Path],
    measured: Mapping[str, Sequence[str]],
    columns: str | None,
    as_json: bool,
    target: str | None,
    candidates: Sequence[str],
    out: Path | None,
    **options: Any,
) -> str:
    """Infer from the command line; return what is printed. options: dry_run, and others of `infer`.

    Raises InputError.
    """
    sections, tests = in_file(study)
    said = sections.pop("infer", {})
    if isinstance(said, Mapping) and isinstance(said.get("unknown"), Mapping):
        said = {**said, "unknown": dotted(said["unknown"])}  # unquoted dots make tables in tables
    section = read_section("infer", InferSection, said)
    changed = Study(**sections).replace(changes)
    priors = {**{name: prior or None for name, prior in section.unknown.items()}, **_unknown(unknown)}
    if isinstance(tests, list):
        tests = [*tests, *({kind: text} for kind, texts in measured.items() for text in texts)]
        tests += [{"record": path} for path in experiments]
    data = data_of(changed, tests, columns=columns)
    if options.pop("dry_run", False):
        roughness = bool(data.kinds & ROUGHNESS)
        how = {name: options[name] for name in ("seed", "device")}
        unknowns = unknowns_of(changed, priors)
        return cost_of(changed, unknowns, samples=options["runs"], roughness=roughness, **how)
    options |= {"target": target or section.target, "candidates": candidates or section.next, "out": out}
    if options["candidates"] and options["target"] is None:
        raise InputError("--next needs --target, the unknown that the next test shall tell")
    with telling(options["out"]):
        inference = infer(changed, unknown=priors, tests=data, **options)
    if as_json:
        return to_json(content_of(inference))
    study = FITTED if inference.misses else CALIBRATED
    written = f"\nwritten to {out}/: inference.html, {study}, posterior.csv, figures/"
    return str(inference) + (written if out else "")


@contextmanager
def telling(out: Path | None) -> Iterator[None]:
    """Show each run that is done with the time left, and say after an interrupt what goes on from there."""
    handler, level = logging.StreamHandler(), LOG.level
    LOG.addHandler(handler)
    LOG.setLevel(logging.INFO)
    try:
        yield
    except KeyboardInterrupt:
        if out is not None:
            click.echo("the same command goes on from here", err=True)
        raise
    finally:
        LOG.removeHandler(handler)
        LOG.setLevel(level)


def _unknown(texts: Sequence[str]) -> dict[str, str | None]:
    """Read KEY or KEY=PRIOR."""
    priors: dict[str, str | None] = {}
    for text in texts:
        name, equals, prior = (part.strip() for part in text.partition("="))
        if not name or (equals and not prior):
            raise InputError(f"--unknown {text!r}: KEY or KEY=PRIOR is expected, a prior as in a sweep")
        priors[name] = prior or None
    return priors
