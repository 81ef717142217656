"""The sliding increments of a run."""

from collections.abc import Iterable, Iterator


def increments(
    plan: tuple[float, float, float], distance: float, stops: Iterable[float] = ()
) -> Iterator[tuple[float, float]]:
    """Pairs of (increment, distance at its end) [mm] that end exactly at every stop and at the distance.

    plan: first increment, growth, largest increment. A step cut short by a stop does not change the
    planned size of those after it. A distance of 0 is one increment of 0: a static contact.
    """
    if distance == 0.0:
        yield 0.0, 0.0
        return
    planned, growth, largest = plan
    done = 0.0
    for stop in sorted({s for s in stops if 0.0 < s < distance} | {distance}):
        while done < stop:
            left = stop - done
            # A remainder too small to be a step of its own is rounding.
            if planned >= left - 1.0e-6 * planned:
                same = abs(left - planned) <= 1.0e-6 * planned
                yield planned if same else left, stop
                done = stop
            else:
                done += planned
                yield planned, done
            planned = min(planned * growth, largest)
