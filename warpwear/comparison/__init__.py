"""Several runs, and experiments, side by side."""
