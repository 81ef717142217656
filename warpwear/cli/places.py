"""What commands call, by name: imported when a command needs it, so that every `--help` stays quick."""

from typing import Any

from warpwear.lazy import resolve

#: Name -> module:object.
PLACES = {
    "Result": "warpwear.result:Result",
    "Study": "warpwear.study.study:Study",
    "SurfaceOptions": "warpwear.measured.surface_command:SurfaceOptions",
    "WRITERS": "warpwear.results.export:WRITERS",
    "WearOptions": "warpwear.calibration.wear_command:WearOptions",
    "animate_result": "warpwear.figures.film:animate",
    "calibrate_energy": "warpwear.calibration.energy:calibrate_energy",
    "calibrate_friction": "warpwear.calibration.friction_command:calibrate_friction",
    "calibrate_thesis": "warpwear.thesis.coefficients:calibrate_thesis",
    "calibrate_wear": "warpwear.calibration.wear_command:calibrate_wear",
    "check_number": "warpwear.comparison.gather:check_number",
    "check_out": "warpwear.comparison.folder:check_out",
    "describe": "warpwear.measured.surface_command:describe",
    "export": "warpwear.results.export:export",
    "gather": "warpwear.comparison.gather:gather",
    "holds_checkpoint": "warpwear.runs.checkpoint:holds_checkpoint",
    "is_finished": "warpwear.runs.folder:is_finished",
    "material": "warpwear.study.materials:material",
    "names": "warpwear.study.materials:names",
    "presets": "warpwear.study.loading:presets",
    "run_study": "warpwear.runs.run:run",
    "summary_text": "warpwear.results.summary_text:summary_text",
    "thesis_report": "warpwear.thesis.report:thesis_report",
    "thesis_speeds": "warpwear.thesis.printed:SPEEDS",
    "to_marked_toml": "warpwear.study.text:to_marked_toml",
    "to_text": "warpwear.comparison.table:to_text",
    "write": "warpwear.comparison.folder:write",
}


def heavy(name: str) -> Any:
    """Return the object of a name in PLACES; its module, and all that it needs, are imported now."""
    return resolve(PLACES[name])
