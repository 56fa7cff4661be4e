"""The whole planner: its trajectories are judged by the truth of a made-up site, not by its own
checks.
"""

from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.motion.collision import CollisionCheck
from executive_plugins.motion.obstacles import Obstacles

from executive.arrays import Float
from executive.errors import ShapeError
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import angle_between, from_rpy
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine, load_machine
from executive.messages.cloud import Cloud
from executive.messages.request import Around, MotionPlan, MoveRequest
from executive.messages.trajectory import JointTrajectory

NOTHING = Cloud("map", np.zeros((0, 3)))
RINGS = {"m545": ((4.0, 7.0), 1.0), "mini": ((2.8, 4.7), 0.6)}  # of the stones [m], and their size


def sampled(trajectory: JointTrajectory, step_s: float) -> Float:
    return np.array([trajectory.at(t)[0] for t in np.arange(0.0, trajectory.duration_s, step_s)])


@pytest.mark.parametrize("seed", [0])
def test_picks_and_places_hit_nothing_and_keep_every_limit(
    make_planner, make_site, make_judge, seed: int
) -> None:
    machine, planner = load_machine("m545"), make_planner("m545")
    q = machine.posture("scan")
    site = make_site(machine, *RINGS["m545"], seed)
    judge = make_judge(machine, site)
    for stone in range(5):
        pick = site.pick(q, stone)
        there = planner.move(pick)
        assert there.trajectory is not None, there.reason
        place = site.place(there.trajectory.position[-1], pick.T_map_gripper, stone)
        back = planner.move(place)
        assert back.trajectory is not None, back.reason
        for request, plan, held in ((pick, there, None), (place, back, stone)):
            assert_keeps_limits(machine, plan.trajectory, is_loaded=held is not None)
            # Tolerance of the planner 5 cm; the ground that it knows is the lowest of rough points.
            assert judge.deepest_in_site(request, plan.trajectory, held) < 0.15
            assert not judge.touches_itself(request, plan.trajectory)
        q = back.trajectory.position[-1] if stone % 2 else machine.posture("carry")


def assert_keeps_limits(machine: Machine, trajectory: JointTrajectory, is_loaded: bool) -> None:
    fine = sampled(trajectory, 0.005)
    velocity = np.diff(fine, axis=0) / 0.005
    acceleration = np.diff(velocity, axis=0) / 0.005
    fastest = machine.loaded_max_velocity if is_loaded else machine.max_velocity
    hardest = machine.loaded_max_acceleration if is_loaded else machine.max_acceleration
    assert (np.abs(velocity) <= fastest).all()
    assert (np.abs(acceleration) <= hardest).all()
    assert ((fine >= machine.lower - 1e-3) & (fine <= machine.upper + 1e-3)).all()


def test_arrives_and_leaves_straight_along_the_normal_without_turning(
    make_planner, make_site
) -> None:
    machine, planner = load_machine("m545"), make_planner("m545")
    site = make_site(machine, *RINGS["m545"], 3)
    request = site.pick(machine.posture("carry"), 0, tilt_rad=0.0)
    plan = planner.move(request)
    assert plan.trajectory is not None, plan.reason
    poses = gripper_poses(machine, request, plan.trajectory)
    offsets = poses[:, :3, 3] - request.T_map_gripper[:3, 3]
    last = poses[
        len(poses) - 1 - np.argmax(np.linalg.norm(offsets[::-1], axis=1) > 0.7 * request.arrive_m) :
    ]
    steps = last[:, :3, 3] - request.T_map_gripper[:3, 3]
    direction = steps[0] / np.linalg.norm(steps[0])
    beside = steps - np.outer(steps @ direction, direction)
    assert np.linalg.norm(beside, axis=1).max() < 0.01
    assert max(angle_between(T[:3, :3], request.T_map_gripper[:3, :3]) for T in last) < 0.01
    x, y = request.T_map_gripper[:2, 3]
    normal = np.array(
        [-0.09 * np.cos(0.9 * x), 0.056 * np.sin(0.7 * y), 1.0]
    )  # of the site's ground
    assert direction @ normal / np.linalg.norm(normal) > np.cos(0.1)


def gripper_poses(machine: Machine, request: MoveRequest, trajectory: JointTrajectory) -> Float:
    kinematics = Kinematics(machine)
    return np.array([request.T_map_base @ kinematics.gripper(q) for q in sampled(trajectory, 0.02)])


