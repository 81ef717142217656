"""Surfaces, and so runs, are the same bit for bit whatever cores and threads BLAS and OpenMP are given."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import warpwear
from warpwear import InputError, Study
from warpwear.runs import loop, order
from warpwear.runs.checkpoint import FILE_NAME
from warpwear.surfaces.made.fourier import sum_waves
from warpwear.surfaces.made.self_affine import SelfAffine

ROOT = Path(__file__).parents[2]
KINDS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS")
ONE, SEVERAL = (dict.fromkeys(KINDS, count) for count in ("1", "4"))
PATH = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))

#: Sizes at which BLAS shares its work among threads.
SURFACES = """
import os, sys, zlib
import numpy as np
if "one core" in sys.argv:
    os.sched_setaffinity(0, [min(os.sched_getaffinity(0))])
from warpwear.calibration.friction import fit_friction
from warpwear.surfaces.levelling import without_polynomial
from warpwear.surfaces.made.milled import Milled
from warpwear.surfaces.made.self_affine import SelfAffine
from warpwear.surfaces.point_cloud import _axis
from warpwear.surfaces.roughness import bearing_parameters
from warpwear.laws.form import sag
from warpwear.surfaces.sphere import fit_sphere
x = (np.arange(400) - 199.5) * 2e-3
rough = SelfAffine(ra=0.003, cut_off=0.016).heights(x, x)
record = np.linspace(1.0, 9.0, 60000)
tilted = rough + np.add.outer(x, 0.5 * x**3) + 2.0
tilted[100:150, 200:300] = np.nan
found = {
    "self-affine": rough,
    "milled": Milled(ra=0.003, fine_ra=0.0, lay=30.0, cut_off=0.016).heights(x, x),
    "plane": without_polynomial(tilted, degree=1),
    "degree 12": without_polynomial(tilted, degree=12),
    "counter": fit_sphere(rough - sag(x, x, radius=3.0), pixel=(2e-3, 2e-3)).apex,
    "points": _axis(np.arange(20000) * 1e-3 + 1e-9 * np.sin(np.arange(20000)), "x")[2],
    "friction": fit_friction(
        record, np.sin(record), run_distance=record, run_area=record, load=1.0
    ).shear_strength,
    "Sk": list(vars(bearing_parameters(rough)).values()),
}
for name, values in found.items():
    print(name, zlib.crc32(np.ascontiguousarray(values)))
"""


def in_environment(code: str, *arguments: str, **environment: str) -> list[str]:
    """The lines that code prints in a process with other variables."""
    done = subprocess.run(
        [sys.executable, "-c", code, *arguments],
        env=os.environ | {"PYTHONPATH": PATH} | environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


def test_surfaces_do_not_depend_on_threads() -> None:
    one = in_environment(SURFACES, **ONE)
    assert len(one) == 8
    assert in_environment(SURFACES, **SEVERAL) == one
    if hasattr(os, "sched_setaffinity"):
        assert in_environment(SURFACES, "one core") == one


RUN = """
import sys
import warpwear
from warpwear.runs import loop
study = warpwear.Study.load("v3-fine").replace({"grid.cell": "10 um",
    "sliding.distance": "0.05 mm", "output.snapshots": ["0.02 mm"], "run.checkpoint": "0 s"})
if "stop" in sys.argv:
    made = loop.StepLoop._checkpoint
    def stopping(self, checkpoints):
        made(self, checkpoints)
        if len(self._rows) == 5:
            raise SystemExit(0)
    loop.StepLoop._checkpoint = stopping
warpwear.run(study, out=sys.argv[1], plots=False, resume=True).close()
"""


@pytest.mark.slow
def test_a_run_goes_on_in_another_environment(tmp_path: Path) -> None:
    """Killed with several threads of BLAS, resumed with one: as if left alone."""
    in_environment(RUN, str(tmp_path / "alone"), **ONE)
    in_environment(RUN, str(tmp_path / "killed"), "stop", **SEVERAL)
    assert (tmp_path / "killed" / FILE_NAME).is_file()
    in_environment(RUN, str(tmp_path / "killed"), **ONE)
    for name in ("history.csv", "surface.csv"):
        assert (tmp_path / "killed" / name).read_bytes() == (tmp_path / "alone" / name).read_bytes()
    log = (tmp_path / "killed" / "log.txt").read_text()
    assert "goes on after step 5" in log
    assert "stored ones" not in log


def test_waves_far_out_are_their_plain_sum() -> None:
    """At the end of a long track, where whole turns are many: to the rounding of the phases themselves."""
    dice = np.random.default_rng(3)
    amplitudes = dice.normal(size=(2, 1100)) + 1j * dice.normal(size=(2, 1100))
    wave, points = 2.0 * np.pi / 2.0, 45.0 + 1.3e-3 * np.arange(1500)
    phases = (np.longdouble(wave) * points.astype(np.longdouble))[:, None] * np.arange(1100)
    whole = np.longdouble(2.0) * np.longdouble("3.14159265358979323846264338327950288")
    terms = np.exp(1j * np.asarray(np.remainder(phases, whole), dtype=np.float64))
    expected = np.einsum("pj,ij->ip", terms, amplitudes)
    found = sum_waves(amplitudes, wave, points)
    np.testing.assert_allclose(found, expected, rtol=0, atol=3e-9)  # |Σ| is about 50, the phases reach 1.5e5
    assert sum_waves(amplitudes, wave, points[:1]) == pytest.approx(expected[:, :1], abs=3e-9)


@pytest.mark.parametrize("preset", ["v3-fine", pytest.param("two-scale", marks=pytest.mark.slow), "swept"])
@pytest.mark.parametrize(("off", "same"), [(4.0e-13, True), (4.0e-12, False)])
def test_heights_of_another_processor(
    preset: str, off: float, same: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Rounded otherwise: it goes on with the stored heights, says so, and ends the same."""
    changes = {
        "grid.cell": "10 um" if preset == "two-scale" else "20 um",
        "sliding.distance": "0.5 mm",
        "output.snapshots": [],
    }
    if preset == "swept":
        changes |= {"sliding.kinematics": "swept", "sliding.track": "3.2 mm", "sliding.shift": 1}
    study = Study.load("v3-fine" if preset == "swept" else preset).replace(changes)
    alone, out = tmp_path / "alone", tmp_path / "out"
    write = loop.StepLoop._checkpoint

    def stopping(self: loop.StepLoop, checkpoints: loop.Checkpoints) -> None:
        write(self, checkpoints)
        if len(self._rows) == 3:
            raise SystemExit

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(loop.StepLoop, "_checkpoint", stopping)
        with pytest.raises(SystemExit):
            warpwear.run(study.replace({"run.checkpoint": "0 s"}), out=out, plots=False)
    if same:
        warpwear.run(study, out=alone, plots=False).close()
    heights = SelfAffine.heights
    order._LAST.clear()  # the surface is made anew, as in another process
    monkeypatch.setattr(SelfAffine, "heights", lambda *given: heights(*given) + off)
    if not same:
        with pytest.raises(InputError, match="the disc's heights are not what they were"):
            warpwear.run(study, out=out, plots=False, resume=True)
        return
    with warpwear.run(study, out=out, plots=False, resume=True) as result:
        assert sum("goes on with the stored ones" in told for told in result.record["warnings"]) == 1
    for name in ("history.csv", "surface.csv"):
        assert (out / name).read_bytes() == (alone / name).read_bytes()
