"""Which approach carries the load: balances of local laws and the elastic-plastic half-space."""
