"""How far a smooth macro contact is from the load shares of patches."""

from collections.abc import Sequence

import numpy as np

from warpwear.grid import FloatArray
from warpwear.patches import Patches
from warpwear.results import Result
from warpwear.smooth_contact import SmoothContact


def load_share_error(shares: FloatArray, others: FloatArray) -> float:
    """½ Σ|ΔF_k| / F: part of the load that two distributions of it put on different patches."""
    return float(0.5 * np.abs(shares - others).sum() / others.sum())


def smooth_shares(result: Result, rows: Sequence[int]) -> FloatArray | None:
    """Loads [N] that the smooth macro contact of a study would give its patches, with its own wear.

    rows: of the history; shape (rows, patches). None where the study has no foundation K_N: its elastic
    constants are not known.
    """
    study = result.study
    if isinstance(study.contact.foundation, str) and study.hertz is None:
        return None
    smooth = SmoothContact(study, Patches.of(study))
    found: dict[int, FloatArray] = {}
    slid = 0.0
    for row, increment in enumerate(result.history["increment"][: max(rows) + 1]):
        removal = sum(law.removal(slid, float(increment)) for law in study.wear_laws)
        pressure = smooth.press(foundation=study.foundation(), removal=removal)
        slid += float(increment)
        if row in rows:
            found[row] = smooth.area * pressure
    return np.array([found[row] for row in rows])
