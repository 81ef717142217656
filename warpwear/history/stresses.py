"""What the stresses below the disc's surface come to at a snapshot, from its pressure and friction."""

import math
from collections.abc import Iterable, Mapping

import numpy as np

from warpwear.contact.stress.responses import COMPONENTS, Loads
from warpwear.contact.stress.stresses import Stresses, stresses
from warpwear.grid import FloatArray
from warpwear.history.joint import contact_of
from warpwear.history.quantities import MEASURES, OF_A_CYCLE, stress_columns
from warpwear.history.snapshot import Snapshot
from warpwear.study.study import Study


def traction_of(study: Study, snapshot: Snapshot, row: Mapping[str, float]) -> FloatArray:
    """Return the traction of friction on the disc along sliding [MPa], at its largest, towards greater x.

    By Coulomb's law, and by ploughing, it is in proportion to the pressure; the rest, what shears, is the
    same in all cells in contact. Where a part sticks under an amplitude Q of fretting it is μ (p − p*), with
    the pressure p* of the contact under P − Q/μ (Ciavarella 1998, Jäger 1998). row: the history's, whose cof
    may be NaN, not known: then there is none.
    """
    pressure, cof, ploughing = snapshot.pressure, row["cof"], study.friction.ploughing
    if not math.isfinite(cof):
        return np.zeros_like(pressure)
    if study.friction.law != "shear-strength":
        return np.asarray(cof * (pressure - _held(study, snapshot, row)))
    touched = pressure > 0.0
    sheared = (cof - ploughing) * float(pressure.sum()) / max(int(touched.sum()), 1)
    return np.asarray(ploughing * pressure + sheared * touched)


def _held(study: Study, snapshot: Snapshot, row: Mapping[str, float]) -> FloatArray:
    """Return the pressure p* of what sticks in a cycle of fretting, at most that of the contact [MPa]."""
    sticks = study.fretting is not None and row["stick_area"] > 0.0
    load = row["load"] - row["tangential_force"] / row["cof"] if sticks else 0.0
    if load <= 0.0:
        return np.zeros_like(snapshot.pressure)
    # Wear of the step itself is in the gap, and not yet in the pressure.
    return np.minimum(contact_of(study, snapshot, load).pressure, snapshot.pressure)


def of_snapshot(
    study: Study, snapshot: Snapshot, row: Mapping[str, float], threads: int
) -> dict[str, FloatArray]:
    """Return the quantities of depths, and of a plane, at a snapshot: shapes (depths,) and (depths, n).

    The stress is that of the pressure and the traction of `traction_of`; a cycle turns the traction round
    under the pressure, which stays. Depths are done one after another: memory is that of one.
    """
    cells, fatigue, normal = study.cells, study.fatigue, study.output.stress_plane[0]
    names = [*MEASURES, *(OF_A_CYCLE if fatigue else ())]
    loads = [{"p": snapshot.pressure}, {"x": traction_of(study, snapshot, row)}]
    assert study.disc.poisson is not None  # or there is no half-space
    parts = [
        Loads(load, cells.cell, poisson=study.disc.poisson, boundary=study.boundary, threads=threads)
        for load in (loads if fatigue else [loads[0] | loads[1]])
    ]
    limit, tables = study.pair.yield_strength, {name: list[FloatArray]() for name in stress_columns(study)}
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
        numbers: dict[str, float | FloatArray] = {"depth": depth, "yielding": float(beyond)}
        for name, field in zip(names, fields, strict=True):
            i, j = np.unravel_index(int(field[0].argmax()), cells.shape)
            numbers |= {name: field[0, i, j], f"{name}_x": cells.x[i], f"{name}_y": cells.y[j]}
            numbers[f"{name}_plane"] = there.plane(field, normal)[0]
        for name, table in tables.items():
            table.append(np.asarray(numbers[name]))
    return {name: np.array(table) for name, table in tables.items()}


def of_run(
    study: Study, snapshots: Iterable[Snapshot], history: Mapping[str, FloatArray], threads: int
) -> dict[str, FloatArray]:
    """Return the quantities at all snapshots: shapes (snapshots, depths) and (snapshots, depths, n)."""
    tables = []
    for snapshot in snapshots:
        tables.append(of_snapshot(study, snapshot, _row_of(snapshot, history), threads))
    return {name: np.stack([table[name] for table in tables]) for name in stress_columns(study)}


def volume(study: Study, snapshot: Snapshot, history: Mapping[str, FloatArray]) -> Stresses:
    """Return the whole stress below the disc at a snapshot, as `of_run` has seen it depth by depth."""
    assert study.disc.poisson is not None  # or there is no half-space
    return stresses(
        snapshot.pressure,
        study.stress_depths,
        poisson=study.disc.poisson,
        traction=(traction_of(study, snapshot, _row_of(snapshot, history)), None),
        cell=study.cells.cell,
        boundary=study.boundary,
    )


def _row_of(snapshot: Snapshot, history: Mapping[str, FloatArray]) -> dict[str, float]:
    """Return the row of the history of a snapshot's step."""
    at = min(int(np.searchsorted(history["distance"], snapshot.distance)), history["cof"].size - 1)
    return {name: float(column[at]) for name, column in history.items()}
