"""Kernels of what changes while a contact runs in beside its shape: films that wear breaks."""
