"""Stresses below a contact, from its pressure and its traction: responses, fields, measures."""
