"""Points that an instrument loses, alone and in clumps: what is told of a scar is within its error."""

import math

import numpy as np
import pytest
from cases_worn import PIXEL, SCARS, lose, off_by_errors, pair

from warpwear.surfaces.worn.find_scar import find_scar
from warpwear.surfaces.worn.registration import difference

#: Seeds of sets of cases that no method was developed on.
SETS = (9001, 9002, 9003)


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
        # of the last lip, which lacks half of its points, little is told: they may be lost as it is steep
        assert found.relative[name] < (0.7 if (worn, name) == ("piled", "piled up") else 0.25), name


@pytest.mark.parametrize(
    ("kind", "worn"), [("turned", "bowl"), pytest.param("self-affine", "stadium", marks=pytest.mark.slow)]
)
def test_volumes_hold_where_the_deepest_points_are_lost(kind, worn):
    """Known points elsewhere do not tell what is deep: net volumes were 16 and 9 errors too small."""
    found = off_by_errors(71, 0, kind, worn, pits=0.03)
    assert not isinstance(found, str), found
    for name in ("worn", "net"):
        assert abs(found.off[name]) < 2.5, name
    more = off_by_errors(71, 0, kind, worn, pits=0.07)
    assert "of the scar's points are missing, which leaves open what it lost" in more


@pytest.mark.parametrize("lip", [0.0, 0.4])
@pytest.mark.parametrize("depth", [1e-3, 8e-3])
def test_an_outline_goes_on_as_it_bends_where_a_hole_hides_it(lip, depth):
    """Filled points made the area a twelfth to a third too large; rings about a bowl went on outwards."""
    x = np.arange(160) - 79.5
    r = np.hypot.outer(x, x) / 25.0
    pile = np.where(r > 1.0, lip * depth * np.exp(-np.square((r - 1.15) / 0.12)), 0.0)
    noise = 5e-5 * np.random.default_rng(3).normal(size=r.shape)
    heights = noise + pile - depth * np.maximum(1.0 - np.square(r), 0.0)
    heights[95:118, 70:105] = heights[55:70, 45:72] = np.nan
    found = find_scar(heights, pixel=(PIXEL, PIXEL))
    assert abs(found.area - math.pi * (25.0 * PIXEL) ** 2) < 2.5 * found.area_error < 0.06 * found.area


@pytest.mark.parametrize(("power", "least"), [(1.0, 1e-3), (0.5, 1e-2)])
def test_the_area_of_a_scar_is_where_its_depth_comes_to_nothing(power, least):
    """A bowl's edge is lost in the noise, where its area is taken on, and a steep edge is seen to be one."""
    x, off, errors = np.arange(160) - 79.5, [], []
    for seed in range(3):
        middle = np.random.default_rng([8, seed]).uniform(-0.5, 0.5, 2)
        r = np.hypot.outer(x - middle[0], x - middle[1]) / 25.0
        noise = 5e-5 * np.random.default_rng(seed).normal(size=r.shape)
        bowl = least * (1.0 + 0.4 * seed) * np.maximum(1.0 - np.square(r), 0.0) ** power
        found = find_scar(noise - bowl, pixel=(PIXEL, PIXEL))
        off.append(found.area / (math.pi * (25.0 * PIXEL) ** 2) - 1.0)
        errors.append(found.area_error / found.area)
    assert np.all(np.abs(off) < 2.5 * np.array(errors)), (off, errors)
    assert np.max(errors) < 0.02
    assert abs(np.mean(off)) < 0.01


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


def lost_cases(seed):
    """Return 60 cases with 0 to 10 % scattered and 0 to 20 % clumped loss in both files."""
    rng = np.random.default_rng(seed)
    cases = [
        (kind, worn, n) for kind in ("self-affine", "turned", "real") for worn in SCARS for n in range(4)
    ]
    parts = [rng.permutation(np.linspace(0.0, most, len(cases))) for most in (0.1, 0.2)]
    for case, scattered, clumped, width in zip(cases, *parts, rng.uniform(1.5, 6.0, len(cases)), strict=True):
        yield *case, {"scattered": scattered, "clumped": clumped, "width": width}


@pytest.mark.slow
def test_coverage_where_points_are_lost():
    """Of three sets of 60 cases, in six minutes; one set alone scatters by 6 % about its coverage."""
    every = [
        off_by_errors(seed, n, kind, worn, **lost)
        for seed in SETS
        for kind, worn, n, lost in lost_cases(seed)
    ]
    known = [found for found in every if not isinstance(found, str)]
    assert len(known) >= 0.93 * len(every)
    for name in ("worn", "piled up", "net", "area"):
        off = np.abs([found.off[name] for found in known if name in found.off])
        print(name, [round(float(np.mean(off < errors)), 3) for errors in (1.0, 2.0)])
        # errors of what is worn or piled up are wide here: they hold where what is deep is lost, too
        assert 0.58 <= np.mean(off < 1.0) <= (0.78 if name in ("net", "area") else 1.0), name
        assert np.mean(off < 2.0) >= 0.9, name
    assert np.median([found.relative["area"] for found in known if "area" in found.relative]) < 0.012
    off = np.abs(np.concatenate([found.off["lengths"] for found in known if "lengths" in found.off]))
    assert np.mean(off < 1.0) >= 0.58
    assert np.mean(off < 2.0) >= 0.9
    points = np.abs(np.concatenate([found.points for found in known]))
    assert np.mean(points < 2.5) >= 0.9
