"""Points that an instrument loses, alone and in clumps: what is told of a scar is within its error."""

import numpy as np
import pytest
from cases_worn import PIXEL, SCARS, lose, off_by_errors, pair

from warpwear.surfaces.worn.find_scar import find_scar
from warpwear.surfaces.worn.registration import difference


@pytest.mark.parametrize(
    ("kind", "worn", "number", "lost"),
    [
        ("self-affine", "stadium", 1, {"scattered": 0.02, "clumped": 0.125, "width": 4.4}),  # was refused
        (
            "turned",
            "stadium",
            3,
            {"scattered": 0.08, "clumped": 0.07, "width": 5.6},
        ),  # a lip 16 errors too low
        ("self-affine", "piled", 2, {"scattered": 0.1, "clumped": 0.2, "width": 4.6}),  # and 19
    ],
)
def test_volumes_hold_where_points_are_lost(kind, worn, number, lost):
    found = off_by_errors(61, number, kind, worn, **lost)
    assert not isinstance(found, str), found
    for name in ("worn", "piled up", "net", "area"):
        assert abs(found.off[name]) < 3.0, name
        assert found.relative[name] < 0.25, name


def test_lengths_end_at_what_was_measured():
    """What fills a hole at the outline falls to its far side: the scar was a third longer."""
    found = pair(np.random.default_rng([61, 3]), "turned", "bowl")
    rows, columns = np.nonzero(found.gone)
    holes = found.after.copy()
    holes[rows.max() - 5 : rows.max() + 15, columns.min() : columns.max()] = np.nan
    both = difference(holes, found.before, pixel=(PIXEL, PIXEL), earlier_pixel=(PIXEL, PIXEL))
    scar = find_scar(both.heights, pixel=(PIXEL, PIXEL))
    true = (found.gone[both.window] > 0.0).any(axis=1).sum() * PIXEL
    assert true - 8 * PIXEL < scar.along < true + 2 * PIXEL
    assert abs(scar.along - true) < 2.0 * scar.length_errors[0]


def test_a_point_lost_costs_itself_alone():
    found = pair(np.random.default_rng([61, 0]), "self-affine", "bowl")
    lost = lose(np.random.default_rng(0), found.after, scattered=0.05, clumped=0.0, width=1.0)
    scars = [
        find_scar(difference(after, found.before, pixel=(PIXEL, PIXEL), earlier_pixel=(PIXEL, PIXEL)).heights,
                  pixel=(PIXEL, PIXEL))
        for after in (found.after, lost)
    ]  # fmt: skip
    assert scars[1].volume == pytest.approx(scars[0].volume, abs=2.0 * scars[1].volume_error)
    assert (scars[1].along, scars[1].across) == pytest.approx(
        (scars[0].along, scars[0].across), abs=2 * PIXEL
    )


def lost_cases():
    """Return 60 cases with 0 to 10 % scattered and 0 to 20 % clumped loss in both files."""
    rng = np.random.default_rng(35)
    cases = [
        (kind, worn, n) for kind in ("self-affine", "turned", "real") for worn in SCARS for n in range(4)
    ]
    parts = [rng.permutation(np.linspace(0.0, most, len(cases))) for most in (0.1, 0.2)]
    for case, scattered, clumped, width in zip(cases, *parts, rng.uniform(1.5, 6.0, len(cases)), strict=True):
        yield *case, {"scattered": scattered, "clumped": clumped, "width": width}


@pytest.mark.slow
def test_coverage_where_points_are_lost():
    """Of 60 cases, in two minutes.

    Measured were 67, 72, 64 % (worn, piled up, net) within one error and 91, 97, 93 % within two; lengths 86
    and 95 %, and 90 % of them within two points.
    """
    every = [off_by_errors(61, n, kind, worn, **lost) for kind, worn, n, lost in lost_cases()]
    known = [found for found in every if not isinstance(found, str)]
    assert len(known) >= 0.95 * len(every)
    for name in ("worn", "piled up", "net"):
        off = np.abs([found.off[name] for found in known])
        assert 0.58 <= np.mean(off < 1.0) <= 0.78, name
        assert np.mean(off < 2.0) >= 0.9, name
    off = np.abs(np.concatenate([found.off["lengths"] for found in known if "lengths" in found.off]))
    assert np.mean(off < 1.0) >= 0.58
    assert np.mean(off < 2.0) >= 0.9
    points = np.abs(np.concatenate([found.points for found in known]))
    assert np.mean(points < 2.5) >= 0.9
