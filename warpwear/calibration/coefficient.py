"""The wear coefficient K = V/(F L) of one worn body, from one kind of measurement in one test or several."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from warpwear.calibration.measurements import Tests, Value, checked_tests
from warpwear.calibration.repeated import Repeated
from warpwear.calibration.wear import LARGEST, WornVolume, mean_of_places, wear_coefficient
from warpwear.calibration.worn import SOURCES, TEXTS, sources_of, worn_volume
from warpwear.errors import InputError, named_in_python
from warpwear.measured.options import optional
from warpwear.results.report import Row, scientific, times


@dataclass(frozen=True, kw_only=True, repr=False)
class WearCalibration(Repeated):
    """Wear coefficients K [mm²/N] (1e-3 mm³/(N·m), 1e-6 Pa) of one worn body, of one or several tests.

    `mean` is the mean K [mm²/N], times 1000 in mm³/(N·m). Give a study the unit: `in_study`, or the whole.

    Attributes
    ----------
    volumes : tuple of WornVolume
        One a test, with its uncertainty, its depth, and how it was found.
    loads, distances : tuple of Value
        Normal load [N] and sliding distance [mm] of each test, ``(value, error)``.
    hardness : float or None
        Hardness [MPa] of the dimensionless coefficient.
    relation, worn : str
        How the volumes follow from what was measured, and the body that has worn; None where `volume` does
        not say which body.
    """

    volumes: tuple[WornVolume, ...]
    loads: tuple[Value, ...]
    distances: tuple[Value, ...]
    hardness: float | None = None
    relation: str = ""
    worn: str | None = None

    def __post_init__(self) -> None:
        for value, load, distance in zip(self.values, self.loads, self.distances, strict=True):
            if not 1.0 / LARGEST < value < LARGEST:
                raise InputError(
                    f"load {load.value:g} N and distance {distance.value:g} mm make a wear coefficient of "
                    f"{value:g} mm²/N: allowed is {1.0 / LARGEST:g} to {LARGEST:g}"
                )

    @cached_property
    def _each(self) -> list[Value]:
        return [*map(wear_coefficient, self.volumes, self.loads, self.distances)]

    @property
    def values(self) -> tuple[float, ...]:
        """Give K of every test [mm²/N]."""
        return tuple(value for value, *_ in self._each)

    @property
    def errors(self) -> tuple[float | None, ...]:
        """Give K's standard uncertainty of every test [mm²/N], from those of volume, load and distance."""
        return tuple(error for _, error, _ in self._each)

    @property
    def dimensionless(self) -> float | None:
        """Return k of V = k F L/H (thesis eq 4.12), None without a hardness."""
        return None if self.hardness is None else self.mean * self.hardness

    @property
    def in_study(self) -> str:
        """Return K as a study takes it, with its unit; `Study.replace` takes it of the calibration itself."""
        return f"{1e3 * self.mean!r} mm^3/N/m"

    def _title(self) -> str:
        works = {f.value * d.value for f, d in zip(self.loads, self.distances, strict=True)}
        work = f", F L = {1e-3 * works.pop():.5g} N·m" if len(works) == 1 else ""
        return f"wear coefficient K = V/(F L){work}"

    def __repr__(self) -> str:
        return f"<wear coefficient K = {_k('', self.mean, self.uncertainty).text}, tests: {len(self.values)}>"

    def _rows(self) -> list[Row]:
        count, deviation, error = len(self.volumes), self.deviation, self.uncertainty
        note, scatter, by_hardness = "; its uncertainty is unknown", "", ""
        if error is not None:
            kind = f"error{self.scatter.source}" if count > 1 else "uncertainty"
            note = f"(standard {kind}, {error / self.mean:.2g} of K)"
        if deviation is not None:
            scatter = f"standard deviation of {count} tests ({deviation / self.mean:.2g} of the mean)"
        if self.hardness:
            by_hardness = f"dimensionless, with the hardness {self.hardness:g} MPa (V = k F L/H)"
        spread, k = times(1e3, deviation), self.dimensionless
        in_study = f'[wear] {self.worn or "counter or disc"} = "{scientific(1e3 * self.mean)} mm^3/N/m"'
        return [
            Row("from", "relation", self.relation),
            Row("", "worn", self.worn),
            _alike("load F", "load_N", self.loads),
            _alike("distance L", "distance_mm", self.distances),
            _k("K", self.mean, error, note=note),
            Row("  or", "wear_coefficient_per_Pa", 1e-6 * self.mean, scientific=True),
            Row("", "hardness_MPa", self.hardness),
            Row("  or", "wear_coefficient_dimensionless", k, note=by_hardness, scientific=True),
            Row("", "count", count),
            Row("scatter", "standard_deviation_mm3_per_Nm", spread, digits=2, note=scatter, scientific=True),
            Row("", "standard_error_mm3_per_Nm", times(1e3, error) if count > 1 else None),
            *self._weighted("_mm3_per_Nm", factor=1e3, scientific=True),
            *self._worst("mm³/(N·m)", 1e3),
            Row("", "uses", "exact"),
            Row("in a study", "", in_study),
            Row("", "tests", self._table()),
        ]

    def _table(self) -> list[list[Row]]:
        return [self._row(test) for test in range(len(self.volumes))]

    def _row(self, test: int) -> list[Row]:
        """Declare one of the tests."""
        worn, note, worn_too = self.volumes[test], "", ""
        per_work = self.values[test] / worn.volume
        small, bulging = (times(1e3, times(per_work, v)) for v in (worn.approximate, worn.bulging))
        if small is not None and worn.approximate is not None:
            change = f"{worn.approximate / worn.volume - 1.0:+.2%}"
            note = f"for a small scar: K {scientific(small)}, {change}; not used, K is of the exact volume"
        if bulging is not None:
            worn_too = (
                f"by π d₁³ d₂/(64 R): K {scientific(bulging)}, if the longer diameter d₂ lies across "
                "sliding: the scar is then no cap"
            )
        error = "volume_uncertainty_mm3", worn.error
        work = (("  load", "load_N", self.loads), ("  distance", "distance_mm", self.distances))
        return [
            Row("measured", "measured", worn.measured),
            *(Row(name, key, of[test].value, digits=6) for name, key, of in work if len({*of}) > 1),
            Row("  depth", "depth_um", times(1e3, worn.depth)),
            Row("  volume", "volume_mm3", worn.volume, digits=5, error=error),
            Row("  uncertainty", "uncertainty_from", worn.error_from),
            Row("  approximation", "volume_by_approximation_mm3", worn.approximate, digits=5, note=note),
            _k("  K", self.values[test], self.errors[test]),
            Row("", "by_approximation_mm3_per_Nm", small),
            Row("  disc worn, too", "volume_of_bulging_scar_mm3", worn.bulging, digits=5, note=worn_too),
            Row("", "of_bulging_scar_mm3_per_Nm", bulging),
            Row("  warning", "", worn.doubt),
        ]


