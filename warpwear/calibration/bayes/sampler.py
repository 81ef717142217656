"""Samples of a posterior by emcee's ensembles, and whether they have converged: else they are no result."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpwear import lazy
from warpwear.errors import ConvergenceError, InputError
from warpwear.grid import FloatArray

emcee = lazy.module("emcee")

#: Ensembles that start apart, to be compared.
ENSEMBLES = 2
#: Fewest walkers of an ensemble, and walkers an unknown.
WALKERS, WALKERS_EACH = 64, 10
#: Draws from the prior among which walkers start.
DRAWS = 4000
#: Steps between two looks, and most steps of an ensemble.
BLOCK, MOST_STEPS = 100, 12_000
#: Part of the steps that is left out: until then walkers may still come from where they started.
BURN_IN = 0.3
#: Steps that are needed, in autocorrelation times, which are means over all walkers; and the largest
#: split-R̂.
TIMES, LARGEST_R = 50.0, 1.01
#: Samples that are kept.
KEPT = 4000
#: Percentiles one standard deviation from the middle of a normal distribution.
SIDES = (15.866, 84.134)
#: Ratio of a standard deviation and half of what lies between these from which they disagree.
DISAGREE = 1.25
#: Deviation as a part of a mean that is rounding.
ROUNDING = 1e-12
#: Two groups of samples: fewest at the peak of each, how many times fewer between them in a quarter of a
#: deviation, and quarters without any.
GROUP, FEWER, FAR = 10, 5, 8.0


@dataclass(frozen=True, eq=False)
class Samples:
    """Samples of standard normal numbers that follow a posterior, z (samples, unknowns), and how good.

    steps: of an ensemble; time: the longest autocorrelation time, in steps; r_hat: the largest split-R̂;
    effective: number of independent samples.
    """

    z: FloatArray
    steps: int
    time: float
    r_hat: float
    effective: float


def sample(
    log_density: Callable[[FloatArray], FloatArray], unknowns: int, *, seed: int, most: int = MOST_STEPS
) -> Samples:
    """Sample a density of standard normal numbers, given by its logarithm for (samples, unknowns).

    most: steps of an ensemble. Raises InputError where it vanishes everywhere, ConvergenceError where samples
    do not converge.
    """
    random = np.random.default_rng(seed)
    if unknowns == 0:
        return Samples(np.zeros((KEPT, 0)), 0, 1.0, 1.0, float(KEPT))
    walkers = max(WALKERS, WALKERS_EACH * unknowns)
    try:
        ensembles = [_ensemble(log_density, walkers, unknowns, random) for _ in range(ENSEMBLES)]
    except ImportError as error:
        raise InputError("an inference needs emcee: pip install 'warpwear[io]'") from error
    steps, time, r_hat = 0, np.inf, np.inf
    while steps < most:
        for ensemble, state in ensembles:
            ensemble.run_mcmc(state if steps == 0 else None, BLOCK)
        steps += BLOCK
        left_out = int(BURN_IN * steps)
        chains = np.array([ensemble.get_chain(discard=left_out) for ensemble, _ in ensembles])
        times = (emcee.autocorr.integrated_time(chain, tol=0, quiet=True) for chain in chains)
        time = max(float(np.max(of_chain)) for of_chain in times)
        r_hat = float(np.max(split_r(chains)))
        if (steps - left_out) > TIMES * time and r_hat < LARGEST_R:
            break
    else:
        raise ConvergenceError(
            f"the samples did not converge within {most} steps: the longest autocorrelation time is "
            f"{time:.0f} steps, split-R̂ is {r_hat:.3f} (at most {LARGEST_R:g} is allowed); fewer unknowns, "
            "narrower priors or more data are needed."
        )
    flat = chains.reshape(-1, unknowns)
    chosen = random.choice(len(flat), min(KEPT, len(flat)), replace=False)
    return Samples(flat[chosen], steps, time, r_hat, len(flat) / max(time, 1.0))


def split_r(chains: FloatArray) -> FloatArray:
    """Return split-R̂ (Gelman and others, Bayesian Data Analysis, 2013, section 11.4) of each unknown.

    chains: (ensembles, steps, walkers, unknowns); each half of an ensemble counts as one chain.
    """
    half = chains.shape[1] // 2
    parts = np.concatenate([chains[:, :half], chains[:, half : 2 * half]])
    parts = parts.reshape(len(parts), -1, chains.shape[-1])
    within = parts.var(axis=1, ddof=1).mean(axis=0)
    between = parts.mean(axis=1).var(axis=0, ddof=1)
    return np.asarray(np.sqrt(1.0 + between / np.maximum(within, 1e-300)))


def spread_of(column: FloatArray) -> tuple[float, float, bool]:
    """Return mean and standard deviation of samples; where few of them make it, median and quantiles.

    The third is whether it is so: then the second is half of what lies between 16 and 84 % of the samples.
    """
    mean, deviation = float(column.mean()), float(column.std())
    if deviation <= ROUNDING * abs(mean):
        return mean, 0.0, False
    low, high = np.percentile(column, SIDES)
    half = 0.5 * float(high - low)
    if half / DISAGREE <= deviation <= half * DISAGREE:
        return mean, deviation, False
    return float(np.median(column)), half, True


def split_of(column: FloatArray, effective: float) -> int | None:
    """Return how many of the samples, in their order, lie in the lower of two groups; None of one group."""
    x = np.sort(column)
    width = 0.25 * float(np.subtract(*np.percentile(x, SIDES[::-1])))
    places, ends = np.arange(x.size), np.searchsorted(x, x + width, "right")
    below, above = places + 1 - np.searchsorted(x, x - width), ends - places  # in a window at each sample
    fewest = GROUP * max(x.size / effective, 1.0)
    far = (np.diff(x) > FAR * width) & (np.minimum(places[1:], x.size - places[1:]) >= fewest)
    if far.any():
        return int(np.argmax(far)) + 1
    lower, upper = np.maximum.accumulate(below), np.append(np.maximum.accumulate(above[::-1])[::-1], 0)[ends]
    peak = np.minimum(lower, upper)
    deepest = int(np.argmax(peak - FEWER * (above - 1)))
    is_split = peak[deepest] >= max(fewest, FEWER * (above[deepest] - 1))
    return deepest + 1 if is_split else None


def _ensemble(
    log_density: Callable[[FloatArray], FloatArray], walkers: int, unknowns: int, random: Any
) -> tuple[Any, Any]:
    """Return an ensemble and the state in which it starts: the most likely of draws from the prior."""
    drawn = random.standard_normal((DRAWS, unknowns))
    density = np.concatenate([log_density(part) for part in np.array_split(drawn, 20)])
    best = np.argsort(-density)[:walkers]
    if not np.isfinite(density[best]).all():
        raise InputError("the priors hardly allow what the study computes: narrower or other ones are needed")
    moves = [(emcee.moves.KDEMove(), 0.6), (emcee.moves.DEMove(), 0.3), (emcee.moves.DESnookerMove(), 0.1)]
    ensemble = emcee.EnsembleSampler(walkers, unknowns, log_density, vectorize=True, moves=moves)
    legacy = np.random.MT19937(int(random.integers(2**31))).state
    return ensemble, emcee.State(drawn[best], log_prob=density[best], random_state=legacy)
