"""Passes over the cells of a half-space contact: before a search, in it, and in its preconditioner."""
