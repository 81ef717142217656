"""Formulas of contact, wear, junctions and tracks, in plain numbers: no device, no study."""
