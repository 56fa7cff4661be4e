"""The true surface of a site, to compare maps with."""

import numpy as np
from executive_plugins.robot.mujoco.site.ray_mesh import RayMesh, moved
from executive_plugins.robot.mujoco.site.site import Site
from executive_plugins.robot.mujoco.truth.truth_log import TruthLog

from executive.arrays import Float

_SAMPLE = 20_000  # points that are compared; more change the figures by less than a hundredth


def map_distances(points_map: Float, site: Site, log: TruthLog) -> dict[str, dict[str, float]]:
    """Return {"distance_m": {"median", "p95"}} of a map to the surface at the end of the run.

    Args:
        points_map: The map [m], shape (N, 3); of a large one every nth point is taken.
        site: Shapes of the ground and the stones.
        log: Poses of the stones.
    """
    if not len(points_map):
        return {}
    stones = [
        moved((stone.vertices, stone.triangles), log.T_world_stone(i, log.end_s))
        for i, stone in enumerate(site.stones)
    ]
    sample = points_map[:: max(1, len(points_map) // _SAMPLE)]
    distances = RayMesh([site.terrain.mesh(), *stones]).distances(sample)
    median, p95 = np.percentile(distances, [50, 95])
    return {"distance_m": {"median": float(median), "p95": float(p95)}}
