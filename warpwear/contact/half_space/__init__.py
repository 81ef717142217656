"""The elastic–plastic half-space: what pressures do to it, and the search for the pressure of a contact."""
