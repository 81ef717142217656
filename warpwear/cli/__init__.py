"""Parse the command line and call what it names."""
