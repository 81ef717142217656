"""A wear coefficient as text for people and as a record."""

from typing import Any

from warpwear.calibrate_options import scientific
from warpwear.calibration import WearCalibration, WornVolume


def record_of(found: WearCalibration, *, relation: str, worn: str | None) -> dict[str, Any]:
    """A wear coefficient, JSON-ready. relation: how the volumes were found; worn: the body, if it is told."""

    def per_nm(value: float | None) -> float | None:
        return None if value is None else 1e3 * value

    factor = 1.0 / (found.load * found.distance)
    return {
        "relation": relation,
        "worn": worn,
        "load_N": found.load,
        "distance_mm": found.distance,
        "wear_coefficient_mm3_per_Nm": per_nm(found.mean),
        "uncertainty_mm3_per_Nm": per_nm(found.uncertainty),
        "wear_coefficient_per_Pa": 1e-6 * found.mean,
        "hardness_MPa": found.hardness,
        "wear_coefficient_dimensionless": found.dimensionless,
        "count": len(found.volumes),
        "standard_deviation_mm3_per_Nm": per_nm(found.deviation),
        "standard_error_mm3_per_Nm": per_nm(found.standard_error),
        "uses": "exact",
        "tests": [
            {
                "measured": v.measured,
                "depth_um": None if v.depth is None else 1e3 * v.depth,
                "volume_mm3": v.volume,
                "volume_uncertainty_mm3": v.error,
                "uncertainty_from": v.error_from,
                "volume_by_approximation_mm3": v.approximate,
                "wear_coefficient_mm3_per_Nm": per_nm(value),
                "uncertainty_mm3_per_Nm": per_nm(error),
                "by_approximation_mm3_per_Nm": per_nm(
                    None if v.approximate is None else v.approximate * factor
                ),
            }
            for v, value, error in zip(found.volumes, found.values, found.errors, strict=True)
        ],
    }


def page(found: WearCalibration, *, relation: str, worn: str | None) -> str:
    """The same for people."""
    work = 1e-3 * found.load * found.distance
    lines = [
        f"wear coefficient K = V/(F L): {found.load:g} N over {found.distance:g} mm, F L = {work:.5g} N·m",
        f"  from             {relation}",
    ]
    for worn_volume, value, error in zip(found.volumes, found.values, found.errors, strict=True):
        lines += _test_lines(worn_volume, value=value, error=error, work=work)
    count, many = len(found.volumes), len(found.volumes) > 1
    if found.deviation is not None:
        lines.append(
            f"  of {count} tests       standard deviation {scientific(1e3 * found.deviation, digits=2)} "
            f"({found.deviation / found.mean:.2g} of the mean); below ± the standard error of the mean"
        )
    known = found.uncertainty
    plus = (
        f" (standard {'error' if many else 'uncertainty'}, {known / found.mean:.2g} of K)"
        if known is not None
        else "; its uncertainty is unknown"
    )
    lines += [
        f"  K                {scientific(1e3 * found.mean, None if known is None else 1e3 * known)} "
        f"mm³/(N·m){plus}",
        f"                   {scientific(1e-6 * found.mean)} m²/N (Pa⁻¹)",
    ]
    if found.dimensionless is not None:
        lines.append(
            f"                   {scientific(found.dimensionless)} dimensionless, with the hardness "
            f"{found.hardness:g} MPa (V = k F L/H)"
        )
    lines.append(
        f'  in a study       [wear] {worn or "sphere or disc"} = "{scientific(1e3 * found.mean)} mm^3/N/m"'
    )
    return "\n".join(lines)


def _test_lines(worn: WornVolume, *, value: float, error: float | None, work: float) -> list[str]:
    plus = f" ± {worn.error:.2g}" if worn.error is not None else ""
    depth = "" if worn.depth is None else f", {1e3 * worn.depth:.4g} µm deep"
    of_k = scientific(1e3 * value, None if error is None else 1e3 * error)
    lines = [
        f"  measured         {worn.measured}{depth}",
        f"    volume         {worn.volume:.5g}{plus} mm³: K {of_k}",
        f"    uncertainty    {worn.error_from}",
    ]
    if worn.approximate is not None:
        lines.append(
            f"    approximation  {worn.approximate:.5g} mm³ for a small scar: K "
            f"{scientific(worn.approximate / work)}, {worn.approximate / worn.volume - 1.0:+.2%}; "
            "not used, K is of the exact volume"
        )
    if worn.error is not None and worn.error > worn.volume / 3.0:
        lines.append("    warning        the volume is within three standard uncertainties of nothing")
    return lines
