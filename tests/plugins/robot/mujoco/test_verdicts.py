"""The bounds of the oracle's verdicts, on a truth that is written down by hand."""

from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.robot.mujoco.oracle import MujocoOracle
from executive_plugins.robot.mujoco.truth.contact_log import Span

from executive.events.event import plain
from executive.geometry.pose import pose
from executive.geometry.rotation import about_axis
from executive.interfaces.oracle import Attempt, MissionView
from executive.messages.structure import Structure

UP = np.array([0.0, 0.0, 1.0])
SILENT = {"states": (), "stones": (), "slots": {}, "attempts": ()}


class Log:
    """Two stones at rest; heights and distances from the palm are those of the test."""

    stones = ("stone_1", "stone_2")
    end_s = 100.0

    def __init__(self, heights=(), distances=(), spans=()) -> None:
        self._held = np.array(heights, dtype=float), np.array(distances, dtype=float)
        self._spans = tuple(spans)
        self.asked: list[tuple[int, float, float]] = []

    def holding(self, stone: int, from_s: float, to_s: float):
        self.asked.append((stone, from_s, to_s))
        return self._held

    def centroids(self, time_s: float) -> np.ndarray:
        return np.array([[1.0, 0.0, 0.3], [5.0, 0.0, 0.4]])

    def spans(self) -> tuple[Span, ...]:
        return self._spans

    def T_world_cabin(self, time_s: float) -> np.ndarray:
        return pose(about_axis(UP, 0.1 * time_s), np.array([time_s, 0.0, 0.0]))


def verdicts(log: Log, monkeypatch: pytest.MonkeyPatch, **view: object) -> dict[str, object]:
    oracle = object.__new__(MujocoOracle)
    oracle._log, oracle._scenario, oracle._legs = log, "kind", None
    oracle._limits = SimpleNamespace(found=tuple)
    oracle._hand = {"LINK_GRIPPER", "LINK_JAW"}
    monkeypatch.setattr(oracle.__class__, "_stones", lambda *given: [])
    tracking = SimpleNamespace(objects=dict, realignments=list)
    module = "executive_plugins.robot.mujoco.oracle"
    monkeypatch.setattr(f"{module}.Tracking", lambda *given: tracking)
    return plain(oracle.truth(MissionView(**(SILENT | view))))


def attempt(started_s: float, ended_s: float, x_m: float = 1.0) -> Attempt:
    return Attempt(7, started_s, ended_s, "placed", (x_m, 0.0, 0.3))


def grasp(monkeypatch, heights, distances) -> tuple[bool, bool]:
    log = Log(heights, distances)
    (found,) = verdicts(log, monkeypatch, attempts=[attempt(2.0, 9.0)])["grasps"]
    assert found["object"] == 7
    return found["lifted"], found["dropped"]


def test_a_stone_that_rose_by_more_than_fifteen_centimetres_was_lifted(monkeypatch) -> None:
    assert grasp(monkeypatch, [0.3, 0.44, 0.3], [1.0] * 3) == (False, False)
    assert grasp(monkeypatch, [0.3, 0.46, 0.3], [1.0] * 3) == (True, False)
    assert grasp(monkeypatch, [0.46, 0.46, 0.46], [1.0] * 3) == (True, False)  # it lay at 0.3
    assert grasp(monkeypatch, [], []) == (False, False)


@pytest.mark.parametrize(
    ("away_m", "fallen_m", "is_dropped"),
    [(0.25, 0.16, True), (0.25, 0.14, False), (0.19, 0.5, False), (0.21, 0.5, True)],
)
def test_a_stone_that_left_the_palm_from_higher_than_a_release_was_dropped(
    monkeypatch, away_m: float, fallen_m: float, is_dropped: bool
) -> None:
    """It counts from where it was held last, within five centimetres of its place at the top."""
    heights = [0.3, 1.5, 1.2, 1.2 - fallen_m / 2, 1.2 - fallen_m, 1.2 - fallen_m]
    distances = [2.0, 1.0, 1.04, 1.06, 1.0 + away_m, 1.0 + away_m]
    assert grasp(monkeypatch, heights, distances) == (True, is_dropped)


def test_a_stone_that_is_set_down_and_left_was_not_dropped(monkeypatch) -> None:
    heights = [0.3, 1.5, 0.9, 0.42, 0.4, 0.4]
    distances = [2.0, 1.0, 1.0, 1.02, 1.06, 3.0]
    assert grasp(monkeypatch, heights, distances) == (True, False)


def test_a_fall_counts_for_two_seconds_or_up_to_the_next_attempt(monkeypatch) -> None:
    log = Log([0.3], [1.0])
    attempts = [attempt(2.0, 9.0), attempt(10.5, 20.0, x_m=3.1), attempt(30.0, 40.0, x_m=2.9)]
    found = verdicts(log, monkeypatch, attempts=attempts)["grasps"]
    assert log.asked == [(0, 2.0, 10.5), (1, 10.5, 22.0), (0, 30.0, 42.0)]
    assert [one["lifted"] for one in found] == [False] * 3


def span(link: str, other: str, from_s: float = 1.0, to_s: float = 2.0) -> Span:
    return Span(link, other, from_s, to_s, 1234.56)


