"""A slot takes several rows on a GPU: a CPU whose slots do so, too, finds what it finds with one row each."""

import pytest
from cases_bare import FILM, STUDIES, history_of
from numpy.testing import assert_allclose

from warpwear.engine.executor import Executor

#: Slots of a pass, no divisor of the rows of any grid below.
SLOTS = 7
SHED = {"wear.particle": "0.1 mm", "wear.particle_thickness": "0.1 um"}
KINDS = STUDIES | {
    "track, film": STUDIES["track"].replace(FILM),
    "track, pieces": STUDIES["track"].replace(SHED),
    "rest, film": STUDIES["rest"].replace(FILM),
    "two scales, film": STUDIES["two scales"].replace(FILM),
    "two scales, loads": STUDIES["two scales"].replace({"patches.coupling": "load"}),
}
del KINDS["rest"]  # on springs that are alike a CPU passes over rows that touch nothing: its slots have one


@pytest.mark.parametrize("kind", KINDS)
def test_slots_of_several_rows(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Sums are made in another order: all else is the same."""
    expected = history_of(KINDS[kind])
    monkeypatch.setattr(Executor, "slots_of", lambda _, rows: min(rows, SLOTS))
    for name, values in history_of(KINDS[kind]).items():
        if name not in ("evaluations", "load_residual"):
            assert_allclose(values, expected[name], rtol=1e-6, atol=1e-12, err_msg=name)
