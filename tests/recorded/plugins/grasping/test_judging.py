"""What is judged of a grasp: approach, reach, load, contact, lift, images and the network."""

import numpy as np
import pytest
import torch
from executive_plugins.grasping.classifier.grasp_features import GraspFeatures, features_of
from executive_plugins.grasping.classifier.grasp_images import draw_images, image_cube, mirrored
from executive_plugins.grasping.classifier.outcome_net import new_net, success
from executive_plugins.grasping.feasibility.approach_path import ApproachPath
from executive_plugins.grasping.feasibility.arm_load import ArmLoad
from executive_plugins.grasping.feasibility.arm_reach import ArmReach
from executive_plugins.grasping.feasibility.fcl_check import FclCheck
from executive_plugins.grasping.learning.labels import (
    Labels,
    LabelSettings,
    chosen_for_lifts,
    resting_stone,
)
from executive_plugins.grasping.learning.lift_trials import LiftTrials
from executive_plugins.grasping.learning.training import (
    TrainingSettings,
    area_under_curve,
    predictions,
    split_by_stone,
    train,
    untrained,
)
from executive_plugins.grasping.learning.training_scene import (
    convex_solid,
    look_at,
    neighbour_place,
)
from executive_plugins.grasping.sampling.pool import Sampler
from executive_plugins.grasping.sampling.settings import SamplingSettings
from executive_plugins.grasping.simulated_lift import SimulatedLift
from executive_plugins.physics.belief import belief_of

from executive.geometry.pose import pose
from executive.geometry.rotation import exp_so3, from_rpy
from executive.machine.kinematics import Kinematics

DOWN = from_rpy(0.0, np.pi / 2, 0.0)
UP = np.array([0.0, 0.0, 1.0])
# The contact solver stops at a tolerance of its own.
SOLVED = 1e-6


def block(seed: int = 1) -> np.ndarray:
    corners = np.stack(np.meshgrid(*[[-0.5, 0.5]] * 3), axis=-1).reshape(-1, 3)
    return (
        corners * (0.9, 0.7, 0.6)
        + np.random.default_rng(seed).normal(0, 0.03, (8, 3))
        + (0, 0, 0.35)
    )


def test_approaches(recorded, gripper) -> None:
    path, told = ApproachPath(gripper), []
    rng = np.random.default_rng(1)
    cloud = rng.uniform(-1.5, 1.5, (300, 3))
    for height, tilt in ((1.0, 0.0), (1.5, 0.04), (1.5, 0.06), (2.2, 0.4), (9.0, 0.0)):
        T = pose(exp_so3(np.array([tilt, 0.0, 0.0])) @ DOWN, np.array([0.0, 0.0, height]))
        told.append(path.depth_m(cloud, T))
        told += [path.is_free(cloud[::k], T, UP, 0.8, 0.1) for k in (1, 10, 60)]
    told.append(ApproachPath(gripper, 0.5).is_free(cloud[::60], T, UP, 0.0, 0.1))
    recorded(told)


def test_contacts(recorded, gripper) -> None:
    told, rng = [], np.random.default_rng(2)
    for allowed_m in (0.01, 0.05, 0.5):
        check = FclCheck(gripper, allowed_m)
        for k in range(40):
            T = pose(exp_so3(0.5 * rng.normal(size=3)) @ DOWN, np.array([0.0, 0.0, 0.8]))
            told.append(check.is_free(rng.uniform(-1, 1, (1 + k % 3, 3)), T))
    recorded(np.array(told))


def test_loads(recorded, machine) -> None:
    load, told = ArmLoad(machine), []
    for name in sorted(machine.postures):
        q = machine.posture(name)
        told.append((load.efforts(q, 0.0), load.efforts(q, 1500.0)))
        told.append([load.can_hold(q, mass) for mass in range(0, 9000, 500)])
    # Central differences lose half of the digits.
    recorded(told, relative=1e-7, absolute=1e-3)


def test_reach(recorded, machine, planner_of) -> None:
    gripper_at = Kinematics(machine).gripper
    told = []

    class Wrist:
        """Reaches poses whose gripper is low enough, with the wrist as its opening points."""

        def reach(self, T, seed):
            q = seed.copy()
            q[-1] += np.arctan2(T[1, 1], T[0, 1])
            return q if T[2, 3] < 2.0 else None

    arm = ArmReach(machine, Wrist())
    base = pose(from_rpy(0, 0, 0.2), np.array([0.1, 0, 0.5]))
    for yaw in (0.0, 1.0, 2.0, 3.0, -np.pi / 2):
        for above_m in (0.5, 2.5):
            T = pose(from_rpy(0, 0, yaw) @ DOWN, np.array([4.0, 0.0, 1.0]))
            told.append(arm.reached(T, base, above_m))
    told += [arm.holds(pose(DOWN, np.array([5.0, 0, z])), base, 900.0) for z in (1.0, 9.0)]
    told.append(arm.holds(pose(DOWN, np.array([5.0, 0, 1])), base, 90000.0))
    recorded((told, gripper_at(machine.posture("carry"))))


