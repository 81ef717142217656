"""Studies of line contacts, and of domains that are no squares, against closed forms."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

import warpwear
from warpwear import InputError, Study
from warpwear.figures.of_run.data import FigureData
from warpwear.figures.of_run.history import volumes as volumes_of
from warpwear.page.content import words_of

#: On a GPU the transforms need their library.
pytestmark = pytest.mark.transforms

RADIUS, PER_LENGTH = 6.0, 18.5
STEEL = {"young": "200 GPa", "poisson": 0.3}
K_COUNTER, K_DISC = 1.9e-5, 2.9e-5  # mm³/(N·m)


def line(**changes: object) -> Study:
    """A cylinder on a smooth disc, with 18.5 N a millimetre."""
    sections = {
        "counter": STEEL | {"shape": "cylinder", "radius": "6 mm"},
        "disc": STEEL | {"synthetic": {"kind": "flat"}},
        "contact": {"load": "18.5 N/mm", "law": "half-space", "boundary": "line", "hardness": "inf MPa"},
        "wear": {"counter": f"{K_COUNTER} mm^3/N/m", "disc": f"{K_DISC} mm^3/N/m"},
        "grid": {"cell": "1 um", "extent": ["0.16 mm", "4 um"]},
        "sliding": {"distance": "0 mm"},
        "output": {"snapshots": []},
    }
    return Study(**sections).replace({name.replace("__", "."): value for name, value in changes.items()})


@pytest.mark.parametrize("across", ["1 um", "5 um", "24 um"])
def test_hertz_of_a_study(across: str, device: str) -> None:
    """71 cells across the contact: its width to a cell, its peak to half a percent, whatever the width."""
    study = line(grid__extent=["0.16 mm", across])
    width = study.grid.sides[1]
    assert study.contact.load == PER_LENGTH * width
    hertz = study.hertz
    assert hertz is not None
    modulus = study.pair.effective_modulus
    half = math.sqrt(4.0 * PER_LENGTH * RADIUS / (math.pi * modulus))
    assert hertz.radius == pytest.approx(half, rel=1e-12)
    peak = math.sqrt(PER_LENGTH * modulus / (math.pi * RADIUS))
    history = warpwear.run(study, device=device, plots=False).history
    assert history["patch_along"][0] == pytest.approx(2.0 * half, abs=2.1e-3)
    assert history["pressure_max"][0] == pytest.approx(peak, rel=5e-3)
    assert history["area_nominal"][0] == pytest.approx(history["patch_along"][0] * width, rel=1e-12)
    sinks = PER_LENGTH / (math.pi * modulus) * (2.0 * math.log(2.0 * 0.16 / half) + 1.0)
    assert history["approach"][0] == pytest.approx(sinks, rel=2e-3)


def test_wear_of_a_line(threads: int, device: str) -> None:
    """A rectangle of both bodies' overlap with a plane: (3 R A/2)^⅓ wide on each side, A = K P' L."""
    study = line(
        grid__cell="4 um",
        grid__extent=["0.6 mm", "8 um"],
        sliding__distance="400 mm",
        stepping__largest="10 mm",
    )
    history = warpwear.run(study, device=device, threads=threads, plots=False).history
    per_length = 1e-3 * PER_LENGTH * history["distance"][-1]
    worn = [history[f"wear_volume_{body}"][-1] for body in ("counter", "disc")]
    assert_allclose(worn, [k * per_length * 0.008 for k in (K_COUNTER, K_DISC)], rtol=1e-12)
    half = (1.5 * RADIUS * (K_COUNTER + K_DISC) * per_length) ** (1.0 / 3.0)
    assert history["patch_along"][-1] == pytest.approx(2.0 * half, abs=0.008)


def test_volumes_of_a_line_say_whose_they_are() -> None:
    """They are those of the domain's strip, which nobody measures."""
    study = line(grid__cell="8 um", grid__extent=["0.6 mm", "16 um"], sliding__distance="0.1 mm")
    result = warpwear.run(study, plots=False)
    text, summary = str(result), result.summary
    for body, volume in summary["volume_mm3"].items():
        assert summary["volume_mm3_per_mm"][body] == pytest.approx(volume / 0.016, rel=1e-12)
    table = {name: (value, unit) for name, value, unit in words_of(result)["table"]}
    assert table["Load"] == (f"{PER_LENGTH:g}", "N/mm")
    assert table["Worn volume, counter-body and disc"][1].endswith("mm³ per mm of line")
    assert volumes_of(FigureData(result, [])).panels[0].note == "of 0.016 mm of the line"
    (volumes,) = (text_line for text_line in text.splitlines() if "worn volume" in text_line)
    assert " mm³ per mm of the line (K × load × distance" in volumes


