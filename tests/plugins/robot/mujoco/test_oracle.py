"""The oracle's verdicts on a puppet show: stones and machine are put where the test wants them."""

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np
import pytest
from executive_plugins.robot.mujoco.oracle import MujocoOracle
from executive_plugins.robot.mujoco.robot import MujocoRobot
from executive_plugins.robot.mujoco.settings import MujocoSettings

from executive.arrays import Float
from executive.events.event import plain
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import about_axis, quaternion_wxyz
from executive.interfaces.oracle import Attempt, MissionView
from executive.machine.machine import load_machine
from executive.messages.base_state import BaseState
from executive.messages.cloud import Cloud
from executive.messages.placement import Slot
from executive.messages.stone import Stone, StoneState
from executive.messages.stone_event import StoneEvent

MACHINE = load_machine("m545")
SETTINGS = MujocoSettings.model_validate(
    {"base": "welded", "site": {"stones": {"count": 2}, "terrain": {"half_size_m": 10}}}
)
FAR = np.array([-8.0, 0.0, 3.0])  # in the air, away from everything
STEP_S = 0.01


class Show:
    """A robot whose world is not stepped but posed."""

    def __init__(self) -> None:
        self.robot = MujocoRobot(SETTINGS, MACHINE, np.random.default_rng(0))
        self.robot.start()
        self.model = self.robot.world.model
        self.data = mujoco.MjData(self.model)
        self.data.qpos[:] = self.robot.world.data.qpos
        self.time_s = STEP_S
        self.play(0.2)

    def at(self, link: str, *offset: float) -> Float:
        """Return a point beside a link, in world axes."""
        return np.array(self.robot.world.data.body(link).xpos + np.array(offset))

    def put(self, stone: str, position: Float, R: Float | None = None) -> None:
        joint = self.data.joint(stone)
        joint.qpos[:3] = position
        if R is not None:
            joint.qpos[3:] = quaternion_wxyz(R)

    def play(self, duration_s: float) -> None:
        """Hold the pose for a while."""
        mujoco.mj_forward(self.model, self.data)
        for _ in range(round(duration_s / STEP_S)):
            self.robot.truth_log.step(self.time_s, self.model, self.data)
            self.time_s = round(self.time_s + STEP_S, 6)

    def truth(self, **view: Any) -> Any:
        """Return the truth as JSON holds it."""
        parts: dict[str, Any] = {
            "states": (),
            "stones": (),
            "slots": {},
            "attempts": (),
        }
        return plain(MujocoOracle(self.robot).truth(MissionView(**(parts | view))))


def position(show: Show, stone: str) -> Float:
    return np.array(show.data.joint(stone).qpos[:3])


def stone(stone_id: int, T_map_object: Float) -> Stone:
    centre = T_map_object[:3, 3]
    return Stone(
        stone_id, StoneState.ON_GROUND, centre[None], centre, T_map_object, seen_from_above=False
    )


def attempt(
    started_s: float, ended_s: float, centroid: Sequence[float], stone_id: int = 1
) -> Attempt:
    return Attempt(stone_id, started_s, ended_s, "placed", (centroid[0], centroid[1], centroid[2]))


def test_slot_errors_are_horizontal_distances_of_the_true_centroid() -> None:
    show = Show()
    T_found = pose(t=position(show, "stone_2") + np.array([0.1, 0.05, 0.1]))
    show.put("stone_2", np.array([3.0, -4.0, 0.5]))
    show.play(0.2)
    slots = {9: Slot(1, np.array([3.3, -4.4, 0.0]))}
    stones = show.truth(histories={9: events_of(show, T_found)}, slots=slots)["stones"]
    assert stones[1]["id"] == 2
    assert stones[1]["held_object"] == 9
    assert stones[1]["slot_error_m"] == pytest.approx(0.5)
    unseen = ("held_object", "slot_error_m", "database_error_m", "database_error_rad")
    assert [stones[0][name] for name in ("id", *unseen)] == [1, None, None, None, None]


