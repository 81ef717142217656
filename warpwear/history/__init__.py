"""A step leaves a row of the history, and fields where they are asked for."""
