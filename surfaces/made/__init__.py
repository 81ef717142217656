"""Surfaces made from formulas: flat, self-affine, milled."""
