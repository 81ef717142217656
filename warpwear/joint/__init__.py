"""What a finished contact conducts, how stiff it is, what leaks through it and how hot it gets is found here."""
