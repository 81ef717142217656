"""Patches share a load or carry what a smooth contact prescribes: these are the decisions of their steps."""
