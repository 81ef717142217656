"""Where kernels run: the device, its threads, its fields and the tiles of a field that are visited."""
