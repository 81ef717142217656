"""Run a study over a design of its keys, on one machine or a cluster, as a table and bands."""
