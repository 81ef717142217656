"""Counter-bodies of any shape against closed forms: ellipses and lines, a rounded pin, worn cylinders."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import integrate, special

from warpwear import Result, Study, run, solve_contact
from warpwear.errors import InputError, InvariantError
from warpwear.figures.of_run.data import smooth_shares
from warpwear.laws.elastic import Hertz
from warpwear.laws.form import sag
from warpwear.surfaces.measured import read_measured
from warpwear.surfaces.preparation import Preparation

MODULUS = 1.0e5
SMOOTH = {"disc.synthetic": {"kind": "flat"}, "output.snapshots": [], "grid.cell": "20 um"}
SHAPES: dict[str, dict[str, Any]] = {
    "ball": {"counter.radius": "3 mm"},
    "crowned": {
        "counter.shape": "crowned",
        "counter.radius_along": "3 mm",
        "counter.radius_across": "10 mm",
    },
    "cylinder": {"counter.shape": "cylinder", "counter.radius": "3 mm"},
    "cylinder along": {
        "counter.shape": "crowned",
        "counter.radius_along": "inf mm",
        "counter.radius_across": "3 mm",
    },
    "pin": {"counter.shape": "pin", "counter.radius": "0.3 mm", "counter.edge_radius": "0.1 mm"},
    "sharp pin": {"counter.shape": "pin", "counter.diameter": "0.6 mm"},
}
TRACK = {
    "sliding.kinematics": "swept",
    "sliding.stroke": "10 mm",
    "sliding.track": "3.2 mm",
    "sliding.distance": "20 mm",
}


def study_of(changes: dict[str, Any]) -> Study:
    """Make a study of a smooth disc with a few short steps."""
    return Study.load("v3-fine").replace(SMOOTH | {"sliding.distance": "3 mm"} | changes)


def ratio_of_radii(axes: float) -> float:
    """R'/R of a contact whose half axes have a ratio, by Legendre's integrals (Johnson 1985, eq 4.28)."""
    m = 1.0 - axes**-2
    k, e = special.ellipk(m), special.ellipe(m)
    return float((axes**2 * e - k) / (k - e))


@pytest.mark.parametrize("axes", [2.5, 6.0, 13.6])
def test_hertz_ellipse_against_legendre(axes: float) -> None:
    """Half axes, peak pressure and approach by Johnson 1985, eqs 4.26-4.28, from the axes to the load."""
    least = 3.0
    most = least * ratio_of_radii(axes)
    b = 0.05
    a, m = b * axes, 1.0 - axes**-2
    k, e = special.ellipk(m), special.ellipe(m)
    peak = 0.5 / least * MODULUS * a**2 * m / (b * (axes**2 * e - k))
    load = 2.0 / 3.0 * math.pi * a * b * peak
    hertz = Hertz(MODULUS, least, load, most)
    assert hertz.semi_axes == pytest.approx((b, a), rel=1e-9)
    assert hertz.peak_pressure == pytest.approx(peak, rel=1e-9)
    assert hertz.approach == pytest.approx(peak * b * k / MODULUS, rel=1e-9)
    turned = Hertz(MODULUS, most, load, least)
    assert turned.semi_axes == pytest.approx((a, b), rel=1e-9)


def test_an_ellipse_becomes_the_circle() -> None:
    circle, ellipse = Hertz(MODULUS, 3.0, 8.0), Hertz(MODULUS, 3.0, 8.0, 3.0 * (1.0 + 1e-9))
    for name in ("radius", "area", "peak_pressure", "approach"):
        assert getattr(ellipse, name) == pytest.approx(getattr(circle, name), rel=1e-8)
    for match in ("area", "pressure", "approach"):
        assert ellipse.foundation(match) == pytest.approx(circle.foundation(match), rel=1e-8)


@pytest.mark.parametrize("axes", [2.5, 6.0, 13.6])
def test_crowned_half_space(axes: float, device: str) -> None:
    """Area, approach, peak pressure and half axes of a crowned body on the half-space are Hertz's."""
    least = 3.0
    hertz = Hertz(MODULUS, least, 8.0, least * ratio_of_radii(axes))
    b, a = hertz.semi_axes
    cell = b / 12.0
    cells = tuple(2 * math.ceil(0.5 * half * 2.5 / cell) for half in (b, a))
    counter = {"shape": "crowned", "radius_along": least, "radius_across": hertz.radius_across}
    contact = solve_contact(
        np.zeros(cells), cell=cell, load=8.0, modulus=MODULUS, counter=counter, device=device
    )
    assert contact.approach == pytest.approx(hertz.approach, rel=3e-3)
    assert contact.pressure.max() == pytest.approx(hertz.peak_pressure, rel=1e-2)
    assert contact.area == pytest.approx(hertz.area, rel=2.0 / 12.0)
    along, across = (np.flatnonzero(contact.pressure.any(axis=axis)).size * cell for axis in (1, 0))
    assert along == pytest.approx(2.0 * b, abs=2.0 * cell)
    assert across == pytest.approx(2.0 * a, abs=2.0 * cell)


