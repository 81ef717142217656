"""What a scar has lost and piled up, by measurements before and after, is within its error."""

import math

import numpy as np
import pytest
from cases_worn import PIXEL, SCARS, off_by_errors, pair, seen, self_affine
from scipy import ndimage, stats

from warpwear.errors import InputError
from warpwear.surfaces.worn.find_scar import find_scar
from warpwear.surfaces.worn.registration import difference

SIZE = (PIXEL, PIXEL)


@pytest.mark.parametrize(
    ("kind", "worn"), [("self-affine", "piled"), ("turned", "stadium"), ("real", "asperities")]
)
def test_volumes_are_within_their_errors(kind, worn):
    found = off_by_errors(11, 0, kind, worn)
    assert not isinstance(found, str), found
    for name in ("worn", "piled up", "net"):
        assert abs(found.off[name]) < 4, name
        assert found.relative.get(name, 0.0) < 0.05, name
    assert np.mean(np.abs(found.off["profile"]) < 3) > 0.8


@pytest.mark.slow
def test_coverage_of_scars():
    """The errors hold in 90 cases of scars of known volume, in four to six minutes."""
    found = [off_by_errors(23, n, kind, worn) for kind in ("self-affine", "turned", "real")
             for worn in SCARS for n in range(6)]  # fmt: skip
    known = [f for f in found if not isinstance(f, str)]
    assert len(known) > 0.9 * len(found)
    for name in ("worn", "piled up", "net"):
        off = np.abs([f.off[name] for f in known])
        for errors in (1, 2):
            # beyond chance is what one of a thousand such tables has, were the errors Gaussian
            least, most = stats.binom.interval(0.999, off.size, math.erf(errors / math.sqrt(2.0)))
            assert least <= np.sum(off < errors) <= most, (name, errors)


def test_pile_up_does_not_hide_in_the_scatter_of_the_unworn_part():
    """A low wide lip counted as unworn made that look rough, so rough that no lip was seen."""
    case = pair(np.random.default_rng([77, 3]), "self-affine", "piled")
    found = find_scar(
        case.piled - case.gone + 6e-5 * np.random.default_rng(0).normal(size=case.gone.shape), pixel=SIZE
    )
    true = float(case.piled.sum()) * PIXEL**2
    assert abs(found.piled_up - true) < 3.0 * found.piled_up_error
    assert found.piled_up == pytest.approx(true, rel=0.05)


@pytest.mark.parametrize("everywhere", [False, True])
def test_asperities_that_stand_alone_beside_a_scar_belong_to_it(everywhere):
    """They were left out, and the volume was low; but holes that the surface has everywhere are no wear."""
    x = np.arange(160) - 79.5
    r = np.hypot.outer(x, x)
    scar, holes = 3e-3 * np.maximum(1.0 - np.square(r / 25.0), 0.0), np.zeros_like(r)
    angles = np.radians(np.arange(0.0, 360.0, 60.0))
    middles = 34.0 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    if everywhere:
        middles = np.array([(p, q) for p in x[5::15] for q in x[5::15] if np.hypot(p, q) > 32.0])
    for p, q in middles:
        holes += 1e-3 * np.exp(-np.add.outer(np.square(x - p), np.square(x - q)) / 8.0)
    noise = 5e-5 * np.random.default_rng(1).normal(size=r.shape)
    found = find_scar(noise - scar - holes, pixel=SIZE)
    if everywhere:
        assert not found.patch[r > 32.0].any()
    else:
        assert abs(found.net - float((scar + holes).sum()) * PIXEL**2) < 3.0 * found.net_error
        assert found.net_error < 0.01 * found.net


def test_a_far_blob_of_noise_does_not_lengthen_a_scar():
    """Its volume hardly feels the blob, but the scar was half as long again."""
    x = np.arange(160) - 79.5
    scar = 3e-3 * np.maximum(1.0 - np.square(np.hypot.outer(x, x) / 25.0), 0.0)
    noise = 5e-5 * np.random.default_rng(1).normal(size=scar.shape)
    blob = 1.2e-3 * np.exp(-np.add.outer(np.square(x - 3.0), np.square(x - 52.0)) / 8.0)
    alone, both = (find_scar(noise - scar - more, pixel=SIZE) for more in (0.0, blob))
    assert both.patch[:, 125:].any()
    assert both.volume == pytest.approx(alone.volume, rel=0.03)
    for length, true in ((both.along, alone.along), (both.across, alone.across)):
        assert length == pytest.approx(true, abs=PIXEL)
    for found in (alone, both):
        for length, error in zip((found.along, found.across), found.length_errors, strict=True):
            assert abs(length - 50.0 * PIXEL) < 2.0 * error < 0.2 * length


