"""From measurements to unknowns of a study with their uncertainty, and to the test to make next."""
