"""The search of the half-space solver on a GPU without a word to the host, pass by pass."""