@pytest.mark.slow
def test_errors_of_lengths_hold():
    """The outline's error is that of its lengths, too: beside pile-up, and where a scar runs out flat."""
    x = np.arange(160) - 79.5
    r, off = np.hypot.outer(x / 1.3, x) / 25.0, []
    for seed, lip in ((seed, lip) for seed in (0, 2, 5) for lip in (0.0, 0.3)):
        depth = 1e-3 * (1.0 + seed)
        pile = np.where(r > 1.0, lip * depth * np.exp(-np.square((r - 1.15) / 0.12)), 0.0)
        noise = 8e-5 * np.random.default_rng(seed).normal(size=r.shape)
        found = find_scar(noise + pile - depth * np.maximum(1.0 - np.square(r), 0.0), pixel=SIZE)
        true = np.array([65.0, 50.0]) * PIXEL
        assert np.all(np.abs([found.along, found.across] / true - 1.0) < 0.1)
        off += list(([found.along, found.across] - true) / found.length_errors)
    off = np.abs(off)
    assert np.mean(off < 1.0) > 0.5
    assert np.mean(off < 2.0) > 0.9


def case():
    return pair(np.random.default_rng(5), "self-affine", "piled")


def test_a_deep_scar_does_not_lead_the_registration_astray():
    found = pair(np.random.default_rng([7, 3]), "self-affine", "bowl")
    both = difference(found.after, found.before, pixel=SIZE, earlier_pixel=SIZE)
    assert both.rotation == pytest.approx(-found.angle, abs=2e-3)
    cosine, sine, (x, y) = np.cos(found.angle), np.sin(found.angle), found.shift
    assert both.shift == pytest.approx((-cosine * x - sine * y, sine * x - cosine * y), abs=0.5 * PIXEL)


def refusal(after, before, pixel=SIZE, earlier_pixel=SIZE):
    with pytest.raises(InputError) as caught:
        find_scar(difference(after, before, pixel=pixel, earlier_pixel=earlier_pixel).heights, pixel=pixel)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_wrong_units_are_one_sentence():
    found = case()
    assert "times as rough as FILE" in refusal(found.after, 1e3 * found.before)
    assert "times as rough as FILE" in refusal(found.after, 1e-3 * found.before)
    assert "--before has a field of" in refusal(found.after, found.before, earlier_pixel=(4e-6, 4e-6))
    assert "--before has a field of" in refusal(found.after, found.before, earlier_pixel=(4.0, 4.0))


@pytest.mark.slow
def test_no_overlap_and_a_surface_too_rough_are_refused():
    found = case()
    other = pair(np.random.default_rng(6), "self-affine", "piled")
    assert "--before does not show the place of FILE" in refusal(found.after, other.before)
    noise = 3e-3 * np.random.default_rng(0).normal(size=found.after.shape)
    assert "--before does not show the place of FILE" in refusal(found.after + noise, found.before)


def test_a_scar_larger_than_the_field_is_refused():
    field = 1.5e-3 * self_affine(np.random.default_rng(2), (200, 200))
    x = (np.arange(120) - 59.5) / 60.0
    clean = seen(field, (120, 120))
    for reach in (1.25, 3.0):
        gone = 0.02 * np.maximum(1.0 - np.add.outer(np.square(x), np.square(x)) / reach**2, 0.0)
        said = refusal(clean - gone, clean + 3e-5 * np.random.default_rng(3).normal(size=clean.shape))
        assert any(words in said for words in ("scar is larger", "scar fills", "too little of that is unworn",
                                               "no scar was found"))  # fmt: skip


@pytest.mark.parametrize("wide", [0.0, 1.5])
def test_chance_is_no_scar(wide):
    """In a third of such fields the deepest place was taken for one."""
    for seed in range(8):
        noise = np.random.default_rng([9, seed]).normal(size=(130, 170))
        with pytest.raises(InputError, match=r"no scar was found.*by more than chance"):
            find_scar(6e-5 * (ndimage.gaussian_filter(noise, wide) if wide else noise), pixel=SIZE)


