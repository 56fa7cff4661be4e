"""Mapping: lidar scans to a cloud of voxels in the map."""
