"""What commands call, by module: imported when a command needs it, so that every `--help` stays quick."""

from warpwear.lazy import module

calibrations = module("warpwear.calibration.commands")
compared = module("warpwear.comparison.compare")
comparison_table = module("warpwear.comparison.table")
drafts = module("warpwear.drafts.draft")
energy_of_test = module("warpwear.calibration.energy")
inference_command = module("warpwear.calibration.bayes.command")
loop_of_test = module("warpwear.calibration.loop")
known = module("warpwear.drafts.known")
measured = module("warpwear.measured.surface")
options = module("warpwear.measured.options")
records = module("warpwear.measured.friction.record")
repeated_tests = module("warpwear.calibration.repeats")
reports = module("warpwear.measured.report")
results = module("warpwear.result")
run_checkpoint = module("warpwear.runs.checkpoint")
runner = module("warpwear.runs.run")
study_files = module("warpwear.study.loading")
study_types = module("warpwear.study.study")
sweep_command = module("warpwear.sweeps.command")
written = module("warpwear.results.report")
