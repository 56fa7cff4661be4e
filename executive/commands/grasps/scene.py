"""What a grasp planner is given of a cloud from a file: a stone, its surroundings, a machine and
its place.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from executive.arrays import Float
from executive.clouds.reader import read_site
from executive.commands.chosen import chosen
from executive.commands.grasps.machine_place import beside, standing
from executive.errors import DataError
from executive.geometry.pose import pose
from executive.interfaces.grasping import GraspPlanner
from executive.interfaces.segmentation import Segmenter
from executive.machine.machine import Machine, load_machine
from executive.messages.cloud import Cloud
from executive.messages.grasp import GraspPlan
from executive.messages.stone import Stone, StoneState
from executive.tree.choices import Choices

Place = tuple[float, float, float]


@dataclass(frozen=True, slots=True, eq=False)
class GraspScene:
    """A stone of a cloud, and the machine that is to hold it; the cloud's frame is taken for the
    map.

    Attributes:
        choices: The plugins of the command.
        stone: The stone, its surface as segmented.
        cloud: All points.
        model: Name or folder of the machine.
        machine: Its description.
        T_map_base: Where it stands, shape (4, 4).
    """

    choices: Choices
    stone: Stone
    cloud: Cloud
    model: str
    machine: Machine
    T_map_base: Float


def read_scene(
    path: Path,
    segment: int,
    choices: Choices,
    model: str | None,
    place: Place | None,
    widest_m: float | None = None,
) -> GraspScene:
    """Read and segment a cloud, and put the machine at a place: x, y [m] and yaw [deg], or beside
    the stone. A cloud wider than `widest_m` is taken to be in another unit.

    Raises:
        ConfigError: If there is no such machine.
        DataError: If the file cannot be used, or has no segment of that number.
    """
    model = model or choices.model
    machine, points = load_machine(model), read_site(path, widest_m)
    with chosen(Segmenter, choices) as segmenter:
        found = segmenter.segment(Cloud("map", points))
    if segment >= len(found.segments):
        there = f"0 to {len(found.segments) - 1}" if found.segments else "none"
        raise DataError(
            f"{path}: no segment {segment}; there is {there}, as `executive segment` lists them"
        )
    one = found.segments[segment]
    if place is None:
        T_map_base = beside(one, found, machine)
    else:
        T_map_base = standing(place[0], place[1], float(np.radians(place[2])), found, machine)
    stone = Stone(1, StoneState.ON_GROUND, one.points, one.centroid, pose(t=one.centroid), False)
    return GraspScene(choices, stone, Cloud("map", points), model, machine, T_map_base)


def plan_grasps(scene: GraspScene, rng: np.random.Generator) -> GraspPlan:
    """Plan with the grasping plugin of the command."""
    with chosen(GraspPlanner, scene.choices, scene.model) as planner:
        return planner.plan(scene.stone, scene.cloud, scene.T_map_base, rng)