def test_the_truth_tells_where_each_stone_lies_at_the_end() -> None:
    show = Show()
    show.put("stone_2", np.array([3.0, -4.0, 3.0]))
    show.play(1.2)
    found = show.truth()["stones"][1]
    np.testing.assert_allclose(found["centre_m"][:2], [3.0, -4.0], atol=0.01)
    assert found["bottom_m"] < found["centre_m"][2] < found["top_m"]
    outline = np.array(found["outline_m"])
    assert (outline.min(axis=0) < [3.0, -4.0]).all()
    assert (outline.max(axis=0) > [3.0, -4.0]).all()
    box = np.prod(np.ptp(outline, axis=0)) * (found["top_m"] - found["bottom_m"])
    assert 0 < found["volume_m3"] < box
    assert found["touches"] == []  # in the air


def test_the_truth_tells_what_a_stone_rests_on() -> None:
    show = Show()
    lower, upper = show.truth()["stones"]
    x, y, _ = lower["centre_m"]
    show.put("stone_2", np.array([x, y, lower["top_m"] + upper["centre_m"][2] - upper["bottom_m"]]))
    show.play(1.2)
    one, two = show.truth()["stones"]
    assert one["touches"] == ["stone_2", "terrain"]
    assert two["touches"] == ["stone_1"]


def test_database_errors_compare_the_tracked_frame_with_the_true_motion() -> None:
    show = Show()
    start = position(show, "stone_1")
    R_start = np.zeros(9)
    mujoco.mju_quat2Mat(R_start, show.data.joint("stone_1").qpos[3:])
    T_start = pose(R_start.reshape(3, 3), start)
    T_found = pose(t=start + np.array([0.2, 0.0, 0.1]))
    histories = {1: events_of(show, T_found)}
    motion = pose(about_axis(np.array([0.0, 0.0, 1.0]), 1.0), np.array([0.5, -2.0, 0.1]))
    T_end = motion @ T_start
    show.put("stone_1", T_end[:3, 3], T_end[:3, :3])
    show.play(0.2)
    faithful = stone(1, motion @ T_found)
    report = show.truth(histories=histories, stones=[faithful])["stones"][0]
    assert report["database_error_m"] == pytest.approx(0, abs=1e-9)
    assert report["database_error_rad"] == pytest.approx(0, abs=1e-9)
    off = pose(about_axis(np.array([1.0, 0.0, 0.0]), 0.1), np.array([0.03, 0.0, 0.04]))
    wrong = pose(
        off[:3, :3] @ faithful.T_map_object[:3, :3], faithful.T_map_object[:3, 3] + off[:3, 3]
    )
    report = show.truth(histories=histories, stones=[stone(1, wrong)])["stones"][0]
    assert report["database_error_m"] == pytest.approx(0.05)
    assert report["database_error_rad"] == pytest.approx(0.1)


def test_errors_count_since_the_model_was_replaced_by_what_was_seen_of_the_same_stone() -> None:
    show = Show()
    start = position(show, "stone_1")
    T_found = pose(t=start + np.array([0.2, 0.0, 0.1]))
    show.put("stone_1", start + np.array([1.0, 0.0, 0.0]))
    show.play(0.2)
    T_new = pose(about_axis(np.array([1.0, 0.0, 0.0]), 3.0), position(show, "stone_1"))
    known = events_of(show, T_found, release=T_found, replaced=T_new)
    show.play(0.2)
    report = show.truth(histories={1: known}, stones=[stone(1, T_new)])
    (one, other) = report["stones"]
    assert one["models"] == 2
    assert other["models"] == 0  # nobody has seen it
    assert one["database_error_m"] == pytest.approx(0, abs=1e-3)
    assert one["database_error_rad"] == pytest.approx(0, abs=1e-3)
    (entry,) = report["realignments"]
    assert entry["error_m"] == pytest.approx(1.0, abs=1e-3)  # the release is of the first model


