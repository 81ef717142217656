"""A run from its study to its folder, whether or not it is killed on the way."""
