"""Signs that a cloud is no site in metres with z up."""

from collections.abc import Sequence

import numpy as np
from executive_plugins.segmentation.ground_plane import plane_heights
from executive_plugins.segmentation.lower_cone import Relief
from executive_plugins.segmentation.shape import counts_near, planes_through

from executive.arrays import Float
from executive.messages.segment import LeftOut, PartKind

_SAMPLE = 2000  # points that are looked at
_PLANES = 100  # that are tried through them
_OTHER = 1.3  # share of points on another plane, in that on the ground, which is a sign
_LEAST_RISEN = 0.01  # share of the area that rises, below which nothing tells up from down
_LEAST_GROUND = 0.25  # share of the points near the ground: less is no site of stones
_FEW = 3  # things that are too large, below which nothing is said of the unit
_FOOT_M = 0.3048
_LARGE = (PartKind.TOO_LARGE, PartKind.STACK)
Warnings = tuple[str, ...]


def site_warnings(
    points: Float,
    plane: Float,
    heights: Float,
    relief: Relief,
    margin_m: float,
    rng: np.random.Generator,
) -> Warnings:
    """Say what speaks against a cloud being a site with z up; nothing if all is well.

    Args:
        points: A sample of the cloud [m], shape (N, 3).
        plane: The ground's mean plane, shape (4,).
        heights: Of the sample above the ground [m], shape (N,).
        relief: What is steeper than ground.
        margin_m: Height up to which points are ground [m].
        rng: The only source of chance.
    """
    found = []
    some = np.ascontiguousarray(points[:: max(len(points) // _SAMPLE, 1)])
    on_ground = int((np.abs(plane_heights(some, plane)) < margin_m).sum())
    planes = planes_through(some, rng.integers(len(some), size=(3, _PLANES)))
    counts = counts_near(some, planes, margin_m)
    if len(counts) and counts.max() > _OTHER * on_ground:
        best = planes[int(np.argmax(counts))]
        tilt = np.degrees(np.arccos(min(float(np.abs(best[2])), 1.0)))
        found.append(
            f"a plane tilted by {tilt:.0f} deg holds {counts.max() / len(some):.0%} of the points, "
            f"the ground that was found {on_ground / len(some):.0%}: is z up?"
        )
    if relief.rising > max(relief.sinking, _LEAST_RISEN):
        found.append(
            f"it shows hollows ({relief.sinking:.0%} of its area, between edges of "
            f"{relief.rising:.0%}) where a site shows stones on the ground: is z down?"
        )
    near = float((np.abs(heights) < margin_m).mean())
    if near < _LEAST_GROUND:
        found.append(f"only {near:.0%} of the points are ground: is this a site of stones?")
    return tuple(found)


def spacing_warnings(spacing_m: float, voxel_m: float, least_m: float) -> Warnings:
    """Say that points are too far apart for small stones.

    Args:
        spacing_m: Distance of neighbouring points of what rises from the ground [m].
        voxel_m: Grid edge of the clustering for the clouds of a machine [m].
        least_m: Longest side of the smallest stone that can be told [m].
    """
    if spacing_m <= voxel_m:
        return ()
    return (
        f"points are {spacing_m:.2f} m apart: stones shorter than {least_m:.2f} m cannot be told; "
        "survey from nearer",
    )


def unit_warnings(stones: int, left_out: Sequence[LeftOut], most_m: float) -> Warnings:
    """Say that a cloud may be in feet: what is too large would be stones then.

    Args:
        stones: Number of what was taken for stones.
        left_out: What was not.
        most_m: Longest side of a stone [m].
    """
    large_m = [float(one.extents[0]) for one in left_out if one.kind in _LARGE]
    if len(large_m) < max(_FEW, stones + 1) or max(large_m) * _FOOT_M > most_m:
        return ()
    median_m = float(np.median(large_m))
    return (
        f"{len(large_m)} things are too large for stones, {median_m:.1f} m long; in feet they "
        f"would be {median_m * _FOOT_M:.1f} m: is the unit the metre?",
    )
