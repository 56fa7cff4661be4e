"""The simulated machine among stones: its scans, faults, contacts and truth; and paths followed."""

import numpy as np
import pytest
from executive_plugins.robot.kinematic import KinematicRobot
from executive_plugins.robot.mujoco.robot import MujocoRobot
from executive_plugins.robot.mujoco.settings import MujocoSettings
from executive_plugins.robot.mujoco.site.settings import (
    SiteSettings,
    StoneSettings,
    TerrainSettings,
)
from executive_plugins.robot.mujoco.site.stone_meshes import mesh_files, read_skin
from executive_plugins.robot.mujoco.site.stone_placement import footprint, gap
from executive_plugins.robot.mujoco.site.stones import make_stones
from executive_plugins.robot.mujoco.site.surface_texture import ground_skin, stone_skin
from executive_plugins.robot.mujoco.site.terrain import make_terrain
from executive_plugins.robot.mujoco.truth.surface import TrueSurface
from executive_plugins.robot.mujoco.truth.tracking import Tracking
from executive_plugins.robot.settings import KinematicSettings
from executive_plugins.robot.trajectory_follower import Follower

from executive.errors import ConfigError, RobotError
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import from_rpy
from executive.machine.machine import load_machine
from executive.messages.command import Follow, MoveJaws, SwitchLidars
from executive.messages.stone import StoneState
from executive.messages.stone_event import StoneEvent
from executive.messages.trajectory import JointTrajectory
from executive.testing.exercises.robot import turn

MACHINE = load_machine("m545")
SITE = {"stones": {"count": 2}, "terrain": {"half_size_m": 10}}
# The contact solver stops at a tolerance of its own.
SOLVED = 1e-5


@pytest.fixture(scope="module")
def robot():
    """A robot on a small site after a second: lidars on, turning, jaws closing on nothing."""
    dropouts = [{"sensor": "imu_cabin", "from_s": 0.3, "to_s": 0.5}]
    settings = MujocoSettings(
        scenario="kind", site=SITE, sensors={"azimuth_stride": 20, "dropouts": dropouts}
    )
    made = MujocoRobot(settings, MACHINE, np.random.default_rng(5))
    made.start()
    yield made
    made.close()


@pytest.fixture(scope="module")
def seen(robot):
    """What it measured on the way."""
    found = list(robot.read(0.2))
    robot.command(SwitchLidars(on=True))
    robot.command(MoveJaws(0.2, 5000.0))
    start = MACHINE.posture("scan")
    joint = next(one for one in reversed(found) if hasattr(one, "position"))
    start = np.array([joint.of(name)[0] for name in MACHINE.arm_names])
    robot.command(Follow(turn(MACHINE.arm_names, MACHINE.turn_joint, start, 0.3, 2.0)))
    for until_s in (0.4, 0.6):
        found += robot.read(until_s)
    robot.stop()
    found += robot.read(0.8)
    robot.resume()
    robot.command(SwitchLidars(on=False))
    found += robot.read(1.0)
    return found


def test_measurements(recorded, seen) -> None:
    kinds = sorted({type(one).__name__ for one in seen})
    told = {kind: [one for one in seen if type(one).__name__ == kind] for kind in kinds}
    told["LidarScan"] = [
        (one.stamp_s, one.frame, len(one.points_lidar), one.points_lidar.mean(axis=0))
        for one in told["LidarScan"]
    ]
    # A ray beside an edge may hit or miss by the solver's last digits.
    recorded(told, relative=1e-4)


