"""Read files of measurements: friction records and surfaces."""
