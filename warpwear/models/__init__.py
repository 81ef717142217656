"""Each arrangement has a step of its own: a disc at rest, a disc with a track, patches of two scales."""
