"""Grasp images: the space between and around the open jaws, seen along the gripper's three axes.

They follow the 15 channels of ten Pas et al. 2017 (three views of surface and normals), with the
surroundings in place of the shadow. Each view has five channels over its pixels, with values in
0 … 1 and 0 where there is nothing:

    0  nearness of the target's nearest point to the low end of the viewed axis
    1  nearness of the target's nearest point to the high end
    2  the same as 0 for everything else: ground and neighbours
    3  the same as 1 for everything else
    4  mean magnitude of the target's normals along the viewed axis

Views: 0 along the approach (pixels opening × width), 1 along the opening (approach × width), 2
along the width (approach × opening). Mirroring the scene at a symmetry plane of the jaws exchanges
pixels and the two ends exactly.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from executive.arrays import Bool, Float
from executive.machine.gripper import Gripper

PIXELS = 32
PER_VIEW = 5
CHANNELS = 3 * PER_VIEW
_BEHIND_PALM = 0.05  # share of the cube's edge that lies behind the front of the palm

Images = NDArray[np.float32]


def image_cube(gripper: Gripper) -> tuple[Float, float]:
    """Return the cube that is drawn: its lowest corner [m], shape (3,), and its edge [m].

    It is as wide as the open gripper, so a stone and a gripper of another scale give the same
    images.
    """
    edge_m = gripper.max_opening_m
    return edge_m * np.array([-_BEHIND_PALM, -0.5, -0.5]), edge_m


def draw_images(
    points: Float,
    is_target: Bool,
    normals: Float,
    R: Float,
    position: Float,
    cube: tuple[Float, float],
) -> Images:
    """Draw the images of M grasps, shape (M, 15, 32, 32).

    Args:
        points: The planning cloud [m], the target's points first, shape (N, 3).
        is_target: Mask of the target's points, shape (N,).
        normals: Unit normals of the target's points, shape (T, 3).
        R: Orientations of the gripper in the frame of the cloud, shape (M, 3, 3).
        position: Centres of the palm in that frame [m], shape (M, 3).
        cube: Corner and edge from `image_cube`.
    """
    images = np.zeros((len(R), CHANNELS, PIXELS, PIXELS), dtype=np.float32)
    count = np.zeros((3, PIXELS, PIXELS))
    _draw_all(
        np.ascontiguousarray(points, dtype=float),
        int(is_target.sum()),
        np.ascontiguousarray(normals, dtype=float),
        np.ascontiguousarray(R, dtype=float),
        np.ascontiguousarray(position, dtype=float),
        (np.asarray(cube[0], dtype=float), float(cube[1])),
        (images, count),
    )
    return images


def mirrored(images: Images, axis: int) -> Images:
    """Return images of the scene mirrored across gripper axis 1 (opening) or 2 (width)."""
    views = images.reshape(-1, 3, PER_VIEW, PIXELS, PIXELS).copy()
    for view, (row, column) in enumerate(((1, 2), (0, 2), (0, 1))):
        if axis == view:
            views[:, view] = views[:, view][:, [1, 0, 3, 2, 4]]
        elif axis == row:
            views[:, view] = views[:, view, :, ::-1]
        elif axis == column:
            views[:, view] = views[:, view, :, :, ::-1]
    return views.reshape(images.shape)


@njit(cache=True)
def _draw_all(points, targets, normals, R, position, cube, out):  # type: ignore[no-untyped-def]  # compiled
    images, count = out
    for i in range(len(R)):
        count[:] = 0.0
        _draw(points, targets, normals, (R[i], position[i]), cube, images[i], count)
        for view in range(3):
            for row in range(PIXELS):
                for column in range(PIXELS):
                    if count[view, row, column] > 0:
                        images[i, view * PER_VIEW + 4, row, column] /= count[view, row, column]


@njit(cache=True)
def _draw(points, targets, normals, T, cube, image, count):  # type: ignore[no-untyped-def]  # compiled
    """Draw one grasp; normals are summed here and divided by their count later."""
    (R, position), (corner, edge) = T, cube
    place = np.empty(3)
    for j in range(len(points)):
        is_inside = True
        for k in range(3):
            along = 0.0
            for d in range(3):
                along += (points[j, d] - position[d]) * R[d, k]
            place[k] = (along - corner[k]) / edge
            is_inside &= 0.0 <= place[k] < 1.0
        if not is_inside:
            continue
        for view in range(3):
            row = int(place[1 if view == 0 else 0] * PIXELS)
            column = int(place[1 if view == 2 else 2] * PIXELS)
            low = view * PER_VIEW + (0 if j < targets else 2)
            image[low, row, column] = max(image[low, row, column], 1.0 - place[view])
            image[low + 1, row, column] = max(image[low + 1, row, column], place[view])
            if j < targets:
                part = 0.0
                for d in range(3):
                    part += normals[j, d] * R[d, view]
                image[view * PER_VIEW + 4, row, column] += abs(part)
                count[view, row, column] += 1.0
