"""Geometry of rigid bodies and points: rotations, poses, fits, hulls, grids, geodesy."""