def test_a_model_that_was_replaced_by_another_stone_keeps_its_errors() -> None:
    show = Show()
    T_found = pose(t=position(show, "stone_1"))
    T_other = pose(t=position(show, "stone_2"))
    show.play(0.2)
    known = events_of(show, T_found, replaced=T_other)
    (one, _) = show.truth(histories={1: known}, stones=[stone(1, T_other)])["stones"]
    assert one["models"] == 1
    assert one["database_error_m"] > 0.7


def events_of(show: Show, found: Float, **poses: Float) -> list[StoneEvent]:
    """Return a history: found at the start, then changes at present, in order."""
    now = [
        StoneEvent(show.time_s - STEP_S, kind, StoneState.PLACED, T) for kind, T in poses.items()
    ]
    return [StoneEvent(0.0, "found", StoneState.ON_GROUND, found), *now]


def test_tells_the_error_of_a_pose_before_and_after_its_realignment() -> None:
    show = Show()
    T_found = pose(t=position(show, "stone_1") + np.array([0.2, 0.0, 0.1]))
    moved = np.array([1.0, -2.0, 0.3])
    show.put("stone_1", position(show, "stone_1") + moved)
    show.play(0.2)
    T_true = pose(t=T_found[:3, 3] + moved)
    T_settled = pose(about_axis(np.array([0.0, 0.0, 1.0]), 0.2), T_true[:3, 3] + [0.03, 0.04, 0.0])
    T_realigned = pose(t=T_true[:3, 3] + np.array([0.0, 0.0, 0.01]))
    events = events_of(show, T_found, grasp=T_found, release=T_settled, realign=T_realigned)
    (entry,) = show.truth(histories={5: events})["realignments"]
    assert (entry["stone"], entry["round"], entry["was_realigned"]) == (1, 1, True)
    assert entry["settled_error_m"] == pytest.approx(0.05)
    assert entry["settled_error_rad"] == pytest.approx(0.2)
    assert entry["error_m"] == pytest.approx(0.01)
    assert entry["error_rad"] == pytest.approx(0, abs=1e-6)


def test_a_release_without_realignment_keeps_the_error_of_the_gripper_s_motion() -> None:
    show = Show()
    T_found = pose(t=position(show, "stone_2"))
    off = pose(t=T_found[:3, 3] + np.array([0.0, 0.3, 0.4]))
    releases = [*events_of(show, T_found, release=off), *events_of(show, T_found, release=T_found)]
    entries = show.truth(histories={1: releases})["realignments"]
    assert [(one["stone"], one["round"], one["was_realigned"]) for one in entries] == [
        (2, 1, False),
        (2, 2, False),
    ]
    assert [one["error_m"] for one in entries] == pytest.approx([0.5, 0.0], abs=1e-9)
    assert entries[0]["error_m"] == entries[0]["settled_error_m"]


def test_what_is_corrected_in_the_jaws_is_no_realignment_of_the_release_before() -> None:
    show = Show()
    T_found = pose(t=position(show, "stone_1"))
    T_lifted = pose(t=T_found[:3, 3] + np.array([0.0, 0.0, 1.2]))
    first = events_of(show, T_found, grasp=T_found, release=T_found)
    again = events_of(show, T_found, grasp=T_found, realign=T_lifted)[1:]
    (entry,) = show.truth(histories={1: [*first, *again]})["realignments"]
    assert entry["was_realigned"] is False
    assert entry["error_m"] == pytest.approx(0.0, abs=1e-9)


def test_counts_stones_that_are_known_known_twice_or_none_at_all() -> None:
    show = Show()
    near = pose(t=position(show, "stone_1") + np.array([0.3, 0.0, 0.0]))
    nowhere = pose(t=FAR)
    histories = {i: events_of(show, T) for i, T in enumerate([near, near, nowhere], 1)}
    truth = show.truth(histories=histories)
    assert truth["objects"] == {"stones": 2, "known": 1, "twice": 1, "ghosts": 1}
    assert truth["realignments"] == []
    assert show.truth()["objects"] == {}  # without a database


