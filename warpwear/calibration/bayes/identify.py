"""Which unknowns the data tell, which they cannot tell apart, and what a study misses, in words.

The Fisher information of the data at places of the posterior, in the standard normal numbers of the unknowns,
says it: a direction with an eigenvalue below one is known from the prior alone. Unknowns that such directions
move together cannot be told apart; what is known is the direction across.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.calibration.bayes.data import MeasuredCourse
from warpwear.calibration.bayes.likelihood import Posterior
from warpwear.calibration.bayes.sampler import spread_of
from warpwear.calibration.friction import OTHER_SHAPE, together
from warpwear.calibration.measurements import KINDS
from warpwear.ensembles.datum import CONTRADICTION
from warpwear.figures.wording import listed
from warpwear.grid import FloatArray
from warpwear.results.formats.forms import filled

csgraph = lazy.module("scipy.sparse.csgraph")

#: Standard uncertainty of a measured coefficient of friction as a part of it, at least.
COF_ERROR = 0.02
#: Start of a sentence on measurements that the study misses.
CONFLICT = "The study cannot bring all data together"
#: What is compared of a course of friction -> its weights of the means over the thirds of the distance.
LEVEL = "friction over the last third"
PARTS = {
    LEVEL: (0.0, 0.0, 1.0),
    "its rise from the first third": (-1.0, 0.0, 1.0),
    "its shape, the middle third above the mean of the others": (-0.5, 1.0, -0.5),
}
#: Draws of the posterior predictive.
DRAWS = 400
#: Places of the posterior that are looked at.
PLACES = 24
#: Step of derivatives, in standard deviations of the prior.
STEP = 1e-3
#: Information, in that of the prior, below which the prior tells more than the data.
NOTHING = 1.0
#: Least part of an unknown, squared, in directions of the prior from which they move it, and own it.
MOVED, OWNED = 0.06, 0.5
#: Information below which a single unknown is left as it was.
UNTOUCHED = 0.1
#: What is said where nothing else is.
ALL_APART = "The data tell all unknowns apart."
#: Correlation of two unknowns that is told.
STRONG = 0.8


@dataclass(frozen=True)
class Indistinct:
    """Unknowns that the data cannot tell apart. known: in words, what they tell instead; why: by theory."""

    keys: tuple[str, ...]
    known: str
    why: str = ""


@dataclass(frozen=True, eq=False)
class Identified:
    """What the data tell. indistinct: groups of unknowns; untouched, hardly: of which they say too little."""

    indistinct: tuple[Indistinct, ...]
    untouched: tuple[str, ...]
    hardly: tuple[str, ...]
    correlations: tuple[tuple[str, str, float], ...]

    @property
    def sentences(self) -> list[str]:
        """Say all of it."""
        text = filled("identified.txt", escape=False, told=self, listed=listed)
        return text.splitlines() or [ALL_APART]


def information(posterior: Posterior, values: dict[str, FloatArray]) -> FloatArray:
    """Return the Fisher information of the model's unknowns, (samples, unknowns, unknowns).

    values: key -> (samples,). The information is in the standard normal numbers of the unknowns, so that the
    prior's is the identity.
    """
    model, data = posterior.model, posterior.data
    slopes: list[FloatArray] = []
    errors = _errors(posterior, values)
    for unknown in model.unknowns:
        ends = []
        for sign in (-1.0, 1.0):
            moved = dict(values)
            moved[unknown.key] = unknown.values(unknown.normal(values[unknown.key]) + sign * STEP)
            columns = [model.value(moved, measured.kind)[0][:, None] for measured in data.values]
            if data.distance.size:
                columns.append(model.cof(moved, data.distance))
            ends.append(np.concatenate(columns, axis=1))
        slopes.append((ends[1] - ends[0]) / (2.0 * STEP))
    by_unknown = np.stack(slopes, axis=1)  # (samples, unknowns, measured)
    count = len(data.values)
    scaled = by_unknown[..., :count] / errors[:, None, :]
    fisher = scaled @ scaled.transpose(0, 2, 1)
    if data.distance.size:
        fisher = fisher + _of_courses(posterior, values, by_unknown[..., count:])
    return np.asarray(fisher)


def some_of(values: Mapping[str, FloatArray], number: int) -> dict[str, FloatArray]:
    """Return a number of many samples, evenly apart."""
    chosen = np.linspace(0, len(next(iter(values.values()))) - 1, number).astype(np.intp)
    return {key: column[chosen] for key, column in values.items()}


def _errors(posterior: Posterior, values: dict[str, FloatArray]) -> FloatArray:
    """Return standard deviations of the measured values about computed ones, (samples, values)."""
    errors = np.zeros((len(next(iter(values.values()))), len(posterior.data.values)))
    for place, measured in enumerate(posterior.data.values):
        errors[:, place] = np.sqrt(posterior.model.value(values, measured.kind)[1] + measured.error**2)
    return errors


def _of_courses(posterior: Posterior, values: dict[str, FloatArray], slopes: FloatArray) -> FloatArray:
    """Return the information of courses and coefficients. slopes: (samples, unknowns, points)."""
    white, shared = posterior.whiten(values, slopes)
    plain = white @ white.transpose(0, 2, 1)
    if not shared.shape[1]:
        return np.asarray(plain)
    inner = np.eye(shared.shape[1]) + shared @ shared.transpose(0, 2, 1)
    across = shared @ white.transpose(0, 2, 1)
    return np.asarray(plain - across.transpose(0, 2, 1) @ np.linalg.solve(inner, across))


def identify(posterior: Posterior, values: dict[str, FloatArray], z: FloatArray) -> Identified:
    """Find what the data tell, from samples of all unknowns: key -> (samples,), and z (samples, unknowns)."""
    keys = [unknown.key for unknown in posterior.model.unknowns]
    fisher = information(posterior, some_of(values, PLACES))
    typical = np.median(np.diagonal(fisher, axis1=1, axis2=2), axis=0)
    touched = typical >= UNTOUCHED
    sizes, vectors = np.linalg.eigh(fisher)
    prior = vectors * (sizes < NOTHING)[:, None]
    moved = np.median(np.abs(prior @ prior.transpose(0, 2, 1)), axis=0) * np.outer(touched, touched)
    if touched.all() and np.median(sizes[:, 0]) < NOTHING and moved.max() < MOVED:
        moved[:] = 1.0  # many unknowns, each a little
    both = (moved > MOVED) & np.outer(*2 * [np.diagonal(moved) > MOVED])
    _, labels = csgraph.connected_components(both, directed=False)
    groups = [tuple(keys[n] for n in np.flatnonzero(labels == label)) for label in dict.fromkeys(labels)]
    indistinct = [
        Indistinct(group, _known(posterior, group, values), _why(posterior, group))
        for group in groups
        if len(group) > 1
    ]
    untouched = tuple(key for key, is_touched in zip(keys, touched, strict=True) if not is_touched)
    alone = {group[0] for group in groups if len(group) == 1}
    owned = zip(keys, np.diagonal(moved) > OWNED, strict=True)
    hardly = tuple(key for key, is_owned in owned if is_owned and key in alone)
    count = len(keys)
    together = np.atleast_2d(np.corrcoef(z[:, :count].T))
    pairs = np.argwhere(np.tril(np.abs(together) > STRONG, -1))
    strong = ((keys[i], keys[j], float(together[i, j])) for i, j in pairs)
    told = tuple(two for two in strong if not any({*two[:2]} <= {*group.keys} for group in indistinct))
    return Identified(tuple(indistinct), untouched, hardly, told)


def _known(posterior: Posterior, group: tuple[str, ...], values: dict[str, FloatArray]) -> str:
    """Say which combination of unknowns is known: their sum, or a product of powers."""
    columns = [values[key] for key in group]
    if set(group) == {"wear.counter", "wear.disc"} and posterior.model.runs.scaled:
        total = np.sum(columns, axis=0)
        middle, half, _ = spread_of(total)
        return f"the sum {' + '.join(group)}, {middle:.3g} ± {half:.2g} mm³/(N·m)"
    if min(float(column.min()) for column in columns) <= 0.0 or "friction.ploughing" in group:
        return "a combination of them"
    powers = _powers(columns)
    total = sum(power * np.log(column) for power, column in zip(powers, columns, strict=True))
    written = " · ".join(
        key if abs(p - 1.0) < 0.005 else f"{key}^{p:.2g}" for key, p in zip(group, powers, strict=True)
    )
    return f"the product {written}, to ± {100.0 * spread_of(total)[1]:.2g} %"


def _powers(columns: list[FloatArray]) -> FloatArray:
    """Return powers of positive unknowns, the largest 1, whose product scatters least."""
    logs = np.log(np.array(columns))
    spread = logs.std(axis=1)
    _, vectors = np.linalg.eigh(np.corrcoef(logs))
    powers = vectors[:, 0] / spread
    return np.asarray(powers / powers[np.argmax(np.abs(powers))])


def _why(posterior: Posterior, group: tuple[str, ...]) -> str:
    """Name why theory expects it, of identified.txt; empty where it does not."""
    if set(group) == {"wear.counter", "wear.disc"} and posterior.model.runs.scaled:
        return "wear"
    if any(key.endswith("shear_strength") for key in group):
        return "ploughing" if "friction.ploughing" in group else "strength"
    return ""


def computed(posterior: Posterior, values: Mapping[str, FloatArray]) -> list[dict[str, Any]]:
    """Return a row a measured value; see `Inference.computed`."""
    rows = []
    for measured in (*posterior.data.values, *posterior.data.points):
        if measured.kind == "friction":
            mean = posterior.model.cof(values, np.array([measured.at]))[:, 0]
            errors = posterior.model.friction(values, np.array([measured.at])).errors
            variance = (errors[..., 0] ** 2).sum(axis=1)
        else:
            mean, variance = posterior.model.value(values, measured.kind)
        off = abs(float(mean.mean()) - measured.value) / float(np.sqrt(measured.error**2 + variance.mean()))
        numbers = {"mean": float(mean.mean()), "sd": math.hypot(spread_of(mean)[1], variance.mean() ** 0.5)}
        numbers["off"] = off
        given = {"measured": measured.value, "error": measured.error, "fitted": True}
        rows.append({"what": measured.text, **numbers, "unit": measured.unit, **given})
    return rows + _friction_rows(posterior, values)


def _friction_rows(posterior: Posterior, values: Mapping[str, FloatArray]) -> list[dict[str, Any]]:
    """Return level, rise and shape of every measured course beside the computed ones, a row each.

    They are combinations of the means over the thirds of its distance. Their uncertainty is that of the noise
    that was fitted, and of a level at least that of a tribometer, or of repeats among each other.
    """
    rows, some = [], some_of(values, PLACES)
    for course in posterior.data.courses:
        if not course.thirds:
            continue
        friction = posterior.model.friction(values, course.distance)
        cof = posterior.model.cof(values, course.distance)
        kinds = {"measured": course.cof[None], "computed": cof, "errors": friction.errors}
        means = {
            name: np.stack([lines[..., third].mean(axis=-1) for third in course.thirds], axis=-1)
            for name, lines in kinds.items()
        }
        level, noise = float(means["measured"][0, -1]), _noise_of(course, some)
        for what, weights in PARTS.items():
            measured, computed, emulated = (means[name] @ np.array(weights) for name in kinds)
            error = np.sqrt(weights @ noise @ weights + (COF_ERROR * level) ** 2 * np.dot(weights, weights))
            error = float(np.hypot(error, posterior.data.between)) if what == LEVEL else error
            variance = float(np.mean(np.sum(emulated**2, axis=-1)))
            deviation = math.hypot(spread_of(computed)[1], variance**0.5)
            value, mean = float(measured[0]), float(computed.mean())
            off = abs(mean - value) / float(np.hypot(error, np.sqrt(variance)))
            row = {"what": f"{course.name}: {what} {value:.3g} ± {error:.2g}", "mean": mean, "sd": deviation}
            given = {"measured": value, "error": error, "fitted": True}
            rows.append(row | {"off": off, "unit": ""} | given)
    return rows


def _noise_of(course: MeasuredCourse, values: Mapping[str, FloatArray]) -> FloatArray:
    """Return the covariance of means over thirds of a course by the noise that was fitted, (3, 3)."""
    deviation, length = (values[f"noise.{name}"][:, None, None] for name in ("deviation", "length"))
    covariance = np.mean(deviation**2 * together(course.distance, length), axis=0)
    return np.array([[covariance[a, b].mean() for b in course.thirds] for a in course.thirds])


def conflicts_of(posterior: Posterior, values: Mapping[str, FloatArray]) -> list[str]:
    """Say what the study cannot bring together, in sentences."""
    some = {key: column[:DRAWS] for key, column in values.items()}
    rows, values_of = computed(posterior, some), (*posterior.data.values, *posterior.data.points)
    each = zip(rows, [value.kind for value in values_of] + [""] * len(rows), strict=False)
    bad = sorted((pair for pair in each if pair[0]["off"] > CONTRADICTION), key=lambda pair: -pair[0]["off"])
    longest = max((float(course.distance[-1]) for course in posterior.data.courses), default=0.0)
    length = float(np.median(some["noise.length"])) if longest else 0.0
    said: dict[str, Any] = {"length": length, "longest": longest, "part": OTHER_SHAPE}
    text = filled(
        "conflicts.txt", escape=False, conflict=CONFLICT, rows=bad, scar=_scar_by_volume(posterior), **said
    )
    return [*dict.fromkeys(text.splitlines())]


def _scar_by_volume(posterior: Posterior) -> dict[str, Any] | None:
    """Return which scar the measured volumes make at rest, where a scar was measured, too."""
    values, model = posterior.data.values, posterior.model
    scars = [value for value in values if value.kind == "scar"]
    bodies = {value.kind: value for value in values if value.kind.startswith("volume")}
    if not (scars and bodies and model.runs.scaled) or model.runs.inputs:
        return None
    volume = sum(value.value for value in bodies.values())
    which = " and ".join(KINDS[kind][1] for kind in bodies)
    return {"bodies": which, "volume": volume, "size": model.scar_of(volume), "measured": scars[0].value}