def test_a_block_on_a_ring(device: str) -> None:
    """Cruzado et al. 2010: 65 N over 6 mm, a ring that does not wear; 44.06 µm deep and 2.655 mm wide."""
    study = line(
        counter__radius="20 mm",
        contact__load=f"{65.0 / 6.0} N/mm",
        wear__counter="0 mm^3/N/m",
        wear__disc="2e-6 mm^3/N/m",
        grid__cell="20 um",
        grid__extent=["3.2 mm", "20 um"],
        sliding__distance="3600 m",
        stepping__first="1 m",
        stepping__largest="100 m",
    )
    history = warpwear.run(study, device=device, plots=False).history
    section = 2e-9 * 65.0 / 6.0 * 3.6e6
    half = (1.5 * 20.0 * section) ** (1.0 / 3.0)
    assert history["wear_volume_disc"][-1] == pytest.approx(0.02 * section, rel=1e-12)
    assert history["wear_depth_disc"][-1] == pytest.approx(half**2 / 40.0, rel=2e-3)
    assert history["patch_along"][-1] == pytest.approx(2.0 * half, abs=0.041)


@pytest.mark.parametrize("law", ["local", "half-space"])
def test_a_line_of_one_row_of_cells_wears_as_one_of_many(law: str, device: str) -> None:
    """Per length: what is the same across does not depend on how many cells are."""
    changes = {"grid__cell": "4 um", "sliding__distance": "20 mm", "contact__law": law}
    changes |= {"stepping__largest": "1 mm", "contact__hardness": "250 MPa"}
    one, many = (
        warpwear.run(line(grid__extent=["0.4 mm", across], **changes), device=device, plots=False)
        for across in ("4 um", "48 um")
    )
    for name in ("approach", "patch_along", "pressure_max", "pressure_mean", "wear_depth_disc"):
        assert_allclose(one.history[name], many.history[name], rtol=1e-6, err_msg=name)
    assert one.history["pressure_max"].max() == 250.0
    assert_allclose(12.0 * one.history["area_contact"], many.history["area_contact"], rtol=1e-12)
    volumes = [r.history["wear_volume_disc"][-1] for r in (one, many)]
    assert_allclose(volumes, 1e-3 * K_DISC * 20.0 * PER_LENGTH * np.array([0.004, 0.048]), rtol=1e-12)


def test_a_ball_on_a_rectangle_wears_as_on_a_square(threads: int) -> None:
    """The same cells as far as both go; V = K F L."""
    base = Study.load("v3-fine").replace(
        {"grid.cell": "20 um", "disc.synthetic.cut_off": "40 um", "sliding.distance": "30 mm"}
    )
    base = base.replace({"output.snapshots": [], "disc.synthetic.kind": "flat", "stepping.largest": "1 mm"})
    histories = [
        warpwear.run(base.replace({"grid.extent": extent}), threads=threads, plots=False).history
        for extent in ("0.8 mm", ["0.8 mm", "0.64 mm"], ["0.64 mm", "0.8 mm"])
    ]
    for body, k in zip(("counter", "disc"), base.wear_coefficients, strict=True):
        expected = k * base.contact.load * 30.0
        for history in histories:
            assert history[f"wear_volume_{body}"][-1] == pytest.approx(expected, rel=1e-12)
    for other in histories[1:]:
        assert_allclose(other["area_contact"], histories[0]["area_contact"], rtol=1e-12)
        assert_allclose(other["approach"], histories[0]["approach"], rtol=1e-9)


