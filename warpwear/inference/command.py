"""What `warpwear calibrate bayes` does: from its options, or a study's section [infer], to the text."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from warpwear.errors import InputError
from warpwear.inference.data import FORMER, KINDS, data_of
from warpwear.inference.infer import infer
from warpwear.inference.report import CALIBRATED, FITTED, content_of
from warpwear.results.ensemble import dotted
from warpwear.results.report import to_json
from warpwear.study import loading
from warpwear.study.study import Study
from warpwear.study.text import sentence

#: Section of a study file.
SECTION = "infer"


class InferSection(BaseModel):
    """The section [infer] of a study has what the command is else told by its options."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    unknown: dict[str, str] = Field(
        {},
        description='unknown keys and their priors, `""` for one within a factor of 5 of the study\'s value',
    )
    measured: dict[str, str | list[str]] = Field(
        {}, description="measured values, each with its standard uncertainty; a list has one a repeated test"
    )
    experiments: list[str] = Field(
        [], description="files of courses of friction, beside the study; one a repeated test"
    )
    target: str | None = Field(None, description="the unknown that the next test shall tell")
    next: list[str] = Field(
        [], description='tests to rank, such as `"contact.load=16 N, repeats=3"`; without them likely ones'
    )


class _Whole(BaseModel):
    """A study file as far as this command reads it: sentences then name keys as they stand there."""

    infer: InferSection


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
    """Infer from the command line; return what is printed. options: others of `infer`.

    Raises InputError.
    """
    sections = loading.read_sections(study)
    section = _section(sections.pop(SECTION, {}))
    changed = Study(**sections).replace(changes)
    priors = {**{key: prior or None for key, prior in section.unknown.items()}, **_unknown(unknown)}
    values = {**section.measured, **{kind: texts for kind, texts in measured.items() if texts}}
    courses = [*(Path(study).parent / path for path in section.experiments), *experiments]
    data = data_of(changed, courses, values, columns=columns)
    options |= {"target": target or section.target, "candidates": candidates or section.next, "out": out}
    if options["candidates"] and options["target"] is None:
        raise InputError("--next needs --target, the unknown that the next test shall tell")
    inference = infer(changed, unknown=priors, measured=data, **options)
    if as_json:
        return to_json(content_of(inference))
    study = FITTED if inference.misses else CALIBRATED
    written = f"\nwritten to {out}/: inference.html, {study}, posterior.csv, figures/"
    return str(inference) + (written if out else "")


def _unknown(texts: Sequence[str]) -> dict[str, str | None]:
    """Read KEY or KEY=PRIOR."""
    priors: dict[str, str | None] = {}
    for text in texts:
        key, equals, prior = (part.strip() for part in text.partition("="))
        if not key or (equals and not prior):
            raise InputError(
                f"--unknown {text!r}: KEY or KEY=PRIOR is expected, such as 'wear.counter=log-uniform 1e-4 "
                ".. 1e-3 mm^3/N/m'"
            )
        priors[key] = prior or None
    return priors


def _section(content: Any) -> InferSection:
    """Read the section [infer] of a study. Raises InputError with one sentence."""
    try:
        if isinstance(content, Mapping) and isinstance(content.get("unknown"), Mapping):
            priors = dotted(content["unknown"])  # unquoted dots make tables in tables of TOML
            for key, prior in priors.items():
                if not isinstance(prior, str):
                    raise InputError(
                        f"infer.unknown.{key} = {prior!r}: a prior such as 'normal 8 +- 1 N' is expected, "
                        "or '' for one about the value"
                    )
            content = {**content, "unknown": priors}
        section = _Whole.model_validate({SECTION: content}).infer
    except ValidationError as error:
        raise InputError(sentence(error, _Whole)) from error
    for kind in section.measured:
        if FORMER.get(kind, kind) not in KINDS:
            raise InputError(
                f"infer.measured.{kind} is nothing that can be measured here; allowed: {', '.join(KINDS)}"
            )
    return section