def collides(monkeypatch, *spans: Span, attempts=()) -> list[list[str]]:
    found = verdicts(Log([0.3], [1.0], spans), monkeypatch, attempts=attempts)
    return [one["bodies"] for one in found["collisions"]]


def test_only_the_hand_may_touch_the_ground_and_it_is_counted(monkeypatch) -> None:
    spans = [
        span("LINK_GRIPPER", "terrain"),
        span("LINK_JAW", "terrain"),
        span("LINK_BOOM", "terrain", 1.234, 5.678),
    ]
    found = verdicts(Log(spans=spans), monkeypatch)
    assert found["ground_contacts"] == 2
    told = {"from_s": 1.23, "to_s": 5.68, "max_force_n": 1234.6}
    assert found["collisions"] == [{"bodies": ["LINK_BOOM", "terrain"], **told}]


def test_the_hand_may_touch_the_stone_that_is_tried_and_no_other(monkeypatch) -> None:
    """It is the one of the newest attempt that had begun when the contact ended."""
    attempts = [attempt(10.0, 20.0), attempt(30.0, 40.0, x_m=5.0)]
    for stone, when, is_collision in (
        ("stone_1", (8.0, 9.9), True),
        ("stone_1", (8.0, 10.0), False),
        ("stone_2", (12.0, 13.0), True),
        ("stone_1", (12.0, 29.0), False),
        ("stone_2", (12.0, 30.0), False),
        ("stone_1", (35.0, 36.0), True),
        ("obstacle_1", (12.0, 13.0), True),
        ("LINK_BOOM", (12.0, 13.0), True),
    ):
        found = collides(monkeypatch, span("LINK_JAW", stone, *when), attempts=attempts)
        assert bool(found) == is_collision, (stone, when)
    assert collides(monkeypatch, span("LINK_BOOM", "stone_1", 12.0, 13.0), attempts=attempts)


def test_estimates_are_held_against_the_cabin_at_their_own_time(monkeypatch) -> None:
    """States that are not ready, or later than the truth, say nothing."""

    def state(stamp_s: float, off: tuple[float, ...], turned_rad: float, is_ready: bool = True):
        T = pose(about_axis(UP, 0.1 * stamp_s + turned_rad), np.array([stamp_s, 0.0, 0.0]) + off)
        return SimpleNamespace(is_ready=is_ready, stamp_s=stamp_s, T_map_cabin=T)

    states = [
        state(1.0, (0.03, 0.0, 0.04), 0.01),
        state(100.0, (0.01, 0.0, 0.0), -0.03),
        state(100.1, (9.0, 9.0, 9.0), 1.0),
        state(2.0, (9.0, 9.0, 9.0), 1.0, is_ready=False),
    ]
    told = verdicts(Log(), monkeypatch, states=states)["estimate"]
    assert told["error_m"] == pytest.approx(
        {
            "mean": 0.03,
            "std": 0.02,
            "max": 0.05,
            "bias": np.hypot(0.02, 0.02),
            "component_std": (0.01 + 0.0 + 0.02) / 3,
        }
    )
    assert told["error_rad"] == pytest.approx({"mean": 0.02, "std": 0.01, "max": 0.03})
    assert verdicts(Log(), monkeypatch, states=states[2:])["estimate"] == {}


class MovingLog(Log):
    """The first stone stands still in a wall but for 0.1 m at 50 s; the second is beside it."""

    def T_world_stone(self, stone: int, time_s: float) -> np.ndarray:
        x_m = (1.0 if time_s < 50.0 else 1.1) if stone == 0 else 5.0
        return pose(t=np.array([x_m, 0.0, 0.3]))


@pytest.mark.parametrize(("ended_s", "moved_m"), [((20.0,), 0.1), ((20.0, 60.0), 0.0)])
def test_a_stone_of_a_structure_moves_from_where_the_newest_attempt_left_it(
    monkeypatch, ended_s: tuple[float, ...], moved_m: float
) -> None:
    wall = Structure("wall", np.array([[0.0, 0.0], [2.0, 0.0]]), 1.0, 1.0)
    attempts = [attempt(one - 10.0, one) for one in ended_s]
    (found,) = verdicts(MovingLog([0.3], [1.0]), monkeypatch, attempts=attempts, structures=[wall])[
        "structures"
    ]
    assert (found["name"], found["stones"], found["verdict"]) == ("wall", [1], {})
    assert found["moved_m"] == [pytest.approx(moved_m)]
    assert found["T_map_stones"] == [pose(t=np.array([1.1, 0.0, 0.3])).tolist()]


def test_a_stone_that_was_never_picked_counts_as_standing_and_not_as_moved(monkeypatch) -> None:
    wall = Structure("wall", np.array([[0.0, 0.0], [2.0, 0.0]]), 1.0, 1.0)
    (found,) = verdicts(MovingLog(), monkeypatch, structures=[wall])["structures"]
    assert (found["stones"], found["moved_m"]) == ([1], [])


def test_a_machine_that_is_welded_has_no_stance(monkeypatch) -> None:
    found = verdicts(Log(), monkeypatch)
    assert (found["scenario"], found["stance"]) == ("kind", {})
    assert (found["map"], found["registration"]) == ({}, {})
