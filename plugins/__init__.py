"""The shipped plugins: one folder a capability, in the order of the data."""
