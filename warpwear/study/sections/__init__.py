"""Sections of a study that say laws, loads and the order of a test."""
