"""Declare and paint the pictures of one result."""
