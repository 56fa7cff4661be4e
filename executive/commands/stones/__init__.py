"""The verb on the stones that a run knows."""
