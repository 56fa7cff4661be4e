"""Keypoints and SHOT descriptors of segments, and their matches."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from executive_plugins.registration.features import Features
from executive_plugins.registration.iss import salient_points, surface_shapes
from executive_plugins.registration.neighbours import nearer, neighbours_within
from executive_plugins.registration.shot import SHOT_LENGTH, shot_descriptors
from executive_plugins.registration.thinning import thinned

from executive.arrays import Float, Int
from executive.messages.segment import Segment


@dataclass(frozen=True, slots=True, eq=False)
class Keypoints:
    """One segment's thinned points about its centroid [m], their outward normals, and the rows that
    stand out.
    """

    centroid: Float
    points: Float
    normals: Float
    rows: Int


def find_keypoints(
    segment: Segment, voxel_m: float, iss_radius_m: float, gap_m: float
) -> Keypoints:
    """Thin a segment and find its ISS keypoints (Mascaro 2020, Sec. 4.4 step 2).

    Args:
        segment: Any.
        voxel_m: Grid of the points [m].
        iss_radius_m: Salient radius R_iss, and that of normals [m].
        gap_m: A keypoint is the most salient point within this distance [m].
    """
    points = thinned(segment.points - segment.centroid, voxel_m)
    around = neighbours_within(points, points, iss_radius_m)
    normals, saliencies = surface_shapes(points, *around)
    if gap_m <= iss_radius_m:
        beside = nearer(points, *around, gap_m)
    else:
        beside = neighbours_within(points, points, gap_m)
    rows = salient_points(saliencies, *beside)
    return Keypoints(segment.centroid, points, normals, rows)


def describe_keypoints(segments: Sequence[Keypoints], radius_m: float) -> Features:
    """Describe keypoints by SHOT, each by points of its own segment only; shape (K, 352)."""
    coordinates, descriptors = [np.empty((0, 3))], [np.empty((0, SHOT_LENGTH))]
    for one in segments:
        around = neighbours_within(one.points, one.points[one.rows], radius_m)
        descriptors.append(shot_descriptors(one.points, one.normals, one.rows, around, radius_m)[0])
        coordinates.append(one.points[one.rows] + one.centroid)
    return Features(np.vstack(coordinates), np.vstack(descriptors))


def match_descriptors(target: Features, source: Features, most: int) -> tuple[Float, Float]:
    """Pair each source keypoint with the target's most alike, and keep the most alike pairs of all.

    Deviation from the paper's k-d tree (step 3), whose search among 352 axes visits nearly all: one
    matrix product.

    Returns:
        Coordinates of matched keypoints [m], target and source, each (M, 3), M ≤ `most`, best
        first.
    """
    if not len(target.points) or not len(source.points):
        return np.empty((0, 3)), np.empty((0, 3))
    likeness = source.descriptors.astype(np.float32) @ target.descriptors.astype(np.float32).T
    partners = likeness.argmax(axis=1)
    best = np.argsort(-likeness[np.arange(len(partners)), partners], kind="stable")[:most]
    return target.points[partners[best]], source.points[best]
