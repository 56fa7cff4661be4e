"""Lengths that tell stones from what is none, for one machine and the spacing of one cloud."""

from dataclasses import dataclass

from executive_plugins.segmentation.settings import GroundAndClustersSettings
from executive_plugins.segmentation.stone_sizes import StoneSizes

_LEAST_POINTS = 10  # of an object, however coarse the cloud
_CELLS = 4  # grid edges across the smallest object


@dataclass(frozen=True, slots=True)
class Limits:
    """Grids and sizes; all lengths in m.

    Attributes:
        voxel_m: Grid edge of the clustering.
        fine_voxel_m: Grid edge on which neighbours are parted.
        cell_m: Grid edge of the view from above.
        patch_m: Grid edge of compared patches.
        least_points: Fewest points of an object.
        least_extent_m: Smallest longest side of a stone.
        least_height_m: Smallest height of a stone.
        most_extent_m: Largest longest side of a stone.
        most_width_m: Largest shortest side of a stone.
        heap_m: Largest width of a heap.
    """

    voxel_m: float
    fine_voxel_m: float
    cell_m: float
    patch_m: float
    least_points: int
    least_extent_m: float
    least_height_m: float
    most_extent_m: float
    most_width_m: float
    heap_m: float


def limits_for(
    settings: GroundAndClustersSettings, sizes: StoneSizes, spacing_m: float = 0.0
) -> Limits:
    """Return the limits; grids become coarser where points are farther apart than a voxel."""
    s, factor = settings, max(1.0, spacing_m / settings.voxel_m)
    least_m = sizes.least_m if s.min_extent_m is None else s.min_extent_m
    height_m = s.plane_margin_m + 2 * s.flat_margin_m if s.min_height_m is None else s.min_height_m
    return Limits(
        voxel_m=factor * s.voxel_m,
        fine_voxel_m=factor * s.fine_voxel_m,
        cell_m=factor * s.cell_m,
        patch_m=factor * s.patch_m,
        least_points=max(int(s.min_points / factor**2), min(_LEAST_POINTS, s.min_points)),
        least_extent_m=max(least_m, _CELLS * spacing_m) if factor > 1 else least_m,
        least_height_m=height_m,
        most_extent_m=sizes.most_m if s.max_extent_m is None else s.max_extent_m,
        most_width_m=sizes.width_m,
        heap_m=sizes.heap_m,
    )
