"""The ball that slides over a track: a finer step, and runs on a representative and on the whole track."""

import time

from contenders.roster import DisagreementError, Setting, named
from measure.timing import Row, Unit

import warpwear
from warpwear import Study

#: Relative difference allowed of Archard's volumes.
EXACT = 1.0e-9
#: Distance of a quick run [mm].
QUICK = 60.0


def run_track(_: int, setting: Setting) -> list[Row]:
    """The whole of track: 16,000 steps of 750² cells on a representative track of 3.2 mm."""
    return [_whole("track", Study.load("track"), setting)]


def run_full_pass(_: int, setting: Setting) -> list[Row]:
    """One pass of the whole 30 mm track at 1 µm: 3750 steps of 1500² cells, a disc of 47 million."""
    study = Study.load("track").replace({"grid.cell": "1 um", "sliding.track": "full"})
    return [_whole("track-pass", study.replace({"sliding.distance": "30 mm"}), setting)]


def run_full(_: int, setting: Setting) -> list[Row]:
    """The whole reference test on the whole 30 mm track at 1 µm: 300,000 steps of 1500² cells."""
    study = Study.load("track").replace({"grid.cell": "1 um", "sliding.track": "full"})
    return [_whole("gpu-track", study, setting)]


def _whole(case: str, study: Study, setting: Setting) -> Row:
    """One run, once: steps alone, and all of it in the note. Raises DisagreementError for other volumes."""
    study = study.replace({"output.snapshots": []})
    if setting.quick:
        study = study.replace({"sliding.distance": f"{min(QUICK, study.sliding.total)} mm"})
    short = study.replace({"sliding.distance": "0.2 mm", "sliding.track": "3.2 mm"})
    warpwear.run(short, device=setting.device)  # compiled
    unit = Unit(study.cells.nx)
    one_pass = unit.seconds()
    start = time.perf_counter()
    with warpwear.run(study, device=setting.device, threads=max(setting.threads)) as result:
        took = time.perf_counter() - start
        steps, elapsed = result.history["distance"].size, float(result.record["elapsed_s"])
        off = max(abs(value) for value in result.summary["conservation_relative"].values())
        area = float(result.summary["area_mm2"]["contact"])
    if not off <= EXACT:
        raise DisagreementError(f"{case}: the volumes are off Archard's by {off:.2g}")
    note = (
        f"{steps} steps, {1e6 * elapsed / steps:.0f} µs each, {took:.1f} s with surface and result; "
        f"area {area:.4g} mm² over the last pass, volumes to {off:.1g}"
    )
    name = named(max(setting.threads)) if setting.device == "cpu" else f"warpwear on {setting.device}"
    return Row(case, study.cells.nx, name, [elapsed], [one_pass], note, {"whole_s": took, "steps": steps})
