"""What a classifier is shown of each grasp of a pool: its images and its costs, as pure numbers."""

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
    """M grasps as a classifier sees them; none of it depends on the gripper's scale.

    Attributes:
        images: See `grasp_images`, shape (M, 15, 32, 32).
        numbers: `NUMBERS`: angles [rad], the cube root of the stone's volume and the costs that are
            lengths, both over the widest opening, shape (M, 9).
    """

    images: Images
    numbers: NDArray[np.float32]


def features_of(scene: PlanningCloud, pool: Pool, gripper: Gripper) -> GraspFeatures:
    """Draw and count what is known of each grasp of a pool."""
    images = draw_images(
        scene.points, scene.is_target, scene.normals, pool.R, pool.position, image_cube(gripper)
    )
    opening_m = gripper.max_opening_m
    size = np.full(len(pool), np.cbrt(scene.volume_m3) / opening_m)
    lengths = [pool.costs[name] / opening_m for name in LENGTHS]
    numbers = np.column_stack([pool.costs["align_rad"], pool.jaw_rad, size, *lengths])
    return GraspFeatures(images, numbers.astype(np.float32))
