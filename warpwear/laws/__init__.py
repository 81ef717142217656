"""Formulas of contact, wear, junctions and tracks get plain numbers: no device, no study."""
