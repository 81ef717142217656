"""What pressures do to an elastic–plastic half-space is computed here, and a contact's pressure found."""
