"""Profiles are read, described by the parameters of ISO 21920, and a groove is measured in them."""