def test_ends_where_it_was_asked_to_and_starts_where_it_is(make_planner, make_site) -> None:
    machine = load_machine("m545")
    request = make_site(machine, *RINGS["m545"], 4).pick(machine.posture("scan"), 1)
    plan = make_planner("m545").move(request)
    assert plan.trajectory is not None, plan.reason
    np.testing.assert_allclose(plan.trajectory.position[0], request.start, atol=1e-9)
    reached = request.T_map_base @ Kinematics(machine).gripper(plan.trajectory.position[-1])
    np.testing.assert_allclose(reached, request.T_map_gripper, atol=5e-3)
    np.testing.assert_allclose(
        plan.path_map[0], (request.T_map_base @ Kinematics(machine).gripper(request.start))[:3, 3]
    )


def test_five_joints_pick_from_straight_above(make_planner, make_site, make_judge) -> None:
    machine, planner = load_machine("mini"), make_planner("mini")
    site = make_site(machine, *RINGS["mini"], 0)
    site.machine = machine
    for stone in range(5):
        request = vertical_pick(site, machine, stone)
        plan = planner.move(request)
        assert plan.trajectory is not None, plan.reason
        assert_keeps_limits(machine, plan.trajectory, is_loaded=False)
        assert make_judge(machine, site).deepest_in_site(request, plan.trajectory, None) < 0.15


def vertical_pick(site, machine: Machine, stone: int) -> MoveRequest:
    """A pick along the base's own z axis: five joints can make no other."""
    request = site.pick(machine.posture("carry"), stone)
    base = pose(t=np.array([0.0, 0.0, machine.stance.base_height_m]) + [2.0, -1.0, 0.0])
    R = from_rpy(0.0, 0.0, 0.3 * stone) @ from_rpy(0.0, np.pi / 2, 0.0)
    palm = site.stones[stone].centre - R @ machine.gripper.grasp_centre
    return MoveRequest(
        request.start,
        pose(R, palm),
        base,
        0.4,
        0.6,
        request.obstacles,
        None,
        machine.gripper.open_rad,
    )


def ask(
    planner,
    goal: Float,
    start: Float,
    obstacles: Cloud = NOTHING,
    leave_m: float = 0.0,
    arrive_m: float = 0.0,
):
    return planner.move(
        MoveRequest(start, goal, np.eye(4), leave_m, arrive_m, obstacles, None, 0.9)
    )


def at_carry(machine: Machine, x: float, y: float, z: float) -> Float:
    T = Kinematics(machine).gripper(machine.posture("carry"))
    return pose(from_rpy(0.0, 0.0, np.arctan2(y, x)) @ T[:3, :3], np.array([x, y, z]))


def test_the_way_straight_down_needs_no_detour_upwards(make_planner) -> None:
    machine = load_machine("m545")
    T = Kinematics(machine).gripper(machine.posture("carry"))
    plan = ask(
        make_planner("m545"),
        pose(t=np.array([0.0, 0.0, -1.0])) @ T,
        machine.posture("carry"),
        arrive_m=1.0,
    )
    assert plan.trajectory is not None, plan.reason
    heights = plan.path_map[:, 2]
    assert heights.max() < heights[0] + 0.02  # the line's end is bent into the travel
    assert plan.trajectory.duration_s < 6.0


def test_the_way_straight_up_is_the_leaving_alone(make_planner) -> None:
    machine = load_machine("m545")
    T = Kinematics(machine).gripper(machine.posture("carry"))
    plan = ask(
        make_planner("m545"),
        pose(t=np.array([0.0, 0.0, 1.0])) @ T,
        machine.posture("carry"),
        leave_m=1.0,
    )
    assert plan.trajectory is not None, plan.reason
    assert (np.diff(plan.path_map[:, 2]) > -1e-3).all()


def test_goes_where_it_stands_already_in_no_time(make_planner) -> None:
    machine = load_machine("m545")
    plan = ask(
        make_planner("m545"),
        Kinematics(machine).gripper(machine.posture("carry")),
        machine.posture("carry"),
    )
    assert plan.trajectory is not None, plan.reason
    assert plan.trajectory.duration_s < 0.5


