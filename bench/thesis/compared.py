"""Every number that the report of the thesis compares, from its runs: one flat table of names and values.

Names are `version.quantity_unit`; what belongs to no version stands alone. NaN is what a run cannot say.
"""

import math

import numpy as np
import printed as thesis
import recomputed as plans
from coefficients import DIAMETER, WORK, depth_of_rim, patch, rim_at
from numpy.typing import NDArray
from printed import read
from recomputed import Runs

from warpwear import Result

FloatArray = NDArray[np.float64]
Numbers = dict[str, float]
#: Distance after which relative differences of areas no longer show single cells [mm].
SETTLED = 30.0
#: Numbers that are values of columns.
COLUMNS = read("numbers.toml")
#: Lengths of a patch along the surface.
EXTENTS = ("along", "across", "predicted_along", "predicted_across", "bound", "farthest")


def collect(runs: Runs) -> Numbers:
    """Find all numbers of a report: name -> value."""
    numbers: Numbers = {}
    for name in plans.VERSIONS:
        numbers |= {f"{name}.{key}": value for key, value in _of_version(runs[name]).items()}
    numbers |= {name: _change(runs, **entry) for name, entry in COLUMNS["change"].items()}
    numbers |= _smooth(runs) | _factor(runs) | _rough(runs) | _patches(runs)
    numbers |= _increments(runs) | _stability(runs) | calibration()
    return {name: float(value) for name, value in numbers.items()}


def _of_version(result: Result) -> Numbers:
    """Find what each version says of itself."""
    history, summary = result.history, result.summary
    first, end = ({name: values[row] for name, values in history.items()} for row in (0, -1))
    mean, radius = history["pressure_mean"], result.study.counter.radius
    total = end["wear_depth_counter"] + end["wear_depth_disc"]
    values_of_version = {
        "patch_by_area_mm": 2.0 * math.sqrt(end["area_touched"] / math.pi),
        # A ball and a flat whose middles have receded by so much meet at this rim; a paraboloid is wider.
        "patch_by_depth_mm": 2.0 * rim_at(total, radius=radius),
        "counter_volume_error": summary["conservation_relative"]["counter"],
        "disc_volume_error": summary["conservation_relative"]["disc"],
        "disc_volume_over_KFL": summary["disc_volume_over_KFL"] or math.nan,
        "area_30_mm2": np.interp(SETTLED, history["distance"], history["area_contact"]),
        "pressure_smallest_MPa": mean.min(),
        "pressure_largest_MPa": mean.max(),
        "pressure_scatter_MPa": mean.std(),
        "pressure_unevenness": end["pressure_std"] / end["pressure_mean"],
        "cof_first_over_end": first["cof"] / end["cof"],
    }
    values_of_version |= {name: first[column] for name, column in COLUMNS["first"].items()}
    for name, column in COLUMNS["last"].items():
        values_of_version[name] = 1e3 * end[column] if name.endswith("_um") else end[column]
    for area, prefix in (("contact", ""), ("touched", "touched_"), ("cumulative", "sum_")):
        values_of_version |= {f"{prefix}{key}": value for key, value in shape(result, area).items()}
    return values_of_version


def shape(result: Result, area: str) -> Numbers:
    """Find exponent m, levelling index λ and R² of a straight line of one area's growth."""
    distance, values = result.history["distance"], result.history[f"area_{area}"]
    late, total = distance >= 0.5 * distance[-1], distance[-1]
    slope = np.polyfit(np.log(distance[late]), np.log(values[late]), 1)[0]

    def secant(start: float, end: float) -> float:
        low, high = np.interp([start * total, end * total], distance, values)
        return float((high - low) / (end - start))

    levelling = secant(0.5, 1.0) / secant(1.0 / 80.0, 0.1) if distance[0] <= total / 80.0 else math.nan
    straight = straightness(distance, values)
    return {"exponent_m": slope, "levelling_lambda": levelling, "straightness_R2": straight}


def straightness(x: FloatArray, y: FloatArray) -> float:
    """Find R² of the straight line of least squares, each step weighted with its length."""
    weight = np.sqrt(np.diff(x, prepend=0.0))
    line = np.polyval(np.polyfit(x, y, 1, w=weight), x)
    spread = np.sum((weight * (y - np.average(y, weights=weight**2))) ** 2)
    return float(1.0 - np.sum((weight * (y - line)) ** 2) / spread) if spread else math.nan


def _change(runs: Runs, *, run: str, other: str, column: str) -> float:
    """Find by how much a column of a run ends above another run's, as a part of that one."""
    return float(runs[run].history[column][-1] / runs[other].history[column][-1] - 1.0)


def _settled(distance: FloatArray) -> NDArray[np.bool_]:
    """Tell which steps end where ratios are compared: from `SETTLED` on, or the last where none does."""
    return np.asarray(distance >= min(SETTLED, distance[-1]))


