"""From what was measured to the unknowns of a study, with their uncertainty: `warpwear.infer`."""

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from warpwear.batches.batch import RUNS, check_folder
from warpwear.calibration.bayes import next_test
from warpwear.calibration.bayes.data import Data, data_of, unit_of
from warpwear.calibration.bayes.identify import conflicts_of, identify
from warpwear.calibration.bayes.likelihood import Posterior
from warpwear.calibration.bayes.model import ForwardModel, columns_for
from warpwear.calibration.bayes.result import SAMPLES_FILE, Inference, write_report, write_samples
from warpwear.calibration.bayes.runs import make_runs, wide_enough
from warpwear.calibration.bayes.sampler import sample
from warpwear.calibration.bayes.unknowns import Unknown, noise_for, unknowns_of
from warpwear.calibration.measurements import Tests
from warpwear.errors import InputError
from warpwear.grid import FloatArray
from warpwear.laws.friction import FITTED, STRENGTH
from warpwear.study.study import Study
from warpwear.study.units import several

#: Draws of the priors that are compared with the data.
DRAWS = 2000
#: Standard uncertainties by which all priors have to miss a value to exclude it.
FAR = 4.0
#: Coefficient of friction by which all priors have to miss a course to exclude it.
COF_FAR = 0.3
#: What is measured of surfaces in the scar, for which runs keep it.
ROUGHNESS = frozenset(("sq_counter", "sq_disc"))


def infer(
    study: Study | str | Path,
    *,
    unknown: Mapping[str, str | None] | Sequence[str],
    tests: Tests | Data,
    target: str | None = None,
    candidates: Sequence[str] = (),
    out: str | Path | None = None,
    runs: int | None = None,
    seed: int = 0,
    device: str = "cpu",
) -> Inference:
    """Find unknowns of a study from measurements of a test, by Bayes' rule.

    Parameters
    ----------
    study : Study, path or str
        The test: a study, its file, or the name of a preset.
    unknown : dict, or list of str
        Keys, each with a prior as in a sweep; None, and any key in a list, means a prior within a factor of 5
        of the study's value.
    tests : list of dict, or path
        One a test, such as ``{"scar": "0.8 +- 0.02 mm", "friction": "0.2 +- 0.02 at 30 mm", "record":
        "test-1.csv"}``, or a TOML file with them; repeated tests have one each. The keys are those of
        ``[[test]]``, which docs/reference/keys.md explains: scar, volume_counter, volume_disc, width,
        section, sq_counter, sq_disc, friction, record, profile, after, before and ball.
    target : str, optional
        An unknown that the next test is to narrow.
    candidates : list of str, optional
        Tests to rank for it, such as ``"contact.load=16 N, repeats=3"``; without them likely ones.
    out : path, optional
        Folder of the report, which keeps the runs.
    runs : int, optional
        Of a design, where results do not merely scale.
    seed : int
        Of all draws.
    device : str
        ``"cpu"`` or ``"cuda:0"``.

    Returns
    -------
    Inference
        Samples of the unknowns, their table, what cannot be told apart, and the tests ranked; `print` shows
        it.

    Raises
    ------
    InputError
        For what does not go together, such as priors that exclude what was measured.
    ConvergenceError
        Where samples do not converge.

    References
    ----------
    A. Gelman and others, Bayesian Data Analysis, third edition, 2013.

    Examples
    --------
    >>> study = warpwear.Study.load("v3-fine").replace({"grid.cell": "20 um"})
    >>> tests = [{"volume_disc": "0.004 +- 0.0004 mm^3"}]
    >>> found = warpwear.infer(study, unknown=["wear.disc"], tests=tests)
    >>> [row["key"] for row in found.table], found.misses
    (['wear.disc'], False)
    """
    study = study if isinstance(study, Study) else Study.load(study)
    study._refuse_blocks("warpwear calibrate bayes")
    if study.pair.wears_by_area:
        raise InputError("warpwear calibrate bayes needs friction.law = 'coulomb' for wear.law = 'energy'")
    data = tests if isinstance(tests, Data) else data_of(study, tests)
    priors = dict(unknown) if isinstance(unknown, Mapping) else dict.fromkeys(several(unknown))
    unknowns, noise = unknowns_of(study, priors), noise_for(data, priors)
    _check_unknowns(study, unknowns, data)
    with tempfile.TemporaryDirectory(prefix="warpwear-inference-", ignore_cleanup_errors=True) as place:
        folder = Path(place if out is None else out)
        if out is not None:
            check_folder(folder, resume=True)
            (folder / RUNS).mkdir(parents=True, exist_ok=True)

        def model_of(other: Study, part: float | None = None) -> ForwardModel:
            how: Any = {"samples": runs, "seed": seed, "out": folder, "device": device, "part": part}
            rough = bool(data.kinds & ROUGHNESS)
            of_other = make_runs(other, unknowns, roughness=rough, **how)
            return ForwardModel(other, tuple(unknowns), of_other, frozenset(data.kinds))

        def with_model(candidate: next_test.Candidate) -> next_test.Candidate:
            part = base.runs.part if study.wear.law in ("archard", "energy") else 1.0
            other = wide_enough(study, candidate.changes, unknowns, part, folder, device)
            if other == study:
                return candidate
            extent = other.grid.sides[0] if other.grid.sides > study.grid.sides else None
            return replace(candidate, model=model_of(other, part), extent=extent)

        base = model_of(study)
        posterior = Posterior(base, tuple(noise), data)
        check_priors(posterior, seed=seed)
        trials = []
        if target is not None:  # before sampling, which takes long: here a test may be refused
            next_test.place_of(posterior, target)
            named = next_test.candidates_of(study, several(candidates), cheap=not base.runs.inputs)
            trials = [with_model(one) for one in named]
        samples = sample(posterior.log_density, len(posterior.sampled), seed=seed)
        values, z = posterior.complete(samples.z, np.random.default_rng(seed + 1))
        if out is not None:
            write_samples(posterior.unknowns, values, folder / SAMPLES_FILE)
        ranked = [] if target is None else next_test.best_tests(posterior, values, target, trials)
        wear = [u.key for u in unknowns if u.key in ("wear.counter", "wear.disc")]
        inference = Inference(
            posterior=posterior,
            samples=samples,
            values=values,
            z=z,
            identified=identify(posterior, values, z),
            conflicts=tuple(conflicts_of(posterior, values)),
            target=target,
            tests=tuple(ranked),
            repeats={key: next_test.repeats_needed(posterior, values, key) for key in wear},
            seed=seed,
        )
        if out is not None:
            write_report(inference, folder)
    return inference


