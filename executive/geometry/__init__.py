"""Rigid-body geometry: rotations, poses, geodesy, splines."""