def test_truth(recorded, robot, seen) -> None:
    log, told = robot.truth_log, []
    for time_s in (-1.0, 0.0, 0.333, 1.0, 9.0):
        told += [log.T_world_cabin(time_s), log.centroids(time_s), log.T_world_stone(1, time_s)]
    told += [log.holding(0, 0.2, 0.5), log.end_s, log.spans()]
    surface, rng = TrueSurface(robot.world.site, log, 0.5), np.random.default_rng(1)
    T_stone = log.T_world_stone(0, 0.5)
    points = rng.uniform(-1, 1, (500, 3)) * (1, 1, 0.02) + T_stone[:3, 3]
    told += [surface.distances(points), surface.distances(points[:0])]
    told += [surface.misplacement(points[:0]), surface.misplacement(points + 90)]
    origins = np.column_stack([rng.uniform(-9, 9, (40, 2)), np.full(40, 5.0)])
    rays = np.tile([0.0, 0.0, -1.0], (40, 1))
    told += [robot.cast_rays(origins, rays), robot.cast_rays(origins, -rays)]
    # Stones that settle, and cast rays that follow them, differ by millimetres between processors.
    recorded(told, relative=0.02, absolute=5e-3)
    # A stone's own corners determine the fit: it finds the motion that they were moved by.
    T_off = pose(from_rpy(0.0, 0.0, 0.02), np.array([0.02, -0.01, 0.03]))
    corners = transform(T_stone, robot.world.site.stones[0].vertices)
    middle = corners.mean(axis=0)
    found = surface.misplacement(transform(T_off, corners - middle) + middle)
    assert found.error_m == pytest.approx(np.linalg.norm(T_off[:3, 3]), rel=0.02)
    assert found.error_rad == pytest.approx(0.02, rel=0.05)


def event(log, stamp_s: float, kind: str, off: float) -> StoneEvent:
    T = pose(from_rpy(0, 0, 0.1 * off), np.array([off, 0, 0])) @ log.T_world_stone(0, stamp_s)
    return StoneEvent(stamp_s, kind, StoneState.ON_GROUND, T, "")


def test_tracking(recorded, robot, seen) -> None:
    log = robot.truth_log
    far = event(log, 0.0, "found", 50.0)
    told = event(log, 0.0, "found", 0.1), event(log, 0.4, "release", 0.3)
    again = event(log, 0.6, "release", 0.2), event(log, 0.8, "realign", 0.05)
    tracking = Tracking(log, {1: (*told, *again), 2: (far,), 3: (told[0],), 4: ()})
    recorded((tracking.objects(), tracking.realignments()), relative=SOLVED)


def test_sites(recorded) -> None:
    told = []
    for changed in ({}, {"undulation_m": 0.2, "roughness_m": 0.05, "pad_radius_m": 2.0}):
        settings = TerrainSettings(half_size_m=10, **changed)
        terrain = make_terrain(settings, np.random.default_rng(3))
        told += [terrain, terrain.mesh()]
    stones = make_stones(StoneSettings(count=3, roughness_m=0.02), 9e3, np.random.default_rng(4))
    told += stones
    # Heights of the terrain are of single precision in the world.
    recorded(told, relative=1e-6)
    recorded([type(SiteSettings()).__name__, make_stones(StoneSettings(count=0), 9e3, None)])


def test_outlines(recorded) -> None:
    square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    corners = np.random.default_rng(5).integers(-4, 5, (12, 3)) / 4.0
    outlines = [footprint(corners + (x, 0.5, 0.0)) for x in (0.0, 0.5, 3.0)]
    told = [gap(a, b) for a in (square, *outlines) for b in outlines]
    recorded((outlines, told))


TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"


