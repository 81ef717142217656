"""The thesis that these models come from: its numbers, and whether ours agree."""
