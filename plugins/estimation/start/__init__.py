"""The first state: from a machine at rest or in motion, and the level of the chassis."""