def test_scanned_stones(recorded, tmp_path) -> None:
    told = []
    for name, text in {
        "a.obj": TETRAHEDRON,
        "b.obj": TETRAHEDRON.replace("f 1 3 2", "f 1 2 3"),
        "c.obj": TETRAHEDRON.replace("f 1 4 3\n", ""),
        "d.obj": "v 0 0 0\n",
        "e.txt": TETRAHEDRON,
    }.items():
        (tmp_path / name).write_text(text)
    told.append([path.name for path in mesh_files(tmp_path)])
    for name, scale in (("a", 1.0), ("b", 0.5), ("c", 1.0), ("d", 1.0), ("a", 1e-3), ("a", 1e3)):
        try:
            told.append(read_skin(tmp_path / f"{name}.obj", scale))
        except ConfigError as error:
            told.append(str(error).replace(str(tmp_path), ""))
    for name in ("c.obj", "d.obj"):
        (tmp_path / name).unlink()
    for count, payload in ((2, 1e4), (3, 1e4), (1, 100.0), (2, 500.0)):
        settings = StoneSettings(count=count, folder=tmp_path)
        try:
            told.append(make_stones(settings, payload, np.random.default_rng(6)))
        except ConfigError as error:
            told.append(str(error).replace(str(tmp_path), ""))
    for folder in (tmp_path / "none", tmp_path / "empty"):
        (tmp_path / "empty").mkdir(exist_ok=True)
        with pytest.raises(ConfigError) as refused:
            mesh_files(folder)
        told.append(str(refused.value).replace(str(tmp_path), ""))
    recorded(told, relative=1e-6)


def test_textures(recorded) -> None:
    # Made here, since the order of a hull's triangles differs between processors.
    corners = np.random.default_rng(7).uniform(-0.5, 0.5, (60, 3))
    mesh = corners, np.arange(60).reshape(20, 3)
    told = [paint(mesh, np.random.default_rng(8)) for paint in (stone_skin, ground_skin)]
    # The noise is of single precision, and rounded to whole levels.
    recorded(
        [(one.coordinates, one.texture.shape, one.texture.mean()) for one in told], relative=1e-4
    )


def path(duration_s: float, angle_rad: float, names=MACHINE.arm_names) -> JointTrajectory:
    start = MACHINE.posture("scan")
    return turn(MACHINE.arm_names, names[0], start, angle_rad, duration_s)


def test_followers(recorded) -> None:
    start, told = MACHINE.posture("scan"), []
    for stops_at, resumes_at in ((99, 99), (10, 99), (10, 40), (30, 34)):
        follower = Follower(MACHINE, start)
        told.append(follower.advance(0.05))
        follower.follow(path(3.0, 0.6), start)
        for k in range(90):
            if k == stops_at:
                follower.stop()
            if k == resumes_at:
                follower.resume()
            told.append((follower.advance(0.05), follower.is_moving))
    recorded(told)


def test_refused_paths(recorded) -> None:
    start, told = MACHINE.posture("scan"), []
    times, boom = np.array([0.0, 1.0]), MACHINE.arm_names[1]
    for name, first, last, speed in (
        ("J_NONE", 0.0, 0.1, 0.1),
        (boom, start[1] + 0.2, start[1], 0.0),
        (boom, start[1] + 0.01, start[1], 0.0),
        (boom, start[1], MACHINE.upper[1] + 0.1, 0.0),
        (boom, start[1], MACHINE.lower[1] - 0.1, 0.0),
        (boom, start[1], start[1] + 0.1, MACHINE.max_velocity[1] * 1.5),
        (boom, start[1], start[1] + 0.1, MACHINE.max_velocity[1]),
    ):
        one = JointTrajectory(
            (name,), times, np.array([[first], [last]]), np.array([[0.0], [speed]])
        )
        try:
            told.append(Follower(MACHINE, start).follow(one, start))
        except RobotError as error:
            told.append(error)
    recorded(told)


def test_kinematic(recorded) -> None:
    robot, told = KinematicRobot(KinematicSettings(fails_at_s=2.0), MACHINE), []
    robot.command(MoveJaws(0.1, 1.0))
    robot.command(Follow(path(1.0, 0.2)))
    told.append(robot.read(0.5))
    robot.stop()
    robot.command(MoveJaws(0.9, 1.0))
    told += [robot.read(1.0), robot.read(1.0)]
    robot.resume()
    robot.command(SwitchLidars(on=True))
    told.append(robot.read(1.99))
    with pytest.raises(RobotError) as refused:
        robot.read(2.0)
    recorded((told, refused.value))
