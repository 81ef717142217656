"""What a finished contact conducts, how stiff it is, what leaks through it, how hot it gets: found here."""
