"""What to compute: a study's keys, their units and rules, and the disc's surface."""
