"""What a run left: its file, and the numbers and tables made of it."""