def wall(azimuth_rad: float) -> Float:
    """Points of a wall that stands out from the machine, too high to be crossed."""
    radius, height = np.meshgrid(np.arange(2.5, 9.0, 0.1), np.arange(-0.9, 7.0, 0.1))
    along = np.stack(
        [np.cos(azimuth_rad) * radius, np.sin(azimuth_rad) * radius, height], axis=-1
    ).reshape(-1, 3)
    across = np.array([-np.sin(azimuth_rad), np.cos(azimuth_rad), 0.0])
    return np.vstack([along + d * across for d in (-0.1, 0.0, 0.1)])


def test_swings_the_shorter_way_and_the_other_where_that_one_is_blocked(make_planner) -> None:
    machine, planner = load_machine("m545"), make_planner("m545")
    turn = machine.arm_names.index(machine.turn_joint)
    start = planner.reach(at_carry(machine, 4.5, 3.0, 1.0), machine.posture("carry"))
    goal = at_carry(machine, 4.5, -3.0, 1.0)
    free, blocked = ask(planner, goal, start), ask(planner, goal, start, Cloud("map", wall(0.0)))
    enclosed = ask(planner, goal, start, Cloud("map", np.vstack([wall(0.0), wall(np.pi)])))
    assert free.trajectory is not None
    assert blocked.trajectory is not None, blocked.reason
    short, long = (
        t.position[-1, turn] - t.position[0, turn] for t in (free.trajectory, blocked.trajectory)
    )
    assert -np.pi < short < 0.0
    assert long == pytest.approx(short + 2 * np.pi, abs=0.05)
    assert enclosed.trajectory is None
    assert enclosed.reason.startswith("travelling: collision of")


@pytest.mark.parametrize(
    ("x", "z", "words"),
    [
        (12.0, 0.5, "goal out of reach"),
        (6.4, 3.9, "m of 1.00 m above the goal are in reach"),
        (5.0, -0.6, "arriving: collision of jaw_left with the ground"),
    ],
)
def test_says_why_there_is_no_way(make_planner, make_site, x: float, z: float, words: str) -> None:
    machine = load_machine("m545")
    xy = np.random.default_rng(0).uniform(-9, 9, (30000, 2))
    ground = np.c_[xy, np.full(len(xy), -0.9)]
    plan = ask(
        make_planner("m545"),
        at_carry(machine, x, 0.0, z),
        machine.posture("carry"),
        Cloud("map", ground),
        0.3,
        1.0,
    )
    assert plan.trajectory is None
    assert words in plan.reason


def test_the_same_request_gives_the_same_trajectory(make_planner, make_site) -> None:
    machine = load_machine("m545")
    request = make_site(machine, *RINGS["m545"], 5).pick(machine.posture("scan"), 2)
    first, second = (make_planner("m545").move(request) for _ in range(2))
    assert first.trajectory is not None
    assert second.trajectory is not None
    np.testing.assert_array_equal(first.trajectory.position, second.trajectory.position)
    np.testing.assert_array_equal(first.trajectory.times_s, second.trajectory.times_s)


def test_reach_keeps_the_open_gripper_off_the_machine(make_planner) -> None:
    machine, planner = load_machine("m545"), make_planner("m545")
    assert planner.reach(at_carry(machine, 5.0, 0.0, 0.0), machine.posture("carry")) is not None
    assert planner.reach(at_carry(machine, 1.6, 0.0, 0.0), machine.posture("carry")) is None


def test_a_start_of_another_arm_is_refused(make_planner) -> None:
    with pytest.raises(ShapeError, match=r"arm positions has shape \(5,\), expected \(7\)"):
        ask(make_planner("m545"), np.eye(4), np.zeros(5))


@pytest.mark.parametrize("model", ["m545", "mini"])
def test_a_sweep_goes_to_both_sides_and_back_in_the_scanning_posture(
    make_planner, model: str
) -> None:
    machine, planner = load_machine(model), make_planner(model)
    start = machine.posture("carry")
    turn = machine.arm_names.index(machine.turn_joint)
    start[turn] = 0.7
    plan: MotionPlan = planner.swing(start, 2.0, 25.0)
    assert plan.trajectory is not None, plan.reason
    trajectory = plan.trajectory
    assert_keeps_limits(machine, trajectory, is_loaded=False)
    turns = trajectory.position[:, turn]
    assert (turns[0], turns.max(), turns.min(), turns[-1]) == pytest.approx(
        (0.7, 1.7, -0.3, 0.7), abs=1e-6
    )
    sweeping = np.abs(trajectory.velocity[:, turn]) > 1e-6
    others = np.delete(trajectory.position, turn, axis=1)
    np.testing.assert_allclose(
        others[sweeping], np.tile(np.delete(machine.posture("scan"), turn), (sweeping.sum(), 1))
    )
    assert trajectory.duration_s >= 25.0


