"""Files of measurements: friction records and surfaces."""