def check_priors(posterior: Posterior, *, seed: int) -> None:
    """Raise InputError where a measured value is far from all that the priors allow."""
    z = np.random.default_rng(seed).standard_normal((len(posterior.unknowns), DRAWS))
    values = {unknown.key: unknown.values(row) for unknown, row in zip(posterior.unknowns, z, strict=True)}
    allowed = posterior.model.allowed(values)
    if not allowed.any():
        raise InputError("the priors leave scars beyond the field: a larger grid.extent is needed")
    values = {key: column[allowed] for key, column in values.items()}
    for measured in posterior.data.values:
        mean, variance = posterior.model.value(values, measured.kind)
        room = FAR * np.sqrt(measured.error**2 + float(variance.max()))
        _within(measured.text, measured.value, mean, float(room), measured.kind)
    if posterior.data.distance.size:
        cof = posterior.model.cof(values, posterior.data.distance)
        for course, rows in zip(posterior.data.courses, posterior.data.rows, strict=True):
            level = float(course.cof.mean())
            text = f"{course.name}: mean coefficient of friction {level:.3g}"
            _within(text, level, cof[:, rows].mean(axis=1), COF_FAR, "friction")
        for point, column in zip(reversed(posterior.data.points), reversed(cof.T), strict=False):
            _within(point.text, point.value, column, FAR * point.error, "friction")


def _within(what: str, value: float, computed: FloatArray, room: float, kind: str) -> None:
    """Raise InputError for a measured value that is farther than `room` from all computed ones."""
    low, high = float(computed.min()), float(computed.max())
    if not low - room <= value <= high + room:
        unit = f" {unit_of(kind)}".rstrip()
        raise InputError(
            f"the priors exclude the data: over all of them the study computes {low:.3g} to {high:.3g}{unit}"
            f", and measured is {what}; wider or other priors are needed"
        )


def _check_unknowns(study: Study, unknowns: Sequence[Unknown], data: Data) -> None:
    """Raise InputError for unknowns that the study does not use, and for friction that cannot be inferred."""
    unused = study.unused_keys
    for unknown in unknowns:
        if unknown.key.removeprefix("friction.") in FITTED and study.friction.law == "shear-strength":
            raise InputError(
                f"{unknown.key} cannot be an unknown: it is measured, and fixes friction.shear_strength; "
                "allowed is that key, with the coefficient as a measured value (--cof)"
            )
        if unknown.key in unused:
            raise InputError(
                f"{unknown.key} cannot be an unknown: it {unused[unknown.key]}; allowed are keys that the "
                "study uses"
            )
    medians = {unknown.key: float(unknown.values(np.zeros(1))[0]) for unknown in unknowns}
    study.replace({u.key: u.text(medians[u.key]) for u in unknowns if u.key.startswith("friction.")})
    law = study.friction.law_with(medians)
    if data.distance.size and STRENGTH in law.strengths and law.values[STRENGTH] is None:
        raise InputError(
            "friction.shear_strength is neither given nor unknown: the study calibrates it to "
            "friction.coefficient; give it as an unknown with a prior, such as "
            "'friction.shear_strength=log-uniform 1 .. 100 MPa'"
        )
    if data.distance.size and study.contact_task.shears_unalike:
        raise InputError(
            "friction cannot be inferred of layers with a shear_strength or coefficient of their own, "
            "nor with friction.largest_coefficient: allowed are measured volumes, diameters and roughness"
        )
    columns = columns_for(law, 1.0, np.ones(1), np.ones(1))
    for factor in law.factors:
        if beyond := set(factor.columns) - set(columns):
            raise InputError(
                f"{' and '.join(f'friction.{key}' for key in factor.keys)} cannot be inferred with: the "
                f"strength follows {', '.join(sorted(beyond))} of a run; allowed are {', '.join(columns)}"
            )
