"""The inputs of the classifier for each grasp of a pool: images and scalars."""

from dataclasses import dataclass

import numpy as np
from executive_plugins.grasping.classifier.grasp_images import Images, draw_images, image_cube
from executive_plugins.grasping.sampling.planning_cloud import PlanningCloud
from executive_plugins.grasping.sampling.pool import Pool
from numpy.typing import NDArray

from executive.machine.gripper import Gripper

LENGTHS = ("enclose_m", "distance_m", "drag_m", "shallow_m", "twist_m", "lever_m")
NUMBERS = ("align_rad", "jaw_rad", "size", *LENGTHS)


@dataclass(frozen=True, slots=True, eq=False)
class GraspFeatures:
    """Features of M grasps; they do not depend on the scale of the gripper.

    Attributes:
        images: See `grasp_images`, shape (M, 15, 32, 32).
        numbers: The scalars named in `NUMBERS`, shape (M, 9): angles [rad], the cube root of the
            stone's volume, and the costs that are lengths; both are divided by the widest opening.
    """

    images: Images
    numbers: NDArray[np.float32]


def features_of(scene: PlanningCloud, pool: Pool, gripper: Gripper) -> GraspFeatures:
    """Compute the features of every grasp of a pool."""
    images = draw_images(
        scene.points, scene.is_target, scene.normals, pool.R, pool.position, image_cube(gripper)
    )
    opening_m = gripper.max_opening_m
    size = np.full(len(pool), np.cbrt(scene.volume_m3) / opening_m)
    lengths = [pool.costs[name] / opening_m for name in LENGTHS]
    numbers = np.column_stack([pool.costs["align_rad"], pool.jaw_rad, size, *lengths])
    return GraspFeatures(images, numbers.astype(np.float32))
