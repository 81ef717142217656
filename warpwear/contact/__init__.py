"""The approach that carries the load is found here, by local laws and on the elastic-plastic half-space."""
