"""Decisions of a contact of patches: how they share a load, what a smooth contact prescribes, whole steps."""