@pytest.mark.parametrize("friction", [0.3, 0.6])
def test_lifts(recorded, gripper, friction) -> None:
    told = []
    for normal, mass_kg in ((UP, 900.0), (np.array([0.1, 0.0, 0.99498743710662]), 500.0)):
        lift = SimulatedLift(gripper, block(), normal, mass_kg)
        T = pose(exp_so3(np.array([0, 0, 0.3])) @ DOWN, np.array([0.02, 0.0, 1.55]))
        lifted = lift.lift(T, 0.7, belief_of("kind", gripper).contact(friction))
        told.append((lifted, lifted.slip_m))
    recorded(told, relative=SOLVED)


def test_trials(recorded, gripper) -> None:
    trials = LiftTrials(gripper, block())
    T = pose(DOWN, np.array([0.0, 0.0, 1.5]))
    recorded(trials.lift(T, 0.7, np.random.default_rng(3)), relative=SOLVED)


def test_images(recorded, gripper) -> None:
    rng = np.random.default_rng(4)
    points = rng.uniform(-0.7, 0.7, (400, 3))
    is_target = np.arange(400) < 150
    normals = points[:150] / np.linalg.norm(points[:150], axis=1)[:, None]
    R = np.array([exp_so3(rng.normal(size=3)) for _ in range(3)])
    images = draw_images(
        points, is_target, normals, R, rng.normal(0, 0.3, (3, 3)), image_cube(gripper)
    )
    # The images are of single precision.
    recorded(
        (images, [mirrored(images, axis) for axis in (1, 2)], image_cube(gripper)), relative=1e-6
    )


def test_features(recorded, gripper, tables) -> None:
    few = {"samples": 6, "turns_about_y": 2, "turns_about_z": 2, "downward_yaws": 6}
    sampler = Sampler(SamplingSettings(**few), gripper)
    sampler._tables = tables
    rng = np.random.default_rng(5)
    stone = rng.normal(size=(900, 3))
    stone = stone / np.linalg.norm(stone, axis=1)[:, None] * (0.6, 0.45, 0.4) + (0, 0, 0.4)
    ground = np.c_[rng.uniform(-2, 2, (2500, 2)), np.zeros(2500)]
    scene = sampler.scene(stone, np.vstack([stone, ground]), rng)
    pool = sampler.pool(scene, rng)
    recorded(features_of(scene, pool, gripper), relative=1e-6)
    recorded([chosen_for_lifts(pool, most, np.random.default_rng(6)) for most in (3, 8, 500)])


def shown(count: int) -> GraspFeatures:
    rng = np.random.default_rng(7)
    images = (rng.random((count, 15, 32, 32)) * (rng.random((count, 15, 32, 32)) < 0.1)).astype(
        np.float32
    )
    return GraspFeatures(images, rng.random((count, 9)).astype(np.float32))


@pytest.mark.parametrize("architecture", ["two_stream", "four_layer"])
def test_networks(recorded, architecture) -> None:
    torch.manual_seed(1)
    net = new_net(architecture)
    sizes = {name: list(values.shape) for name, values in net.state_dict().items()}
    # Predictions are rounded to three digits.
    recorded((sizes, success(net, shown(67))), absolute=1.1e-3)


def labels(count: int = 16) -> Labels:
    given = shown(count)
    images = np.round(given.images * 255).astype(np.uint8)
    return Labels(images, given.numbers, given.numbers[:, 0] > 0.5, np.arange(count) // 4)


def test_training(recorded) -> None:
    settings = TrainingSettings(epochs=2, batch=8, rate=3e-3)
    learned, held_out = split_by_stone(labels(), 0.25, np.random.default_rng(8))
    net = untrained(settings)
    progress = list(train(net, learned, held_out, settings))
    found = predictions(net, held_out)
    # Training adds up in single precision, in the order of the library.
    recorded((progress, found, held_out.stone, learned.stone), relative=1e-3, absolute=5e-3)


def test_curves(recorded) -> None:
    rng = np.random.default_rng(9)
    score, truth = rng.integers(0, 5, 60) / 4, rng.random(60) < 0.4
    recorded([area_under_curve(score, one) for one in (truth, truth | True, truth & False)])


def test_scenes(recorded) -> None:
    told = []
    for seed in (1, 2, 3):
        rng = np.random.default_rng(seed)
        other = convex_solid(block(seed) + neighbour_place(rng))
        told.append(look_at(convex_solid(block()), (other,), rng))
    solid = convex_solid(block())
    rays = np.array([[0.0, 0, -1], [0, 0, 1], [1, 0, 0], [0.1, 0, -1]])
    told.append([solid(np.array(p), rays) for p in ((0, 0, 3.0), (0, 0, 0.3), (2.0, 0, 0.3))])
    recorded(told)


def test_resting_stones(recorded) -> None:
    told = [
        resting_stone(LabelSettings(rounded=rounded), np.random.default_rng(4))
        for rounded in (0.0, 1.0)
    ]
    recorded(told, relative=SOLVED)
