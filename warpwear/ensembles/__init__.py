"""Runs, points of a sweep and measured records beside each other: one table, one set of figures, one page."""
