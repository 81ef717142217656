"""Stresses below a surface as volumes for ParaView."""

from pathlib import Path

from cases_formats import Vtk
from numpy.testing import assert_allclose, assert_array_equal

import warpwear
from warpwear import Study

STEEL = {"young": "210 GPa", "poisson": 0.3, "hardness": "6 GPa"}


def test_a_volume_lies_as_vtk_counts_it(tmp_path: Path) -> None:
    """x is the fastest, z is up: the deepest plane comes first."""
    study = Study(
        study={"name": "volumes"},
        counter={"radius": "5 mm", **STEEL},
        disc={"synthetic": {"kind": "flat"}, **STEEL},
        contact={"load": "20 N", "law": "half-space"},
        wear={"counter": "1e-6 mm^3/N/m", "disc": "1e-6 mm^3/N/m"},
        grid={"cell": "8 um", "extent": ["320 um", "240 um"]},
        sliding={"distance": "0.5 mm"},
        stepping={"scheme": "implicit"},
        friction={"law": "coulomb", "coefficient": 0.4},
        output={"stress_depths": ["0 um", "40 um", "90 um"], "snapshots": []},
    )
    result = warpwear.run(study)
    names = {path.name for path in result.export(tmp_path, formats=["vti"])}
    assert {"stresses.pvd", "stresses_0000.vtr"} <= names
    volume, table = Vtk(tmp_path / "stresses_0000.vtr"), result.stresses
    assert volume.kind == "RectilinearGrid"
    assert volume.time == 0.5
    assert_array_equal(volume.arrays["z [mm]"], [-0.09, -0.04, 0.0])
    assert_array_equal(volume.arrays["x [mm]"], result.x)
    assert_array_equal(volume.arrays["y [mm]"], result.y)
    for name in ("mises", "max_shear", "principal"):
        field = volume.arrays[f"{name} [MPa]"]
        assert field.shape == (40, 30, 3)
        assert_allclose(field.max(axis=(0, 1)), table[name][0][::-1], rtol=1e-12)
        middle = 0.5 * (field[:, 14] + field[:, 15])
        assert_allclose(middle[:, ::-1].T, table[f"{name}_plane"][0], rtol=1e-12)
