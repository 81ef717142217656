"""The figures of a run: what each shows, its data, when a run has none, how they are named and written."""
