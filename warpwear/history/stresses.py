"""What the stresses below the disc's surface come to at a snapshot, from its pressure and friction."""

from collections.abc import Iterable

import numpy as np

from warpwear.contact.stress.responses import COMPONENTS, Loads
from warpwear.contact.stress.stresses import Stresses
from warpwear.grid import FloatArray
from warpwear.history.quantities import stress_columns
from warpwear.history.snapshot import Snapshot
from warpwear.study.study import Study

#: Measures of a stress, by name; and of a cycle, where there are fatigue limits.
MEASURES, OF_A_CYCLE = ("mises", "max_shear", "principal"), ("crossland", "dang_van")


def traction_of(study: Study, pressure: FloatArray, cof: float) -> FloatArray:
    """Return the traction of friction on the disc along sliding [MPa], which slides to greater x.

    By Coulomb's law, and by ploughing, it is in proportion to the pressure; the rest, what shears, is the
    same in all cells in contact. cof: the coefficient of friction; NaN, where it is not known, is none.
    """
    ploughing = cof if study.friction.law == "coulomb" else study.friction.ploughing
    if not np.isfinite(cof):
        return np.zeros_like(pressure)
    touched = pressure > 0.0
    sheared = (cof - ploughing) * float(pressure.sum()) / max(int(touched.sum()), 1)
    traction: FloatArray = ploughing * pressure + sheared * touched
    return traction


def of_snapshot(study: Study, snapshot: Snapshot, cof: float, threads: int) -> dict[str, FloatArray]:
    """Return the quantities of depths, and of a plane, at a snapshot: shapes (depths,) and (depths, n).

    The stress is that of the pressure and the traction of `traction_of`; a cycle turns the traction round
    under the pressure, which stays. Depths are done one after another: memory is that of one.
    """
    cells, fatigue, normal = study.cells, study.fatigue, study.output.stress_plane[0]
    names = [*MEASURES, *(OF_A_CYCLE if fatigue else ())]
    loads = [{"p": snapshot.pressure}, {"x": traction_of(study, snapshot.pressure, cof)}]
    assert study.disc.poisson is not None  # or there is no half-space
    parts = [
        Loads(load, cells.cell, poisson=study.disc.poisson, boundary=study.boundary, threads=threads)
        for load in (loads if fatigue else [loads[0] | loads[1]])
    ]
    limit, tables = study.yield_strength, {name: list[FloatArray]() for name in stress_columns(study)}
    for depth in study.stress_depths:
        pressed, *turned = (part.at(depth)[:, np.newaxis] for part in parts)
        sheared = turned[0] if turned else np.zeros((len(COMPONENTS), 1, 1, 1))
        there, back = (
            Stresses(np.array([depth]), pressed + sign * sheared, cells.cell, study.boundary, None)
            for sign in (1.0, -1.0)
        )
        fields = [there.mises, there.shear, there.principal]
        if fatigue:
            limits = {"bending": fatigue.bending, "torsion": fatigue.torsion, "length": fatigue.length}
            cycle = there.cycle(back, **limits)
            fields += [cycle.crossland, cycle.dang_van]
        beyond = np.nan if limit is None else np.mean(there.mises > limit)
        row: dict[str, float | FloatArray] = {"depth": depth, "yielding": float(beyond)}
        for name, field in zip(names, fields, strict=True):
            i, j = np.unravel_index(int(field[0].argmax()), cells.shape)
            row |= {name: field[0, i, j], f"{name}_x": cells.x[i], f"{name}_y": cells.y[j]}
            row[f"{name}_plane"] = there.plane(field, normal)[0]
        for name, table in tables.items():
            table.append(np.asarray(row[name]))
    return {name: np.array(table) for name, table in tables.items()}


def of_run(
    study: Study, snapshots: Iterable[Snapshot], history: dict[str, FloatArray], threads: int
) -> dict[str, FloatArray]:
    """Return the quantities at all snapshots: shapes (snapshots, depths) and (snapshots, depths, n)."""
    tables = []
    for snapshot in snapshots:
        row = min(int(np.searchsorted(history["distance"], snapshot.distance)), history["cof"].size - 1)
        tables.append(of_snapshot(study, snapshot, float(history["cof"][row]), threads))
    return {name: np.stack([table[name] for table in tables]) for name in stress_columns(study)}
