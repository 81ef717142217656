"""Print the table of all quantities of a result, which stands in docs/reference/results.md."""

import sys
from pathlib import Path

import warpwear
from warpwear.history.quantities import QUANTITIES


def markdown_table() -> str:
    """The table of all quantities for the documentation, in Markdown."""
    values = {"step": "step", "patch": "step and patch", "cell": "snapshot and cell", "snapshot": "snapshot"}
    values |= {"piece": "piece", "depth": "snapshot and depth", "plane": "snapshot, depth and cell of a line"}
    rows = ["| name | unit | one value for each | only in | meaning |", "|---|---|---|---|---|"]
    for q in QUANTITIES:
        rows.append(f"| `{q.name}` | {q.units} | {values[q.per]} | {q.runs} | {q.meaning} |")
    return "\n".join(rows).replace("^2", "²").replace("^3", "³") + "\n"


if __name__ == "__main__":
    if not Path(warpwear.__file__).is_relative_to(Path(__file__).parents[1]):
        sys.exit(f"{warpwear.__file__} is not of this checkout: set PYTHONPATH to the checkout's folder.")
    print(markdown_table(), end="")
