"""The version of this package, and of what its numbers depend on."""

__version__ = "0.1.0"
