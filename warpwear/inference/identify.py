"""Which unknowns the data tell, and which they cannot tell apart, in words.

The Fisher information of the data at places of the posterior, in the standard normal numbers of the unknowns,
says it: a direction with an eigenvalue below one is known from the prior alone. Where such a direction moves
several unknowns each of which the data would tell if the others were known, these cannot be told apart; what
is known is the direction across.
"""

from collections import Counter
from dataclasses import dataclass

import numpy as np

from warpwear.grid import FloatArray
from warpwear.inference.likelihood import Posterior

#: Places of the posterior that are looked at.
PLACES = 24
#: Step of derivatives, in standard deviations of the prior.
STEP = 1e-3
#: Information, in that of the prior, below which data teach nothing, and above which they would tell an
#: unknown.
NOTHING, MUCH = 1.0, 4.0
#: Least part in a direction that counts.
PART = 0.25
#: Information below which a single unknown is left as it was.
UNTOUCHED = 0.1
#: Correlation of two unknowns that is told.
STRONG = 0.8


@dataclass(frozen=True)
class Indistinct:
    """Unknowns that the data cannot tell apart. known: in words, what they tell instead."""

    keys: tuple[str, ...]
    known: str
    why: str = ""

    def __str__(self) -> str:
        """Say so in a sentence."""
        names = f"{', '.join(self.keys[:-1])} and {self.keys[-1]}"
        return f"{names} cannot be told apart by these data: they tell only {self.known}. {self.why}".rstrip()


@dataclass(frozen=True, eq=False)
class Identified:
    """What the data tell. indistinct: groups of unknowns; untouched: those that it says nothing of."""

    indistinct: tuple[Indistinct, ...]
    untouched: tuple[str, ...]
    correlations: tuple[tuple[str, str, float], ...]

    @property
    def sentences(self) -> list[str]:
        """Say all of it."""
        lines = [str(group) for group in self.indistinct]
        lines += [f"These data say nothing of {key}: it stays as its prior has it." for key in self.untouched]
        lines += [
            f"{first} goes {'with' if r > 0.0 else 'against'} {second} (correlation {r:.2f}): knowing one "
            "better makes the other better known."
            for first, second, r in self.correlations
            if not any({first, second} <= set(group.keys) for group in self.indistinct)
        ]
        return lines or ["The data tell all unknowns apart."]


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
    unknowns = posterior.model.unknowns
    keys = [unknown.key for unknown in unknowns]
    chosen = np.linspace(0, len(z) - 1, PLACES).astype(np.intp)
    fisher = information(posterior, {key: value[chosen] for key, value in values.items()})
    groups: Counter[tuple[str, ...]] = Counter()
    for one in fisher:
        sizes, vectors = np.linalg.eigh(one)
        for vector in vectors.T[sizes < NOTHING]:
            moved = [n for n in range(len(keys)) if abs(vector[n]) > PART and one[n, n] > MUCH]
            if len(moved) > 1:
                groups[tuple(keys[n] for n in moved)] += 1
    indistinct = []
    taken: set[str] = set()
    for group, count in groups.most_common():
        if count > PLACES // 2 and not taken & set(group):
            taken |= set(group)
            indistinct.append(Indistinct(group, _known(posterior, group, values), _why(posterior, group)))
    typical = np.median(np.diagonal(fisher, axis1=1, axis2=2), axis=0)
    untouched = tuple(key for key, size in zip(keys, typical, strict=True) if size < UNTOUCHED)
    count = len(keys)
    together = np.atleast_2d(np.corrcoef(z[:, :count].T))
    strong = tuple(
        (keys[i], keys[j], float(together[i, j]))
        for i in range(count)
        for j in range(i)
        if abs(together[i, j]) > STRONG
    )
    return Identified(tuple(indistinct), untouched, strong)


def _known(posterior: Posterior, group: tuple[str, ...], values: dict[str, FloatArray]) -> str:
    """Say which combination of unknowns is known: their sum, or a product of powers."""
    columns = [values[key] for key in group]
    if set(group) == {"wear.sphere", "wear.disc"} and posterior.model.runs.scaled:
        total = np.sum(columns, axis=0)
        return f"the sum {' + '.join(group)}, {total.mean():.3g} ± {total.std():.2g} mm³/(N·m)"
    if min(float(column.min()) for column in columns) <= 0.0 or "friction.ploughing" in group:
        return "a combination of them"
    powers = _powers(columns)
    total = sum(power * np.log(column) for power, column in zip(powers, columns, strict=True))
    written = " · ".join(
        key if abs(p - 1.0) < 0.005 else f"{key}^{p:.2g}" for key, p in zip(group, powers, strict=True)
    )
    return f"the product {written}, to ± {100.0 * float(np.std(total)):.2g} %"


def _powers(columns: list[FloatArray]) -> FloatArray:
    """Return powers of positive unknowns, the first 1, whose product scatters least."""
    logs = np.log(np.array(columns))
    spread = logs.std(axis=1)
    _, vectors = np.linalg.eigh(np.corrcoef(logs))
    powers = vectors[:, 0] / spread
    return np.asarray(powers / powers[0])


def _why(posterior: Posterior, group: tuple[str, ...]) -> str:
    """Say why theory expects it, and what would help."""
    wear = {"wear.sphere", "wear.disc"}
    if set(group) == wear and posterior.model.runs.scaled:
        return (
            "At rest, area and scar follow from the sum of both wears alone; a worn volume of one body, or "
            "the section of the groove, tells them apart."
        )
    strength = any(key.endswith("shear_strength") for key in group)
    if strength and "friction.ploughing" in group:
        return (
            "Friction is μ_p + τ0 A/F, and the area hardly changes over these data: friction from the first "
            "pass on tells them apart."
        )
    if strength and len(group) > 1:
        return (
            "Friction is the shear strength times the area: the higher the one, the lower the other. A scar "
            "or a worn volume tells how large the area is."
        )
    return ""
