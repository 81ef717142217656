"""Passes and decisions of many steps, and of whole searches, on a GPU without a word to the host."""
