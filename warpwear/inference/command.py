"""What `warpwear calibrate bayes` does: from its options, or a study's section [infer], to the text it
prints.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from warpwear.errors import InputError
from warpwear.inference.data import KINDS, data_of
from warpwear.inference.infer import infer_from
from warpwear.inference.report import content_of
from warpwear.results.report import to_json
from warpwear.study import loading
from warpwear.study.study import Study

#: Section of a study file, and what may stand in it.
SECTION = "infer"
ENTRIES = ("unknown", "measured", "experiments", "target", "next")


def calibrate_bayes(
    study: str,
    changes: Mapping[str, Any],
    *,
    unknown: Sequence[str],
    experiments: Sequence[Path],
    measured: Mapping[str, Sequence[str]],
    columns: str | None,
    as_json: bool,
    **how: Any,
) -> str:
    """Infer from the command line; return what is printed. how: target, candidates, out, runs, seed, device.

    Raises InputError.
    """
    sections = loading.read_sections(study)
    given = _section(sections.pop(SECTION, {}))
    made = Study(**sections).replace(changes)
    asked = {**given["unknown"], **_unknown(unknown)}
    values = {**given["measured"], **{kind: texts for kind, texts in measured.items() if texts}}
    beside = Path(study).parent
    courses = [*(beside / path for path in given["experiments"]), *experiments]
    data = data_of(made, courses, values, columns=columns)
    how["target"] = how["target"] or given["target"]
    how["candidates"] = how["candidates"] or given["next"]
    if how["candidates"] and how["target"] is None:
        raise InputError("--next needs --target, the unknown that the next test shall tell")
    found = infer_from(made, asked, data, **how)
    if as_json:
        return to_json(content_of(found))
    return str(found) + (
        f"\nwritten to {how['out']}/: inference.html, calibrated.toml, posterior.csv, figures/"
        if how["out"]
        else ""
    )


def _unknown(texts: Sequence[str]) -> dict[str, str | None]:
    """Read KEY or KEY=PRIOR."""
    found: dict[str, str | None] = {}
    for text in texts:
        key, equals, prior = (part.strip() for part in text.partition("="))
        if not key or (equals and not prior):
            raise InputError(
                f"--unknown {text!r}: KEY or KEY=PRIOR is expected, such as 'wear.sphere=log-uniform 1e-4 "
                ".. 1e-3 mm^3/N/m'"
            )
        found[key] = prior or None
    return found


def _section(given: Any) -> dict[str, Any]:
    """Check the section [infer] of a study. Raises InputError."""
    found: dict[str, Any] = {"unknown": {}, "measured": {}, "experiments": [], "target": None, "next": []}
    if not isinstance(given, Mapping):
        raise InputError("[infer] is a section: [infer.unknown] names keys with their priors")
    for name, value in given.items():
        if name not in ENTRIES:
            raise InputError(f"infer.{name} is not known; allowed: {', '.join(ENTRIES)}")
        found[name] = value
    if not isinstance(found["unknown"], Mapping) or not isinstance(found["measured"], Mapping):
        raise InputError(
            '[infer.unknown] and [infer.measured] are sections: "wear.sphere" = "log-uniform …", diameter '
            '= "0.80 +- 0.02 mm"'
        )
    found["unknown"] = {key: prior or None for key, prior in _flat(found["unknown"]).items()}
    for kind in found["measured"]:
        if kind not in KINDS:
            raise InputError(
                f"infer.measured.{kind} is nothing that can be measured here; allowed: {', '.join(KINDS)}"
            )
    return found


def _flat(nested: Mapping[str, Any], prefix: str = "") -> dict[str, str]:
    """Dotted keys of tables in tables, as TOML makes of unquoted dots."""
    found: dict[str, str] = {}
    for key, value in nested.items():
        if isinstance(value, Mapping):
            found |= _flat(value, f"{prefix}{key}.")
        elif isinstance(value, str):
            found[prefix + key] = value
        else:
            raise InputError(
                f"infer.unknown.{prefix}{key} = {value!r}: a prior such as 'normal 8 +- 1 N' is expected, "
                "or '' for one about the value"
            )
    return found
