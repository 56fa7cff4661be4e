"""Leaves of the tree: read the mission's store, call one interface, write the store."""
