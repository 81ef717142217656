"""Formats of other software, into which worn bodies and fields are written."""