def test_a_sweep_lasts_longer_where_the_limits_ask_for_it(make_planner) -> None:
    machine = load_machine("m545")
    plan = make_planner("m545").swing(machine.posture("scan"), 4.0, 1.0)
    assert plan.trajectory is not None
    assert plan.trajectory.duration_s > 8.0 / machine.max_velocity.max()
    assert_keeps_limits(machine, plan.trajectory, is_loaded=False)


def test_obstacles_are_taken_where_the_base_stands(make_planner, make_site) -> None:
    machine = load_machine("m545")
    request = make_site(machine, *RINGS["m545"], 6).pick(machine.posture("scan"), 0)
    moved = pose(from_rpy(0.0, 0.0, 1.0), np.array([100.0, -50.0, 3.0]))
    elsewhere = MoveRequest(
        request.start,
        moved @ request.T_map_gripper,
        moved @ request.T_map_base,
        request.leave_m,
        request.arrive_m,
        Cloud("map", transform(moved, request.obstacles.points)),
        None,
        request.jaw_rad,
    )
    here, there = make_planner("m545").move(request), make_planner("m545").move(elsewhere)
    assert here.trajectory is not None, here.reason
    assert there.trajectory is not None
    np.testing.assert_allclose(
        here.trajectory.position[-1], there.trajectory.position[-1], atol=1e-6
    )
    np.testing.assert_allclose(
        transform(inverse(moved), there.path_map)[-1], here.path_map[-1], atol=1e-6
    )


def level_ground(machine: Machine, *more: Float) -> Cloud:
    xy = np.random.default_rng(0).uniform(-9, 9, (30000, 2))
    return Cloud("map", np.vstack([np.c_[xy, np.full(len(xy), -0.9)], *more]))


