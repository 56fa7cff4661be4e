"""The cloud that a map of voxels gives."""

from executive_plugins.mapping.cylinder import Cylinder
from executive_plugins.mapping.settings import MapSettings
from executive_plugins.mapping.voxel_grid import VoxelGrid

from executive.geometry.voxels import voxel_means
from executive.messages.cloud import Cloud


def cloud_of(grid: VoxelGrid, settings: MapSettings, cylinder: Cylinder) -> Cloud:
    """Return one point for each occupied voxel in the cylinder, in order of the voxels.

    Range noise is smoothed if `smoothing_m` is positive.
    """
    points, counts = grid.surface(settings.smoothing_m) if settings.smoothing_m else grid.points()
    points = points[(counts >= settings.min_points) & cylinder.contains(points)]
    return Cloud("map", voxel_means(points, settings.voxel_m))
