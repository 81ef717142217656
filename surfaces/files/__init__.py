"""Layouts of single formats of heights, and what they may declare."""
