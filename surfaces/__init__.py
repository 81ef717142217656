"""Surfaces are heights in millimetres at any points, from formulae or measurements."""

if __name__ != "warpwear.surfaces":
    raise ImportError("import this package as warpwear.surfaces")
