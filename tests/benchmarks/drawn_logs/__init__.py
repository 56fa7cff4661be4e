"""Logs drawn at random: bodies, motions and sensors that no constant was chosen on."""
