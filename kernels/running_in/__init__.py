"""Kernels of what changes while a contact runs in: films that wear breaks, wear in pieces."""