def test_a_rough_line_slides(device: str) -> None:
    """Over a periodic track; both bodies lose K F L, and caps hold."""
    study = line(
        grid__cell="5 um",
        grid__extent=["0.32 mm", "80 um"],
        contact__hardness="1 GPa",
        sliding__distance="6 mm",
    ).replace(
        {
            "sliding.stroke": "1.2 mm",
            "sliding.kinematics": "swept",
            "sliding.track": "0.64 mm",
            "sliding.shift": 8,
            "disc.synthetic": {
                "kind": "self-affine",
                "ra": "0.2 um",
                "cut_off": "20 um",
                "period": "0.64 mm",
            },
        }
    )
    history = warpwear.run(study, device=device, plots=False).history
    load = PER_LENGTH * 0.08
    assert_allclose(history["load"], load)
    assert history["pressure_max"].max() == pytest.approx(1000.0, rel=1e-12)
    assert history["wear_volume_counter"][-1] == pytest.approx(1e-3 * K_COUNTER * load * 6.0, rel=1e-10)
    assert history["wear_volume_disc"][-1] == pytest.approx(1e-3 * K_DISC * load * 6.0, rel=1e-10)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        (
            {"grid.extent": ["0.16 mm", "4 N"]},
            r"^grid\.extent = \['0.16 mm', '4 N'\]: has the wrong dimension",
        ),
        ({"grid.extent": ["1 mm", "1 mm", "1 mm"]}, "needs a length, or two: along sliding and across it"),
        (
            {"grid.extent": ["0.16 mm", "0.4 um"]},
            r"grid\.extent = 0\.4 µm is not a whole .*; the nearest",
        ),
        ({"grid.extent": ["3 um", "0.16 mm"]}, r"not a whole number \(4 or more\) of cells of 1 µm"),
        ({"contact.boundary": "free"}, r"contact\.load = 18\.5 N/mm is the load of a length"),
        (
            {"contact.boundary": "free", "contact.load": "1 N", "grid.extent": ["0.2 mm", "3 um"]},
            "3 × ",
        ),
        (
            {
                "contact.boundary": "free",
                "contact.load": "1 N",
                "grid.extent": "0.2 mm",
                "sliding.distance": None,
                "block": [{"load": "2 N/mm", "distance": "1 mm"}],
            },
            "^block 1: load = 2 N/mm is the load of a length",
        ),
        ({"counter.shape": "ball"}, "'line' would repeat the counter-body beside itself"),
        (
            {"contact.load": "3 mm"},
            "a force such as '8 N' is expected, or of a line contact one of its length",
        ),
        ({"contact.load": "-3 N/mm"}, r"must be greater than 0 N/mm"),
        (
            {"contact.law": "local", "contact.hardness": "1 GPa", "counter.shape": "ball"},
            "the load of a length",
        ),
        ({"grid.extent": ["20 um", "0.2 mm"], "sliding.distance": "1 km"}, "along sliding"),
    ],
)
def test_what_is_no_line_is_refused_in_one_sentence(changes: dict[str, object], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence) as refused:
        warpwear.run(line().replace(changes), plots=False)
    assert "\n" not in str(refused.value)


def test_a_load_of_a_length_stays_one() -> None:
    """When the domain changes, in the text of a study and in a copy."""
    study = line()
    wider = study.replace({"grid.extent": ["0.16 mm", "8 um"]})
    assert wider.contact.load == 2.0 * study.contact.load
    assert 'load = "18.5 N/mm"' in study.to_toml()
    again = Study.stored(wider.to_toml())
    assert again == wider
    assert again.contact.load == wider.contact.load
    assert study.replace({"contact.load": "2 N"}).contact.load == 2.0


def test_a_load_of_the_domain_is_told_as_one_of_a_length() -> None:
    """A strip of the line carries a part of what a rig presses on all of it."""
    assert not [notice for notice in line().notices() if "N/mm" in notice]
    strip = line(contact__load="0.1 N", grid__extent=["0.6 mm", "8 um"])
    (notice,) = (notice for notice in strip.notices() if "N/mm" in notice)
    assert "that of the domain, 0.008 mm of the line: 12.5 N/mm" in notice
    assert "12.5 N/mm over" in repr(strip)
    with pytest.raises(InputError, match=r"contact\.load = 20 N \(2500 N/mm\) is more than the domain"):
        strip.replace({"contact.load": "20 N", "contact.hardness": "500 MPa"})


def test_a_seam_across_is_told() -> None:
    """Of a rough disc that the boundary repeats and its surface does not."""
    study = line(grid__extent=["0.16 mm", "80 um"], contact__hardness="1 GPa")
    rough = {"kind": "self-affine", "ra": "0.2 um", "cut_off": "20 um"}
    seams = [
        [notice for notice in study.replace({"disc.synthetic": kind}).notices() if "seam there" in notice]
        for kind in (rough, rough | {"period": "80 um"}, {"kind": "milled", "ra": "1 um", "fine_ra": "0 um"})
    ]
    assert [len(told) for told in seams] == [1, 0, 0]


@pytest.mark.slow
def test_fretting_of_a_cylinder() -> None:
    """McColl, Ding and Leen 2004, 18,000 cycles, as an independent half-plane solver has it on such cells.

    Depths to half a percent, the worn area by Archard's law, the scar to a cell at each end.
    """
    study = line(
        grid__cell="5 um",
        grid__extent=["0.8 mm", "5 um"],
        sliding__stroke="50 um",
        sliding__cycles=18_000,
        stepping__jump=100,
    )
    result = warpwear.run(study, plots=False)
    history = result.history
    assert 1e3 * history["wear_depth_disc"][-1] == pytest.approx(2.761, rel=5e-3)
    assert 1e3 * history["wear_depth_counter"][-1] == pytest.approx(2.067, rel=5e-3)
    assert history["wear_volume_disc"][-1] / 0.005 == pytest.approx(
        1e-3 * K_DISC * PER_LENGTH * 1800.0, rel=1e-10
    )
    lost = np.add(*result.track_loss(-1, slice(0, result.track_x.size))).any(axis=1)
    assert np.count_nonzero(lost) * 0.005 == pytest.approx(0.515, abs=0.011)
