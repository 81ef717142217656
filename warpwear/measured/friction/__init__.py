"""What a record of friction says: its laps, its levels and jumps, its report."""