def _alike(label: str, key: str, values: tuple[Value, ...]) -> Row:
    """Declare what tests have alike; in JSON a list where they differ, which people read of each test."""
    value, error, _ = values[0]
    if len({*values}) > 1:
        return Row("", key, [each.value for each in values])
    key_of_error = key.replace("_", "_uncertainty_") if error is not None else ""
    return Row(label, key, value, digits=6, error=(key_of_error, error))


def _k(label: str, value: float, error: float | None, *, note: str = "") -> Row:
    """Declare a wear coefficient and its standard uncertainty [mm²/N]."""
    key, uncertainty = "wear_coefficient_mm3_per_Nm", ("uncertainty_mm3_per_Nm", times(1e3, error))
    return Row(label, key, 1e3 * value, error=uncertainty, note=note, scientific=True)


@named_in_python()
def calibrate_wear(
    tests: Tests,
    *,
    source: str | None = None,
    standard: str | None = None,
    hardness: Any = None,
    preparation: Mapping[str, Any] | None = None,
    **alike: Any,
) -> WearCalibration:
    """Find the wear coefficient K = V/(F L) of a worn body from one kind of measurement.

    Parameters
    ----------
    tests : list of dict, or path
        One a test: what was measured in it, such as ``{"volume": "0.018 +- 0.001 mm^3"}``, with its load and
        distance. The keys are those of ``[[test]]``, which docs/reference/keys.md explains: volume,
        volume_counter, volume_disc, scar, width, section, profile, after or ball, and the lengths that these
        need. A path is that of a TOML file with such a list, maybe in a study, whose load, distance and ball
        are then those of the tests without their own.
    source : str, optional
        Which of several kinds of measurement to take, such as ``"scar"``.
    standard : {"g99-ball", "g99-disc", "g133-ball", "g133-flat"}, optional
        The ASTM test method.
    hardness : str, optional
        For the dimensionless coefficient, such as ``"590 MPa"``.
    preparation : dict, optional
        Keys of ``[disc]``, as text, that say how measured files are read, such as ``{"pixel": "3 um"}``.
    **alike
        Keys that all tests have alike, such as ``load="8 N"``.

    Returns
    -------
    WearCalibration
        K of each test, their mean, scatter and uncertainty. Under a flat prior and with normal errors,
        `weighted` is mean and deviation of the posterior of K.

    Raises
    ------
    InputError
        For what is missing, does not go together, or makes no wear coefficient.

    References
    ----------
    J. F. Archard, Contact and rubbing of flat surfaces, Journal of Applied Physics 24 (1953) 981-988. ASTM
    G99 and G133.

    Examples
    --------
    >>> volumes = [{"volume": "0.018 +- 0.001 mm^3"}, {"volume": "0.021 +- 0.001 mm^3"}]
    >>> warpwear.calibrate_wear(tests=volumes, load="8 N", distance="2400 mm")
    <wear coefficient K = (1.016 ± 0.078)e-3 mm³/(N·m), tests: 2>
    """
    if source not in (None, *SOURCES):
        raise InputError(f"--source = {source!r} is not allowed; allowed: {', '.join(SOURCES)}")
    checked = checked_tests(tests, **alike)
    every = ((named, name) for named, test in checked.items() for name in sources_of(test))
    measured = [(named, name) for named, name in every if source in (None, name)]
    labels: dict[str, str] = {}
    for named, name in measured:
        labels.setdefault(name, f"{named}.{name}")
    if not labels:
        raise InputError(f"what was measured is missing: one of {', '.join(SOURCES)}")
    name, *others = labels
    if others:
        why = "exclude each other: a wear coefficient has one source; name it by --source"
        raise InputError(f"{' and '.join(labels.values())} {why}")
    relation = SOURCES[name].relation
    if standard is not None:
        if (method := TEXTS["standards"].get(standard)) is None:
            raise InputError(f"--standard is {standard!r}: allowed is one of {', '.join(TEXTS['standards'])}")
        if name != method["source"]:
            raise InputError(f"--standard {standard} is for {method['source']}, not {labels[name]}")
        relation = method["relation"]
    elif name == "scar" and all(len(test.scar) > 1 for test in checked.values() if test.scar):
        relation = TEXTS["two_diameters"]["relation"]
    taken = {named: checked[named] for named, _ in measured}
    for named, test in taken.items():
        for key, what in (("load", "the normal load, such as '8 N'"), ("distance", "such as '2400 mm'")):
            if getattr(test, key) is None:
                raise InputError(f"{named}.{key} is missing: {what}")
    places: dict[str, list[WornVolume]] = {}
    for named, test in taken.items():
        worn = worn_volume(test, name, named, preparation=preparation or {})
        places.setdefault(test.name or named, []).append(worn)
    single = {test.name or named: test for named, test in taken.items()}.values()
    return WearCalibration(
        volumes=tuple(mean_of_places(volumes) for volumes in places.values()),
        loads=tuple(test.load for test in single if test.load),
        distances=tuple(test.distance for test in single if test.distance),
        hardness=optional("--hardness", hardness, "MPa"),
        relation=relation,
        worn=SOURCES[name].worn,
    )