def boulder(x: float, y: float, radius: float) -> Float:
    directions = np.random.default_rng(1).normal(size=(1500, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    return np.array([x, y, -0.9 + radius]) + radius * directions


def sweep_at(
    make_planner, start: Float, *obstacles: Float, held: Float | None = None
) -> MotionPlan:
    machine = load_machine("m545")
    moved = pose(from_rpy(0.0, 0.0, 1.0), np.array([20.0, -5.0, 0.3]))
    cloud = level_ground(machine, *obstacles)
    around = Around(moved, Cloud("map", transform(moved, cloud.points)), 0.9, held)
    return make_planner("m545").swing(start, 1.4, 6.0, around)


def test_a_sweep_over_free_ground_folds_the_arm_while_the_cabin_turns(make_planner) -> None:
    machine = load_machine("m545")
    plan = sweep_at(make_planner, machine.posture("carry"))
    first = make_planner("m545").swing(machine.posture("carry"), 1.4, 6.0)
    assert plan.trajectory is not None, plan.reason
    assert first.trajectory is not None, first.reason
    assert plan.trajectory.duration_s < first.trajectory.duration_s - 1.5
    turns = plan.trajectory.position[:, machine.arm_names.index(machine.turn_joint)]
    assert (turns.max(), turns.min(), turns[-1]) == pytest.approx((0.7, -0.7, 0.0), abs=1e-6)
    assert_keeps_limits(machine, plan.trajectory, is_loaded=False)


def test_a_held_stone_is_swept_along(make_planner) -> None:
    """A post reaches to the middle of the stone's way, below that of the empty jaws."""
    machine = load_machine("m545")
    start = machine.posture("scan")
    stone = np.array([1.2, 0.0, 0.0]) + boulder(0.0, 0.0, 0.5) - [0.0, 0.0, -0.4]
    middle = transform(Kinematics(machine).gripper(start), np.array([1.2, 0.0, 0.0]))
    at = transform(pose(from_rpy(0.0, 0.0, 0.5)), middle)
    post = np.column_stack([np.tile(at[:2], (200, 1)), np.linspace(-0.9, at[2], 200)])
    free, loaded = sweep_at(make_planner, start, post), sweep_at(make_planner, start, held=stone)
    assert free.trajectory is not None, free.reason
    assert loaded.trajectory is not None, loaded.reason
    assert_keeps_limits(machine, loaded.trajectory, is_loaded=True)
    refused = sweep_at(make_planner, start, post, held=stone)
    assert refused.trajectory is None
    assert refused.reason.startswith("sweeping: collision of held_stone with the surroundings")


def extended(make_planner) -> Float:
    machine, planner = load_machine("m545"), make_planner("m545")
    return planner.reach(at_carry(machine, 5.5, 0.0, 0.3), machine.posture("carry"))


def test_a_sweep_turns_away_first_from_a_stone_that_the_arm_would_hit(make_planner) -> None:
    start, turn = extended(make_planner), load_machine("m545").arm_names.index("J_TURN")
    first = []
    for side in (1.0, -1.0):
        plan = sweep_at(make_planner, start, boulder(5.2, side * 2.3, 0.9))
        assert plan.trajectory is not None, plan.reason
        turns = plan.trajectory.position[:, turn] - start[turn]
        assert (turns.max(), turns.min()) == pytest.approx((0.7, -0.7), abs=1e-5)
        first.append(turns[np.argmax(np.abs(turns) > 0.3)])
    assert first[0] < 0 < first[1]


def test_a_sweep_folds_first_between_stones_that_the_arm_would_hit(make_planner) -> None:
    start = extended(make_planner)
    beside = np.vstack([boulder(5.2, 2.3, 0.9), boulder(5.2, -2.3, 0.9)])
    free, avoided = sweep_at(make_planner, start), sweep_at(make_planner, start, beside)
    assert free.trajectory is not None, free.reason
    assert avoided.trajectory is not None, avoided.reason
    assert avoided.trajectory.duration_s > free.trajectory.duration_s + 1.0


def test_a_sweep_that_would_graze_a_stone_keeps_the_clearance_from_it(make_planner) -> None:
    """Radii are tried at which the sweep has no contact yet, and is too near: it turns away."""
    start, turn = extended(make_planner), load_machine("m545").arm_names.index("J_TURN")
    sides = []
    for radius_m in np.arange(0.5, 0.9, 0.02):
        plan = sweep_at(make_planner, start, boulder(5.2, 2.3, radius_m))
        contact = CollisionCheck(
            make_planner("m545")._machine_check,
            Obstacles(level_ground(load_machine("m545"), boulder(5.2, 2.3, radius_m)).points, 11.0),
            start, 0.9, 0.05,
        )  # fmt: skip
        usual = sweep_at(make_planner, start)
        assert plan.trajectory is not None
        assert usual.trajectory is not None
        turns = plan.trajectory.position[:, turn] - start[turn]
        turned_away = turns[np.argmax(np.abs(turns) > 0.3)] < 0
        sides.append((turned_away, contact.first_hit_along(usual.trajectory) is not None))
    assert (False, False) in sides  # far away
    assert (True, False) in sides  # no contact, and too near
    assert (False, True) not in sides


def test_a_sweep_without_a_way_that_keeps_the_clearance_takes_one_without_contact(
    make_planner, monkeypatch
) -> None:
    planner, start = make_planner("m545"), extended(make_planner)
    usual = sweep_at(make_planner, start)
    too_near = SimpleNamespace(first_hit_along=lambda trajectory: (0.5, "anything"))
    real = planner._sweep_checks
    monkeypatch.setattr(planner, "_sweep_checks", lambda *given: [real(*given)[0], too_near])
    plan = sweep_at(make_planner, start)
    assert plan.trajectory is not None
    assert usual.trajectory is not None
    np.testing.assert_array_equal(plan.trajectory.position, usual.trajectory.position)


@pytest.mark.parametrize(
    ("obstacle", "words"),
    [
        (wall(0.5), "sweeping: collision of"),  # a wall
        (np.c_[boulder(3.2, 1.5, 0.2)[:, :2], np.linspace(-0.9, 5.0, 1500)], "sweeping: collision"),
        (boulder(-1.4, -1.4, 1.2), "sweeping: collision of cabin with the surroundings"),
    ],
    ids=["a wall", "a tree", "a parked machine behind the tail"],
)
def test_a_sweep_into_what_the_map_shows_is_refused(make_planner, obstacle, words) -> None:
    plan = sweep_at(make_planner, load_machine("m545").posture("scan"), obstacle)
    assert plan.trajectory is None
    assert plan.reason.startswith(words), plan.reason