def rounded_pin(face: float, edge: float, c: float) -> tuple[float, float, float]:
    """Load, approach and pressure in the middle of a pin of E* = `MODULUS` that touches up to a radius c.

    Ciavarella 1999, Int. J. Solids Struct. 36, 4149, here in the form of Sneddon's integrals: with
    g(x) = x ∫_a^x f'(r)/√(x² − r²) dr = (x/ρ)(√(x² − a²) − a arccos(a/x)), δ = g(c), F = 2 E* ∫_0^c δ − g dx,
    and the pressure in the middle is E*/π ∫_a^c g'(x)/x dx.
    """

    def g(x: float) -> float:
        return x / edge * (math.sqrt(x * x - face * face) - face * math.acos(face / x)) if x > face else 0.0

    def slope(x: float) -> float:
        return (2.0 * math.sqrt(x * x - face * face) - face * math.acos(face / x)) / edge

    load = 2.0 * MODULUS * integrate.quad(lambda x: g(c) - g(x), 0.0, c, points=[face])[0]
    return load, g(c), MODULUS / math.pi * integrate.quad(lambda x: slope(x) / x, face, c)[0]


def test_rounded_pin(device: str) -> None:
    """A pin with an edge on the half-space, so blunt that the edge's circle is its parabola to 1e-5."""
    face, edge, c = 1.0, 40.0, 1.2
    load, approach, middle = rounded_pin(face, edge, c)
    cell = c / 48
    n = 2 * math.ceil(0.6 * c * 2.0 / cell)
    counter = {"shape": "pin", "radius": face, "edge_radius": edge}
    contact = solve_contact(
        np.zeros((n, n)), cell=cell, load=load, modulus=MODULUS, counter=counter, device=device
    )
    assert contact.approach == pytest.approx(approach, rel=5e-3)
    assert math.sqrt(contact.area / math.pi) == pytest.approx(c, rel=1.5e-2)
    assert contact.pressure[n // 2, n // 2] == pytest.approx(middle, rel=1e-2)


def test_sharp_pin(device: str) -> None:
    """A sharp pin: F = 2 E* a δ (Boussinesq; Johnson 1985, eq 3.36)."""
    n, cell = 96, 1.0 / 40.0
    contact = solve_contact(
        np.zeros((n, n)),
        cell=cell,
        approach=0.01,
        modulus=MODULUS,
        counter={"shape": "pin", "radius": 1.0},
        device=device,
    )
    radius = math.sqrt(contact.area / math.pi)
    assert contact.load == pytest.approx(2.0 * MODULUS * radius * 0.01, rel=2e-2)


def test_long_cylinder(device: str) -> None:
    """In the middle of a long cylinder pressure and width are those of a line: p₀² = P'E*/(πR)."""
    radius, line = 6.0, 18.5
    hertz = Hertz(MODULUS, radius, line * 4.0, math.inf, 4.0)
    cell = hertz.radius / 8.0
    shape = (24, 600)
    load = line * shape[1] * cell
    contact = solve_contact(
        np.zeros(shape),
        cell=cell,
        load=load,
        modulus=MODULUS,
        counter={"shape": "cylinder", "radius": radius},
        device=device,
    )
    section = contact.pressure[:, shape[1] // 2]
    there = section.sum() * cell
    assert section.max() == pytest.approx(math.sqrt(there * MODULUS / (math.pi * radius)), rel=1e-2)
    assert np.count_nonzero(section) * cell == pytest.approx(2.0 * hertz.radius, abs=2.0 * cell)


@pytest.mark.parametrize("shape", ["crowned", "cylinder"])
@pytest.mark.parametrize("match", ["area", "pressure"])
def test_macro_foundation(shape: str, match: str) -> None:
    """K_N by Hertz's area or pressure gives that value of crowned bodies and lines, in the macro model."""
    study = study_of(
        SHAPES[shape]
        | {
            "study.model": "macro",
            "contact.hardness": "inf MPa",
            "contact.bulk_stiffness": match,
            "grid.cell": "1 um",
            "grid.extent": "0.4 mm",
            "sliding.distance": "0 mm",
        }
    )
    hertz = study.hertz
    assert hertz is not None
    with run(study, plots=False) as result:
        area, peak = result.history["area_contact"][0], result.history["pressure_max"][0]
    if match == "area":
        assert area == pytest.approx(hertz.area, rel=2.5e-2)
    else:
        assert peak == pytest.approx(hertz.peak_pressure, rel=1e-2)


def test_worn_cylinder() -> None:
    """A cylinder that wears by the local law: A = K P' L, a = (3 R A/2)^⅓, depth of both a²/2R."""
    study = study_of(SHAPES["cylinder"] | {"grid.cell": "5 um", "grid.extent": "0.4 mm"})
    with run(study, plots=False) as result:
        end = {name: values[-1] for name, values in result.history.items()}
    volume = end["wear_volume_counter"] + end["wear_volume_disc"]
    a = (1.5 * 3.0 * volume / 0.4) ** (1.0 / 3.0)
    assert end["patch_along"] == pytest.approx(2.0 * a, abs=2.0 * 5e-3)
    assert end["patch_across"] == pytest.approx(0.4)
    assert end["wear_depth_counter"] + end["wear_depth_disc"] == pytest.approx(a**2 / 6.0, rel=1e-2)


@pytest.mark.parametrize("where", ["at rest", "on a track", "half-space"])
@pytest.mark.parametrize("shape", SHAPES)
def test_volumes(shape: str, where: str) -> None:
    """V = K F L of both bodies, whatever the shape."""
    more = {"at rest": {}, "on a track": TRACK, "half-space": {"contact.law": "half-space"}}[where]
    with run(study_of(SHAPES[shape] | more), plots=False) as result:
        for body in ("counter", "disc"):
            worn, asked = (result.history[f"{kind}_volume_{body}"] for kind in ("wear", "archard"))
            np.testing.assert_allclose(worn, asked, rtol=1e-12)


@pytest.fixture
def ball_file(tmp_path: Path) -> dict[str, Any]:
    """Keys of a counter-body measured without noise: a ball's heights at the study's cells."""
    cells = study_of(SHAPES["ball"]).cells
    np.save(tmp_path / "ball.npy", 0.7 - sag(cells.x, cells.y, radius=3.0))
    return {
        "counter.shape": "measured",
        "counter.surface": str(tmp_path / "ball.npy"),
        "counter.pixel": "20 um",
        "counter.height_unit": "mm",
    }


@pytest.mark.parametrize("where", ["at rest", "on a track", "half-space", "two-scale"])
@pytest.mark.parametrize("level", ["none", "plane", "sphere"])
def test_a_measured_ball_is_the_ball(ball_file: dict[str, Any], level: str, where: str) -> None:
    """Noise-free heights of a ball make the ball's numbers."""
    more: dict[str, Any] = {
        "at rest": {"output.snapshots": ["3 mm"]},
        "on a track": TRACK,
        "half-space": {"contact.law": "half-space", "sliding.distance": "0.1 mm"},
        "two-scale": {
            "study.model": "two-scale",
            "patches.macro_cell": "100 um",
            "contact.bulk_stiffness": "2e6 N/mm^3",
            "sliding.distance": "0.1 mm",
        },
    }[where]
    nominal = {"counter.radius": "3 mm"} if level == "sphere" else {}
    measured = study_of(ball_file | {"counter.level": level} | nominal | more)
    with run(study_of(SHAPES["ball"] | more), plots=False) as ball, run(measured, plots=False) as result:
        for name in ("approach", "area_contact", "pressure_max", "wear_depth_disc", "wear_volume_counter"):
            np.testing.assert_allclose(result.history[name], ball.history[name], rtol=1e-12, err_msg=name)


def test_a_measured_body_is_turned_over(tmp_path: Path) -> None:
    """A bump of the file meets the disc on the other side of the middle across sliding, not along it."""
    n = 75
    heights = np.zeros((n, n))
    heights[20, 30] = 1e-3
    np.save(tmp_path / "bump.npy", heights)
    keys = {
        "counter.shape": "measured",
        "counter.surface": str(tmp_path / "bump.npy"),
        "counter.pixel": "20 um",
        "counter.height_unit": "mm",
        "counter.level": "none",
        "contact.load": "0.1 N",
        "stepping.load_tolerance": "0.01 N",
        "sliding.distance": "0 mm",
        "output.snapshots": ["0 mm"],
    }
    with run(study_of(keys), plots=False) as result:
        pressure = result.snapshot(0).pressure
    assert np.argwhere(pressure > 0.0).tolist() == [[20, n - 1 - 30]]


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "no radii": ({"counter.shape": "crowned"}, "counter.radius_along"),
    "no file": ({"counter.shape": "measured"}, "counter.surface"),
    "wide pin": (
        {"counter.shape": "pin", "counter.radius": "2 mm"},
        r"counter\.radius = 2 mm .* grid\.extent",
    ),
    "endless pin": ({"counter.shape": "pin", "counter.radius": "inf mm"}, r"counter\.radius = inf"),
    "pin in the macro model": (SHAPES["pin"] | {"study.model": "macro"}, r"contact\.bulk_stiffness"),
    "approach of a line": (
        SHAPES["cylinder"] | {"study.model": "macro", "contact.bulk_stiffness": "approach"},
        r"contact\.bulk_stiffness = 'approach'",
    ),
    "repeated": (
        SHAPES["pin"] | {"contact.law": "half-space", "contact.boundary": "periodic"},
        r"contact\.boundary = 'periodic'",
    ),
    "ball's chord": (SHAPES["pin"] | {"wear.distance_factor": "across"}, r"wear\.distance_factor = 'across'"),
    "unknown": ({"counter.shape": "cone"}, r"counter\.shape = 'cone' is not allowed"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refusals(case: str) -> None:
    changes, sentence = REFUSED[case]
    with pytest.raises(InputError, match=sentence):
        study_of(changes)


def test_a_small_file_is_refused(ball_file: dict[str, Any]) -> None:
    """Unless it is extended; the sentence names the key of the counter-body."""
    study = study_of(ball_file | {"grid.extent": "1.6 mm"})
    with pytest.raises(InputError, match=r"counter\.extend is"):
        run(study, plots=False)


def test_a_worn_edge_is_an_error(ball_file: dict[str, Any]) -> None:
    """A measured body known in its file alone must not touch at the domain's edge."""
    small = ball_file | {"grid.extent": "0.2 mm", "checks.strict": True}
    with pytest.raises(InvariantError, match=r"grid\.extent = 0\.2 mm is too small"):
        run(study_of(small), plots=False)


def test_a_measured_run_keeps_its_body(ball_file: dict[str, Any], tmp_path: Path) -> None:
    """Figures, exports and the study of a folder need the file no more; resuming refuses another file."""
    file = Path(ball_file["counter.surface"])
    study = study_of(ball_file | {"output.snapshots": ["3 mm"], "sliding.distance": "3 mm"})
    run(study, out=tmp_path / "run", plots=False).close()
    np.save(file, np.load(file) + 1.0e-3 * np.random.default_rng(0).normal(size=(75, 75)))
    with pytest.raises(InputError, match=r"on what .*ball\.npy was before"):
        run(study, out=tmp_path / "run", plots=False, resume=True)
    file.unlink()
    with Result.open(tmp_path / "run") as result:
        cells = study.cells
        unworn = result.unworn_counter(cells.x, cells.y)
        np.testing.assert_allclose(unworn, sag(cells.x, cells.y, radius=3.0), atol=1e-4)
        assert unworn.min() == 0.0
        result.export(tmp_path / "export", formats=["npy"])
        assert result.record["surface"]["counter"]["file"] == "ball.npy"
    assert np.isfinite(np.load(tmp_path / "export" / "counter_worn.npy")).all()


def test_a_cylinder_the_other_way_is_refused(tmp_path: Path) -> None:
    """A file whose cylinder lies along sliding is not put back across it."""
    cells = study_of(SHAPES["ball"]).cells
    section = sag(cells.x, np.zeros(1), radius=3.0)[:, 0]
    keys = {"counter.shape": "measured", "counter.level": "cylinder", "counter.radius": "3 mm"}
    keys |= {"counter.pixel": "20 um", "counter.height_unit": "mm", "grid.extent": "0.5 mm"}
    for name, heights in (
        ("across", -np.add.outer(section, 0.0 * section)),
        ("along", -np.add.outer(0.0 * section, section)),
    ):
        np.save(tmp_path / f"{name}.npy", heights)
    along, across = (
        study_of(keys | {"counter.surface": str(tmp_path / f"{name}.npy")}) for name in ("along", "across")
    )
    with pytest.raises(InputError, match=r"counter\.sliding_axis"):
        run(along, plots=False)
    nominal = study_of(SHAPES["cylinder"] | {"grid.extent": "0.5 mm"})
    with pytest.raises(InvariantError, match="edge"):  # the file's sides are not the cylinder's ends
        run(across, plots=False)
    goes_on = across.replace({"counter.extend": "mirror"})
    with run(goes_on, plots=False) as result, run(nominal, plots=False) as expected:
        for name in ("area_contact", "wear_depth_disc"):
            np.testing.assert_allclose(result.history[name], expected.history[name], rtol=1e-9, err_msg=name)


def test_line(device: str) -> None:
    """A cylinder of a line boundary has Hertz's pressure under a load of its length."""
    study = study_of(
        SHAPES["cylinder"]
        | {
            "contact.law": "half-space",
            "contact.boundary": "line",
            "contact.load": "18.5 N/mm",
            "contact.hardness": "inf MPa",
            "grid.cell": "1 um",
            "grid.extent": ["0.256 mm", "0.004 mm"],
            "sliding.distance": "0 mm",
        }
    )
    hertz = study.hertz
    assert hertz is not None
    assert hertz.radius**2 == pytest.approx(4.0 * 18.5 * 3.0 / (math.pi * hertz.modulus))
    with run(study, plots=False, device=device) as result:
        assert result.history["pressure_max"][0] == pytest.approx(hertz.peak_pressure, rel=1e-3)
        assert result.history["patch_along"][0] == pytest.approx(2.0 * hertz.radius, abs=2e-3)


@pytest.mark.parametrize("axis", ["x", "y"])
def test_level_cylinder(axis: str, tmp_path: Path) -> None:
    """A rough, tilted cylinder is levelled to its roughness, whichever way it lies."""
    places = (np.arange(60) - 20.0) * 0.01
    heights = np.add.outer(-sag(places, np.zeros(1), radius=2.0)[:, 0], 1e-3 * np.arange(50))
    rough = 1e-4 * np.random.default_rng(0).normal(size=heights.shape)
    np.save(tmp_path / "roller.npy", (heights + rough) if axis == "x" else (heights + rough).T)
    preparation = Preparation(level="cylinder", sliding_axis=axis)
    surface = read_measured(tmp_path / "roller.npy", preparation, pixel=0.01, height_unit="mm")
    assert np.std(surface.levelled - rough) < 1e-5
    (sentence,) = [text for text in surface.record()["operations"] if "cylinder" in text]
    radius = float(sentence.partition("radius ")[2].partition(" mm")[0])
    assert radius == pytest.approx(2.0, rel=1e-2)
    assert "bulging" in sentence


def test_figures_and_the_page(tmp_path: Path, quick_pictures: Any) -> None:
    """Figures of a pin, which has nothing beyond its rim, are drawn, and the page names it."""
    study = study_of(SHAPES["pin"] | {"output.snapshots": ["3 mm"]})
    with quick_pictures(), run(study, out=tmp_path / "run", plots="essential") as result:
        assert {"setup", "profiles"} <= {path.stem for path in (tmp_path / "run" / "figures").glob("*.png")}
        result.plot.counter_map()
    page = (tmp_path / "run" / "report.html").read_text(encoding="utf-8")
    assert f"A {study.counter.title} on" in page


def test_loads_of_patches_beside_a_measured_body(ball_file: dict[str, Any]) -> None:
    """The smooth contact beside the patches is that of the measured body, whose file is gone by then."""
    keys = {
        "study.model": "two-scale",
        "patches.macro_cell": "100 um",
        "contact.bulk_stiffness": "2e6 N/mm^3",
        "sliding.distance": "0.1 mm",
    }
    with run(study_of(SHAPES["ball"] | keys), plots=False) as ball:
        shares = smooth_shares(ball, [0, 9])
    with run(study_of(ball_file | keys), plots=False) as result:
        Path(ball_file["counter.surface"]).unlink()
        np.testing.assert_allclose(smooth_shares(result, [0, 9]), shares, rtol=1e-9, atol=1e-12)
