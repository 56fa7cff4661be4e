"""The control socket of a run: what people ask of a mission from another terminal."""
