"""Print the table of all quantities of a result, which stands in docs/reference/results.md."""

import sys
from pathlib import Path

import warpwear
from warpwear.history.quantities import QUANTITIES


def markdown_table() -> str:
    """The table of all quantities for the documentation, in Markdown."""
    limits = {
        None: "",
        "track": "runs over a track",
        "half-space": "half-spaces",
        "half-space track": "half-spaces over a track",
        "patches": "runs with patches",
        "dents": "tracks that keep their dents",
        "film": "runs with a film",
        "pieces": "wear in pieces",
        "static area": "output.static_area_every",
    }
    values = {"step": "step", "patch": "step and patch", "cell": "snapshot and cell", "snapshot": "snapshot"}
    values |= {"piece": "piece"}
    rows = ["| name | unit | one value for each | only in | meaning |", "|---|---|---|---|---|"]
    rows += [
        f"| `{q.name}` | {q.units} | {values[q.per]} | {limits[q.only]} | {q.meaning} |" for q in QUANTITIES
    ]
    return "\n".join(rows).replace("^2", "²").replace("^3", "³") + "\n"


if __name__ == "__main__":
    if not Path(warpwear.__file__).is_relative_to(Path(__file__).parents[1]):
        sys.exit(f"{warpwear.__file__} is not of this checkout: set PYTHONPATH to the checkout's folder.")
    print(markdown_table(), end="")
