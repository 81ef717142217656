"""The report on the thesis imports its files by plain names, as `python bench/thesis/report.py` does."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "bench" / "thesis"))
