"""Signs that a cloud is no site with z up."""

import numpy as np
from executive_plugins.segmentation.ground_plane import plane_heights
from executive_plugins.segmentation.shape import counts_near, planes_through

from executive.arrays import Float

_SAMPLE = 2000  # points that are looked at
_PLANES = 100  # that are tried through them
_OTHER = 1.3  # share of points on another plane, in that on the ground, which is a sign
_LEAST_BELOW = 0.005  # share of the points under the ground which is a sign
_LEAST_GROUND = 0.25  # share of the points near the ground: less is no site of stones


def site_warnings(
    points: Float, plane: Float, heights: Float, margin_m: float, rng: np.random.Generator
) -> tuple[str, ...]:
    """Say what speaks against a cloud being a site with z up; nothing if all is well.

    Args:
        points: A sample of the cloud [m], shape (N, 3).
        plane: The ground's mean plane, shape (4,).
        heights: Of the sample above the ground [m], shape (N,).
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
    above, below = float((heights > margin_m).mean()), float((heights < -margin_m).mean())
    if below > max(2 * above, _LEAST_BELOW):
        found.append(
            f"{below:.1%} of the points lie under the ground, {above:.1%} above it: is z down?"
        )
    near = 1.0 - above - below
    if near < _LEAST_GROUND:
        found.append(f"only {near:.0%} of the points are ground: is this a site of stones?")
    return tuple(found)
