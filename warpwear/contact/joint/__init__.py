"""What leaks through a finished contact, and how hot it gets, is found here."""