def test_measures_the_distance_of_the_map_to_the_ground_and_the_stones_of_the_end() -> None:
    show = Show()
    vertices, _ = show.robot.world.site.terrain.mesh()
    on_ground = vertices[np.abs(vertices[:, :2]).max(axis=1) < 9]
    exact = show.truth(map_cloud=Cloud("map", on_ground))["map"]
    assert exact["distance_m"] == pytest.approx({"median": 0.0, "p95": 0.0}, abs=1e-5)
    assert [exact["bias_m"], exact["std_m"]] == pytest.approx([0.0, 0.0], abs=1e-5)
    for off_m in (-0.02, 0.02):
        off = show.truth(map_cloud=Cloud("map", on_ground + np.array([0.0, 0.0, off_m])))["map"]
        assert off["bias_m"] == pytest.approx(off_m, abs=2e-3)
        assert off["std_m"] < 0.003
    lifted = Cloud("map", on_ground + np.array([0.0, 0.0, 6.0]))
    far = show.truth(map_cloud=lifted)["map"]
    assert far["distance_m"]["median"] > 4
    assert (far["bias_m"], far["std_m"]) == (None, None)
    show.put("stone_1", FAR)
    show.play(0.2)
    stone_1 = show.robot.world.site.stones[0]
    T_stone = show.robot.truth_log.T_world_stone(0, show.robot.truth_log.end_s)
    skin = Cloud("map", stone_1.vertices @ T_stone[:3, :3].T + T_stone[:3, 3])
    assert show.truth(map_cloud=skin)["map"]["distance_m"]["p95"] == pytest.approx(0.0, abs=1e-5)
    assert show.truth(map_cloud=Cloud("map", np.zeros((0, 3))))["map"] == {}


def test_tells_how_far_the_registered_survey_is_from_its_true_place() -> None:
    show = Show()
    site = show.robot.world.site
    vertices, _ = site.terrain.mesh()
    skins = [
        stone.vertices @ T[:3, :3].T + T[:3, 3]
        for stone, T in zip(site.stones, site.T_world_stones, strict=True)
    ]
    seen = np.concatenate([vertices[np.abs(vertices[:, :2]).max(axis=1) < 9], *skins])
    show.put("stone_1", FAR)  # the survey saw it where it was
    show.play(0.2)
    exact = show.truth(registered_survey=Cloud("map", seen))["registration"]
    assert exact["error_m"] < 1e-3
    assert exact["error_rad"] < 1e-4
    T_off = pose(about_axis(np.array([0.0, 0.0, 1.0]), 0.01), np.array([0.05, -0.03, 0.02]))
    off = show.truth(registered_survey=Cloud("map", transform(T_off, seen)))["registration"]
    middle = seen.mean(axis=0)
    assert off["error_m"] == pytest.approx(
        np.linalg.norm(transform(T_off, middle[None])[0] - middle), abs=5e-3
    )
    assert off["error_rad"] == pytest.approx(0.01, abs=1e-3)
    nowhere = Cloud("map", seen + np.array([0.0, 0.0, 50.0]))
    assert show.truth(registered_survey=nowhere)["registration"] == {}


def test_a_stone_first_seen_after_it_was_moved_is_recognised_there() -> None:
    show = Show()
    show.put("stone_1", FAR)
    show.play(2.0)
    found = StoneEvent(show.time_s - STEP_S, "found", StoneState.ON_GROUND, pose(t=FAR))
    assert show.truth(histories={4: [found]})["stones"][0]["held_object"] == 4


