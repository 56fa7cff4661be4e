"""Records of what really happened in the simulated world; only the oracle reads them."""
