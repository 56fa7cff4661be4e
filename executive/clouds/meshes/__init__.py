"""Readers of triangle meshes: OBJ, PLY and STL."""
