"""Drafts are commented studies of common rigs, which `warpwear new` fills in."""