def test_a_thin_ridge_that_has_worn_belongs_to_the_scar_and_a_pit_laid_a_little_off_does_not():
    x, y = np.arange(160) - 79.5, np.arange(160) - 79.5
    scar = 3e-3 * np.maximum(1.0 - np.add.outer(np.square(x / 10.0), np.square(y / 25.0)), 0.0)
    noise = 5e-5 * np.random.default_rng(1).normal(size=scar.shape)
    ridge = 1e-3 * np.multiply.outer(np.abs(x - 22.0) < 1.0, np.abs(y) < 9.0)
    found = find_scar(noise - scar - ridge, pixel=SIZE)
    assert abs(found.net - float((scar + ridge).sum()) * PIXEL**2) < 3.0 * found.net_error
    assert found.net_error < 0.01 * found.net
    pit = 5e-3 * np.exp(-np.add.outer(np.square(x - 22.0), np.square(y)) / 3.0)
    alone = find_scar(noise - scar, pixel=SIZE)
    both = find_scar(noise - scar - pit + 0.95 * np.roll(pit, 1, axis=0), pixel=SIZE)
    assert both.volume == pytest.approx(alone.volume, abs=0.5 * alone.volume_error)


def test_the_outline_beside_steep_pile_up_is_where_the_surface_crosses_the_form():
    """A mean over the points about it was drawn inwards by the pile-up, and both volumes were low."""
    x = np.arange(160) - 79.5
    r = np.hypot.outer(x, x) / 25.0
    scar = 3e-3 * np.maximum(1.0 - np.square(r), 0.0)
    pile = np.where(r > 1.0, 1.2e-3 * np.exp(-np.square((r - 1.15) / 0.12)), 0.0)
    found = find_scar(pile - scar + 2e-5 * np.random.default_rng(2).normal(size=r.shape), pixel=SIZE)
    for volume, true in ((found.volume, scar.sum()), (found.piled_up, pile.sum())):
        assert volume == pytest.approx(float(true) * PIXEL**2, rel=1e-3)
    # a count of pixels within the circle is 0.6 % more
    assert abs(found.area - math.pi * (25.0 * PIXEL) ** 2) < found.area_error < 0.005 * found.area


@pytest.mark.parametrize("half", [1, 2, 3])
def test_a_narrow_scratch_with_lips_keeps_its_volumes(half):
    """The vote of the points about each took narrow scratches away, and a point of wider ones."""
    x = np.abs(np.arange(120) - 59.5)
    scratch = np.multiply.outer(np.ones(120), 4e-3 * (x < half))
    lips = np.multiply.outer(np.ones(120), 8e-4 * ((x > half) & (x < half + 4)))
    noise = 5e-5 * np.random.default_rng(4).normal(size=scratch.shape)
    found = find_scar(noise - scratch + lips, pixel=SIZE)
    for volume, error, true in ((found.volume, found.volume_error, scratch.sum()),
                                (found.piled_up, found.piled_up_error, lips.sum())):  # fmt: skip
        assert abs(volume - float(true) * PIXEL**2) < 3.0 * error
        assert error < 0.02 * volume


@pytest.mark.parametrize("shape", [(3, 50), (12, 12), (60, 4)])
def test_fields_of_few_points_are_refused(shape):
    with pytest.raises(InputError, match=r"16 a side are needed"):
        find_scar(np.random.default_rng(0).normal(size=shape), pixel=SIZE)


def test_a_small_field_has_errors():
    x = np.arange(18) - 8.5
    bowl = 4e-3 * np.maximum(1.0 - np.square(np.hypot.outer(x, x) / 4.0), 0.0)
    found = find_scar(5e-5 * np.random.default_rng(0).normal(size=bowl.shape) - bowl, pixel=SIZE)
    assert abs(found.net - float(bowl.sum()) * PIXEL**2) < 3.0 * found.net_error < 0.1 * found.net


def test_nothing_worn_is_refused():
    field = 1.5e-3 * self_affine(np.random.default_rng(2), (200, 200))
    noise = 3e-5 * np.random.default_rng(3).normal(size=(2, 120, 120))
    clean = seen(field, (120, 120))
    assert "no scar was found" in refusal(clean + noise[0], clean + noise[1])


def test_scattered_lost_points_cost_themselves_alone():
    """A tenth of the points lost in both left 0.2 % of the field: holes grew, its lines were taken off."""
    rng = np.random.default_rng([5, 1])
    found = pair(rng, "self-affine", "piled")
    after, before = (np.where(rng.random(z.shape) < 0.1, np.nan, z) for z in (found.after, found.before))
    both = difference(after, before, pixel=SIZE, earlier_pixel=SIZE)
    assert both.heights.size > 0.85 * after.size
    assert np.isfinite(both.heights).mean() == pytest.approx(0.81, abs=0.04)
    scar = find_scar(both.heights, pixel=SIZE)
    assert abs(scar.net - found.truth(both.window)[2]) < 3.0 * scar.net_error < 0.05 * scar.net