def test_a_resumed_run_is_judged_against_where_its_stone_was_found() -> None:
    """The process that found the stone was killed while the stone was carried."""
    show = Show()
    begin_s, start = lift(show)
    found = [StoneEvent(begin_s, "found", StoneState.ON_GROUND, pose(t=start + [0.1, 0.0, 0.2]))]
    log, kept = show.robot.truth_log, show.robot.truth_log.keep()
    log.begin_at(show.time_s, show.model, show.data, kept)
    carried = attempt(begin_s, show.time_s + 1.0, start)
    moved = np.array([2.0, 1.0, 0.0])
    show.put("stone_1", start + moved)
    show.play(0.3)
    faithful, wrong = (
        stone(1, pose(t=start + moved + [0.1 + off, 0.0, 0.2])) for off in (0.0, 0.4)
    )
    for now, off_m in ((faithful, 0.0), (wrong, 0.4)):
        truth = show.truth(histories={1: found}, stones=[now], attempts=[carried])
        assert truth["stones"][0]["database_error_m"] == pytest.approx(off_m, abs=1e-6)
        assert truth["grasps"] == [{"object": 1, "lifted": True, "dropped": True}]


def lift(show: Show) -> tuple[float, Float]:
    """Bring stone_1 between the jaws; return when the attempt began and where the stone lay."""
    begin_s, start = show.time_s, position(show, "stone_1")
    show.play(0.1)
    show.put("stone_1", show.at("gripper", 0.0, 0.0, -0.9))
    show.play(0.5)
    return begin_s, start


def test_a_stone_that_rose_was_lifted_and_one_that_fell_from_the_jaws_was_dropped() -> None:
    show = Show()
    begin_s, start = lift(show)
    held = show.truth(attempts=[attempt(begin_s, show.time_s, start)])["grasps"]
    assert held == [{"object": 1, "lifted": True, "dropped": False}]
    show.put("stone_1", start)
    show.play(0.5)
    late_s = show.time_s - 0.2
    grasps = show.truth(
        attempts=[attempt(begin_s, begin_s + 0.6, start), attempt(late_s, show.time_s, start)]
    )["grasps"]
    assert [grasp["dropped"] for grasp in grasps] == [True, False]
    assert [grasp["lifted"] for grasp in grasps] == [True, False]


def test_a_stone_that_was_set_down_was_not_dropped() -> None:
    show = Show()
    begin_s, start = lift(show)
    for boom_rad in np.linspace(1.15, 0.7, 10):  # the arm comes down with it
        show.data.joint("J_BOOM").qpos = boom_rad
        mujoco.mj_forward(show.model, show.data)
        show.put("stone_1", np.array(show.data.body("gripper").xpos) + np.array([0.0, 0.0, -0.9]))
        show.play(0.1)
    show.put("stone_1", position(show, "stone_1") - np.array([0.0, 0.0, 0.05]))
    show.play(0.1)
    show.data.joint("J_BOOM").qpos = 1.15  # and leaves without it
    show.play(0.5)
    grasps = show.truth(attempts=[attempt(begin_s, show.time_s, start)])["grasps"]
    assert grasps == [{"object": 1, "lifted": True, "dropped": False}]


def test_touching_the_target_is_no_collision_and_touching_another_stone_is() -> None:
    show = Show()
    one, two = position(show, "stone_1"), position(show, "stone_2")
    begin_s = show.time_s
    show.put("stone_1", show.at("gripper", 0.0, 0.0, -0.9))
    show.play(0.3)
    assert show.truth(attempts=[attempt(begin_s - 0.1, show.time_s, one)])["collisions"] == []
    collisions = show.truth(attempts=[attempt(begin_s - 0.1, show.time_s, two)])["collisions"]
    assert collisions
    assert {tuple(collision["bodies"])[1] for collision in collisions} == {"stone_1"}
    assert all(begin_s - 1e-9 <= c["from_s"] <= c["to_s"] <= show.time_s for c in collisions)
    assert max(collision["max_force_n"] for collision in collisions) > 0
    before_any_attempt = show.truth()["collisions"]
    assert len(before_any_attempt) == len(collisions)


def test_a_stone_in_the_cabin_is_a_collision_even_if_it_is_the_target() -> None:
    show = Show()
    start = position(show, "stone_1")
    show.put("stone_1", show.at("cabin", -0.9, 0.0, 0.9))
    show.play(0.3)
    collisions = show.truth(attempts=[attempt(0.0, show.time_s, start)])["collisions"]
    assert ["cabin", "stone_1"] in [collision["bodies"] for collision in collisions]


