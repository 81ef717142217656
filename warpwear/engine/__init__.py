"""Kernels run here: on a device, by its threads, over its fields and those tiles of them that are visited."""
