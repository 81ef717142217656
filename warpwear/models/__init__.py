"""One step of each arrangement: a disc at rest, a disc with a track, patches of two scales."""