def test_contacts_with_short_gaps_are_one_and_with_long_gaps_two() -> None:
    show = Show()
    start, inside = position(show, "stone_1"), show.at("cabin", -0.9, 0.0, 0.9)
    for gap_s in (0.1, 0.5):
        show.put("stone_1", inside)
        show.play(0.2)
        show.put("stone_1", start)
        show.play(gap_s)
    show.put("stone_1", inside)
    show.play(0.2)
    spans = [c for c in show.truth()["collisions"] if c["bodies"] == ["cabin", "stone_1"]]
    assert len(spans) == 2


def test_jaws_on_the_ground_are_counted_apart() -> None:
    show = Show()
    show.data.joint("J_BOOM").qpos = -0.1
    show.data.joint("J_DIPPER").qpos = 0.0
    show.data.joint("J_TELE").qpos = 0.8
    show.data.joint("J_EE_PITCH").qpos = -0.04
    show.play(0.3)
    truth = show.truth()
    assert truth["ground_contacts"] > 0
    assert not [
        c
        for c in truth["collisions"]
        if set(c["bodies"]) & {"gripper", "jaw_left", "jaw_right"} and "terrain" in c["bodies"]
    ]


def test_estimates_are_held_against_the_cabin() -> None:
    show = Show()
    T_cabin = show.robot.world.T_world_body("cabin")

    def state(stamp_s: float, error_m: float, status: str = "GLOBAL") -> BaseState:
        T = pose(T_cabin[:3, :3], T_cabin[:3, 3] + [error_m, 0, 0])
        zero = np.zeros(3)
        return BaseState(stamp_s, np.eye(4), np.eye(4), T, zero, zero, np.eye(6), status)

    states = [state(0.0, 9.0, "INITIALISING"), state(0.05, 0.01), state(0.1, 0.03)]
    estimate = show.truth(states=states)["estimate"]
    distances = {"mean": 0.02, "std": 0.01, "max": 0.03}
    assert estimate["error_m"] == pytest.approx(
        distances | {"bias": 0.02, "component_std": 0.01 / 3}
    )
    assert estimate["error_rad"]["max"] == pytest.approx(0, abs=1e-6)
    assert show.truth()["estimate"] == {}


def test_a_real_run_without_commands_hits_nothing() -> None:
    robot = MujocoRobot(SETTINGS, MACHINE, np.random.default_rng(1))
    robot.start()
    robot.read(1.0)
    truth = plain(MujocoOracle(robot).truth(MissionView((), (), {}, ())))
    assert truth["collisions"] == []
    assert truth["grasps"] == []
    assert len(truth["stones"]) == 2
    assert robot.truth_log.end_s == pytest.approx(1.0)


def test_a_run_that_ended_before_its_first_step_has_a_truth_too() -> None:
    robot = MujocoRobot(SETTINGS, MACHINE, np.random.default_rng(1))
    robot.start()
    truth = plain(
        MujocoOracle(robot).truth(MissionView((), (), {}, [attempt(0.0, 0.0, (5.0, 0.0, 0.3))]))
    )
    assert truth["grasps"] == [{"object": 1, "lifted": False, "dropped": False}]
    assert truth["collisions"] == []


def test_an_empty_site_has_a_truth_too() -> None:
    settings = MujocoSettings.model_validate(
        {"site": {"stones": {"count": 0}, "terrain": {"half_size_m": 10}}}
    )
    robot = MujocoRobot(settings, MACHINE, np.random.default_rng(1))
    robot.start()
    robot.read(0.5)
    truth = plain(
        MujocoOracle(robot).truth(MissionView((), (), {}, [attempt(0.1, 0.2, (5.0, 0.0, 0.3))]))
    )
    assert truth["stones"] == []
    assert truth["grasps"] == [{"object": 1, "lifted": False, "dropped": False}]