def _smooth(runs: Runs) -> Numbers:
    """Find what V1 says beside Hertz and closed forms."""
    v1 = runs["v1"]
    history, hertz = v1.history, v1.summary["hertz"]
    distance, mean = history["distance"], history["pressure_mean"]
    radius = np.sqrt(history["area_contact"] / np.pi)
    early = thesis.SLOWS_AFTER.value
    late = distance >= 0.5 * distance[-1]
    depth = history["wear_depth_disc"]
    return {
        "closed_form_patch_mm": 2.0 * plans.worn_radius(v1.study),
        "paraboloid_patch_mm": 2.0 * plans.worn_radius_of_paraboloid(v1.study),
        "hertz_peak_MPa": hertz["peak_pressure_MPa"],
        "hertz_area_mm2": hertz["area_mm2"],
        "v1.peak_over_hertz": history["pressure_max"][0] / hertz["peak_pressure_MPa"],
        "v1.area_over_hertz": history["area_contact"][0] / hertz["area_mm2"],
        "v1.pressure_fallen_early": (mean[0] - np.interp(early, distance, mean)) / (mean[0] - mean[-1]),
        "v1.radius_grown_early": np.interp(early, distance, radius) / radius[-1],
        "v1.depth_exponent": np.polyfit(np.log(distance[late]), np.log(depth[late]), 1)[0],
        "v1.volume_straightness_R2": straightness(distance, history["wear_volume_disc"]),
        "v2.volume_straightness_R2": straightness(distance, runs["v2"].history["wear_volume_disc"]),
    }


