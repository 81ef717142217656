"""One row for each datum: what was measured, what was computed, and their difference in errors."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from warpwear.results.report import aligned

#: Errors from which a datum and what was computed contradict each other.
CONTRADICTION = 3.0
#: What a table has of a datum.
COLUMNS = ("name", "measured", "computed", "error", "unit", "off", "fitted")


@dataclass(frozen=True)
class Datum:
    """Hold a measured number and what was computed for it.

    error: standard uncertainty of their difference. fitted: whether what is computed was fitted to it, so
    that its agreement says nothing.
    """

    name: str
    measured: float
    computed: float
    error: float
    unit: str = ""
    fitted: bool = False

    @property
    def off(self) -> float:
        """Return the difference, measured less computed, in errors."""
        gap = self.measured - self.computed
        return gap / self.error if self.error else float("inf") * gap if gap else 0.0

    @property
    def entry(self) -> dict[str, Any]:
        """Return it for JSON."""
        return {name: getattr(self, name) for name in COLUMNS}

    def __str__(self) -> str:
        """Say it in a line."""
        numbers = f"measured {self.measured:.4g}, computed {self.computed:.4g} {self.unit}".rstrip()
        return f"{self.name}: {numbers}, {abs(self.off):.1f} errors apart{' (fitted)' * self.fitted}"


def worst_of(data: Iterable[Datum]) -> Datum | None:
    """Return the datum that is farthest off; one that was fitted only where it contradicts, or is alone."""
    rows = [*data]
    told = [d for d in rows if not d.fitted or abs(d.off) > CONTRADICTION] or rows
    return max(told, key=lambda datum: abs(datum.off), default=None)


def headline(data: Sequence[Datum]) -> str:
    """Say which datum is the worst, and how many agree that were not fitted."""
    if (worst := worst_of(data)) is None:
        return "no datum to hold it against"
    free = [datum for datum in data if not datum.fitted]
    good = sum(abs(datum.off) <= CONTRADICTION for datum in free)
    count = f"{good} of {len(free)} agree within {CONTRADICTION:g} errors" if free else "all were fitted"
    return f"worst of {len(data)}: {worst}; {count}"


def lines_of_data(data: Sequence[Datum]) -> list[str]:
    """Write the table: a line each."""
    cells = [["", "measured", "computed", "(difference)/error", "unit", ""]]
    for d in data:
        numbers = f"{d.measured:.4g}", f"{d.computed:.4g}", f"{d.off:+.1f}".replace("-", "−")
        cells.append([d.name, *numbers, d.unit, "fitted" * d.fitted])
    return aligned(cells) if data else []
