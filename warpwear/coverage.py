"""How much of a range a measured course covers: where its points lie too far apart to join them by a line."""

from warpwear.errors import InputError
from warpwear.experiment import Experiment
from warpwear.grid import FloatArray

#: A gap between two points is longer than this part of the range and than so many mean gaps.
GAP, MEAN_GAPS = 0.05, 2.0
#: Largest part of the range that may lie in gaps.
MOST = 0.5


def gaps(distance: FloatArray, start: float, end: float) -> list[tuple[float, float]]:
    """Pieces of a range [mm] without a measured point nearby, from and to.

    Between two successive points that are much further apart than the others, whose spacing may well change:
    records are often dense at first. distance: of the points, rising [mm].
    """
    inside = (distance[1:] > start) & (distance[:-1] < end)
    low, high = distance[:-1][inside].clip(start, end), distance[1:][inside].clip(start, end)
    if low.size == 0:
        return []
    lengths = high - low
    wide = (lengths > GAP * (end - start)) & (lengths > MEAN_GAPS * lengths.mean())
    return list(zip(low[wide].tolist(), high[wide].tolist(), strict=True))


def check_coverage(experiment: Experiment, start: float, end: float) -> list[str]:
    """What is to be said of its gaps in a range [mm] that it is compared over, as sentences.

    Raises InputError when more than half of the range lies in gaps.
    """
    found = gaps(experiment.distance, start, end)
    if not found:
        return []
    missing = sum(high - low for low, high in found) / (end - start)
    low, high = max(found, key=lambda gap: gap[1] - gap[0])
    told = (
        f"{100.0 * missing:.0f} % of the distance shared with the runs, the longest piece from {low:.4g} to "
    )
    told += f"{high:.4g} mm"
    if missing > MOST:
        raise InputError(
            f"{experiment.name} has no measured point over {told}; points over half of it or more are "
            "expected"
        )
    return [f"It has no measured point over {told}: straight lines bridge that in the rms."]