def _factor(runs: Runs) -> Numbers:
    """Find what the position-dependent sliding distance does: V2 beside V1."""
    v1, v2 = runs["v1"].history, runs["v2"].history
    study = runs["v2"].study
    pressure = runs["v2"].snapshot(-1).pressure
    middle = pressure.shape[0] // 2
    line = pressure[middle][pressure[middle] > 0.0]
    edge = 0.5 * v2["patch_across"][-1] - 0.5 * study.grid.cell
    cosine = math.sqrt(max(0.0, 1.0 - (edge / study.counter.radius) ** 2))
    counter, disc = study.wear_coefficients
    settled = _settled(v1["distance"])
    change = v2["cof"][settled] / v1["cof"][settled] - 1.0
    wear_1, wear_2 = (runs[name].snapshot(-1).wear_counter for name in ("v1", "v2"))
    return {
        "v2.factor_at_edge": cosine,
        # The chord of the contact, not of the ball: what a swept cell really sees.
        "v2.true_factor_at_edge": math.sqrt(max(0.0, 1.0 - (edge / (edge + 0.5 * study.grid.cell)) ** 2)),
        "v2.edge_pressure_excess": line[[0, -1]].mean() / line[line.size // 2] - 1.0,
        # Worn flat together, both bodies recede alike: p (K_s + K_d cos θ) is the same everywhere.
        "v2.edge_pressure_excess_expected": (counter + disc) / (counter + disc * cosine) - 1.0,
        "v2.cof_change_largest": np.abs(change).max(),
        "v2.skewness_um": 1e3 * np.abs(wear_2 - wear_2.T).max(),
        "v2.counter_change_um": 1e3 * np.abs(wear_2 - wear_1).max(),
    }


def _rough(runs: Runs) -> Numbers:
    """Find what roughness does: V3 and the fine model beside V1 and V2."""
    v1, v3, fine = (runs[name].history for name in ("v1", "v3", "fine"))
    low, high = (printed.value for printed in thesis.V3_PRESSURES)
    mean, cells = v3["pressure_mean"], v3["cells_in_contact"]
    rough, study = runs["v3"].study, runs["fine"].study
    hardness, load, tolerance = rough.contact.hardness, rough.contact.load, rough.stepping.load_tolerance
    numbers = {
        "v3.sum_over_worn_patch": v3["area_cumulative"][-1] / v1["area_contact"][-1],
        "v3.cof_over_v1": v3["cof"][-1] / v1["cof"][-1],
        "v3.pressures_within_printed": np.mean((mean >= low) & (mean <= high)),
        # Of p = F/A with |A H − F| within the tolerance, at any mesh.
        "v3.pressure_least_allowed_MPa": hardness * load / (load + tolerance),
        "v3.pressure_most_allowed_MPa": hardness * load / (load - tolerance),
        "v3.fewest_cells": cells.min(),
        "v3.most_cells": cells.max(),
        "v3.load_over_hardness_mm2": load / hardness,
        "fine.area_over_v1": fine["area_contact"][-1] / v1["area_contact"][-1],
        "fine.area_first_over_F_H": fine["area_contact"][0] * study.contact.hardness / study.contact.load,
    }
    for name, history in (("v1", v1), ("v3", v3)):
        numbers[f"{name}.counter_pattern_um"] = 1e3 * pattern(runs[name])
        numbers[f"{name}.mean_disc_depth_um"] = (
            1e3 * history["wear_volume_disc"][-1] / history["area_nominal"][-1]
        )
    return numbers


def pattern(result: Result) -> float:
    """Find the root mean square of the counter-body's wear about its own paraboloid, amid the patch [mm]."""
    wear = result.snapshot(-1).wear_counter
    reach = 0.35 * float(result.history["patch_along"][-1])
    x, y = np.meshgrid(result.x, result.y, indexing="ij")
    inside = x**2 + y**2 <= reach**2
    if inside.sum() < 10:
        return math.nan
    terms = np.column_stack([np.ones(int(inside.sum())), x[inside] ** 2, y[inside] ** 2])
    fitted, *_ = np.linalg.lstsq(terms, wear[inside], rcond=None)
    return float(np.sqrt(np.mean((wear[inside] - terms @ fitted) ** 2)))


def _patches(runs: Runs) -> Numbers:
    """Find what the patches on surfaces of different seeds have in common, and each of them."""
    patches, rough = runs.patches, runs["v3"].study

    def of(name: str) -> FloatArray:
        """List a field of every patch."""
        return np.array([p[name] for p in patches])

    measured = np.array([of("along"), of("across")])
    predicted = np.array([of("predicted_along"), of("predicted_across")])
    volumes = of("disc_volume") / runs["v2"].history["wear_volume_disc"][-1] - 1.0
    radius, smooth = rough.counter.radius, plans.worn_radius(rough)
    printed = 0.5 * thesis.PATCH_DIAMETERS["v3"].value
    height = depth_of_rim(printed, radius=radius) - depth_of_rim(smooth, radius=radius)
    numbers: Numbers = {
        "surfaces": len(patches),
        "surfaces.patch_mean_mm": float(np.mean(0.5 * (of("along") + of("across")))),
        "surfaces.prediction_error_mm": np.abs(measured - predicted).max(),
        "surfaces.bound_exceeded_mm": (measured - of("bound")).max(),
        "surfaces.peak_asked_um": 1e3 * height,
        "surfaces.cell_mm": rough.grid.cell,
    }
    for name, values in (
        ("patch_{}_mm", measured),
        ("farthest_{}_mm", of("farthest")),
        ("bound_{}_mm", of("bound")),
        ("peak_{}_um", 1e3 * of("peak")),
        ("disc_volume_over_v2_{}", volumes),
    ):
        numbers[f"surfaces.{name.format('smallest')}"] = values.min()
        numbers[f"surfaces.{name.format('largest')}"] = values.max()
    for p in patches:
        numbers |= {f"surface_{p['seed']}.{name}_mm": p[name] for name in EXTENTS}
        numbers[f"surface_{p['seed']}.peak_um"] = 1e3 * p["peak"]
    return numbers


def _increments(runs: Runs) -> Numbers:
    """Find where V1 with implicit wear ends for each increment."""
    numbers: Numbers = {}
    deviations = []
    for increment in runs.plan.increments:
        run = plans.IMPLICIT.format(increment)
        for key, column in (("area_end_mm2", "area_contact"), ("disc_depth_mm", "wear_depth_disc")):
            numbers[f"implicit_{increment:g}.{key}"] = runs[run].history[column][-1]
            deviations.append(abs(_change(runs, run=run, other="v1", column=column)))
    return numbers | {"implicit.largest_deviation": max(deviations)}


def _stability(runs: Runs) -> Numbers:
    """Find what explicit wear beyond its limit does, beside a stable run."""
    beyond, steady = runs["beyond"].history, runs["steady"].history
    ratio = beyond["area_contact"] / np.interp(beyond["distance"], steady["distance"], steady["area_contact"])
    low = ratio[_settled(beyond["distance"])] - 1.0
    return {
        "beyond.limit_mm": stable_increment(runs["beyond"]),
        "beyond.increment_mm": runs["beyond"].study.stepping.increment,
        "v1.limit_mm": stable_increment(runs["v1"]),
        "beyond.area_last": low[-1],
        "beyond.area_mean": low.mean(),
        "beyond.area_lowest": low.min(),
        "beyond.area_highest": low.max(),
        "beyond.pressure_unevenness": beyond["pressure_std"][-1] / beyond["pressure_mean"][-1],
    }


def stable_increment(result: Result) -> float:
    """Find the largest stable increment of explicit wear on a foundation K_N, 2/(K_N K) [mm]."""
    wear = sum(result.study.wear_coefficients)
    return float(2.0 / result.summary["foundation_N_per_mm3"] / wear)


def calibration() -> Numbers:
    """Find what the printed patch of the ball and the printed wear coefficients say of each other."""
    worn = patch()
    by_cap, groove = worn["by_cap_mm3_per_Nm"], 1e-3 * thesis.WEAR_COEFFICIENTS["disc"].value * WORK
    return {
        "experiment.K_by_cap": by_cap,
        "experiment.K_by_ellipsoid": worn["by_ellipsoid_mm3_per_Nm"],
        "experiment.K_over_cap": worn["printed_mm3_per_Nm"] / by_cap,
        "experiment.patch_of_printed_K_mm": worn["diameter_asked_for_mm"],
        # A groove with the profile of a parabola, as wide as the patch and as long as the stroke.
        "experiment.groove_depth_um": 1e3 * 1.5 * groove / (DIAMETER.value * thesis.STROKE.value),
        "experiment.distance_by_strokes_mm": thesis.STROKE.value * thesis.PASSES.value,
    }
