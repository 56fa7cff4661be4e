"""Keypoints on segments and what their surroundings look like: ISS and FPFH, by open3d."""

from collections.abc import Sequence

import numpy as np
import open3d as o3d
from executive_plugins.registration.features import Features
from scipy.spatial import cKDTree

from executive.arrays import Float
from executive.messages.segment import Segment

_NORMAL_NEIGHBOURS = 30
_FEATURE_NEIGHBOURS = 150


def _oriented(points: Float, voxel_m: float, normal_radius_m: float) -> o3d.geometry.PointCloud:
    """Thin one segment and give it normals away from its centroid: the same side in both maps,
    without gravity.
    """
    # open3d refuses read-only arrays, hence the copy
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(np.array(points))).voxel_down_sample(
        voxel_m
    )
    cloud.estimate_normals(
        o3d.geometry.KDTreeSearchParamHybrid(normal_radius_m, _NORMAL_NEIGHBOURS)
    )
    thinned, normals = np.asarray(cloud.points), np.asarray(cloud.normals)
    is_inwards = ((thinned - thinned.mean(axis=0)) * normals).sum(axis=1) < 0
    cloud.normals = o3d.utility.Vector3dVector(np.where(is_inwards[:, None], -normals, normals))
    return cloud


def describe(
    segments: Sequence[Segment], voxel_m: float, iss_radius_m: float, fpfh_radius_m: float
) -> Features:
    """Find ISS keypoints on segments and describe each by its FPFH (Mascaro 2020, Sec. 4.4 step 2).

    The paper prefers SHOT; FPFH is what open3d brings, and the constellation of segments makes up
    for it.
    """
    nothing = Features(np.empty((0, 3)), np.empty((0, 33)))
    if not segments:
        return nothing
    cloud = o3d.geometry.PointCloud()
    for segment in segments:
        cloud += _oriented(segment.points, voxel_m, iss_radius_m)
    keypoints = o3d.geometry.keypoint.compute_iss_keypoints(cloud, iss_radius_m, 0.8 * iss_radius_m)
    if not keypoints.points:
        return nothing
    chosen = cKDTree(np.asarray(cloud.points)).query(np.asarray(keypoints.points))[1]
    search = o3d.geometry.KDTreeSearchParamHybrid(fpfh_radius_m, _FEATURE_NEIGHBOURS)
    fpfh = o3d.pipelines.registration.compute_fpfh_feature(cloud, search, [int(i) for i in chosen])
    return Features(np.array(cloud.points)[chosen], np.asarray(fpfh.data).T.copy())
