"""Steps of patches that share the load of a two-scale contact."""
