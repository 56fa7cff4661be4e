"""A resumed mission looks around before it moves: where it is, what it holds, what lies there."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from executive.errors import RobotError
from executive.events.mission import WorldObserved
from executive.interfaces.objects import ObjectDatabase
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.stone import Stone, StoneState
from executive.messages.verdict import Trouble
from executive.mission.context import Services
from executive.mission.observation import Observation

TICK_S = 0.05
T_MAP_BASE = np.array(  # a quarter turn to the left, 10 m to the east
    [[0.0, -1, 0, 10], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
)
T_BASE_LIDAR = np.eye(4)
T_BASE_LIDAR[:3, 3] = 1.0, 0.0, 2.0
ROW = np.array([[0.5 * i, 0.0, 0.0] for i in range(5)])  # points far from each other [m]

BLOCK = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])


class Robot:
    def __init__(self):
        self.told = []

    def stop(self):
        self.told.append("stop")

    def command(self, command):
        self.told.append(f"lidars {'on' if command.on else 'off'}")


class Monitor:
    def __init__(self, payload_kg=None):
        self._payload_kg, self.holds = payload_kg, 0

    def begin_hold(self):
        self.holds += 1

    def begin_carry(self):
        pass

    def payload_kg(self, joints):
        return self._payload_kg


class Objects(ObjectDatabase):
    def __init__(self, *stones):
        self._stones = stones

    def stones(self):
        return self._stones

    def stone(self, stone_id):
        return next(one for one in self._stones if one.id == stone_id)


Objects.__abstractmethods__ = frozenset()


def stone(number, state=StoneState.ON_GROUND, points=ROW):
    return Stone(number, state, points, points.mean(axis=0), np.eye(4), True)


def scan_of(points_map):
    """Return the scan in which the lidar measures points in the map."""
    points_lidar = (points_map - T_MAP_BASE[:3, 3]) @ T_MAP_BASE[:3, :3] - T_BASE_LIDAR[:3, 3]
    return LidarScan(1.0, "lidar", points_lidar, np.zeros(len(points_lidar)))


@dataclass
class Site:
    """A machine at rest after its run was cut off, and what it records."""

    services: Services
    robot: Robot
    streams: SimpleNamespace
    events: list

    def observe(self, scans=(), status="GLOBAL"):
        """Observe to the end, with the scans arriving one a tick; return the number of ticks."""
        self.streams.status, scans = status, list(scans)
        ticks = 0
        for _ in Observation(self.services).steps():
            ticks += 1
            self.services.clock.time_s += self.services.tick_s
            self.streams.arrived_scans = [scans.pop(0)] if scans else []
        return ticks

    def seen(self):
        (event,) = self.events
        return event.payload()


def site(jaw_rad=0.5, monitors=(), lidar_rates_hz=(10.0, 20.0), tick_s=TICK_S, **plugins):
    robot, events = Robot(), []
    streams = SimpleNamespace(
        joints=JointSample(1.0, ("arm", "jaw"), np.array([1.5, jaw_rad]), *np.zeros((2, 2))),
        arrived_scans=[],
        monitors=monitors,
        status="GLOBAL",
    )
    streams.state = lambda: SimpleNamespace(
        status=streams.status, is_ready=streams.status == "GLOBAL", T_map_base=T_MAP_BASE
    )
    machine = SimpleNamespace(
        jaw=SimpleNamespace(name="jaw"),
        arm_names=("arm",),
        sensors_of=lambda kind: [SimpleNamespace(rate_hz=rate) for rate in lidar_rates_hz],
    )

    def frames(arm):
        np.testing.assert_array_equal(arm, [1.5])
        return {"lidar": T_BASE_LIDAR}

    clock = SimpleNamespace(time_s=7.0)
    clock.now_s = lambda: clock.time_s
    services = Services(
        clock=clock,
        tick_s=tick_s,
        seed=0,
        machine=machine,
        kinematics=SimpleNamespace(frames=frames),
        plugins={"robot": robot, "monitoring": monitors, **plugins},
        jobs=None,
        streams=streams,
        account=None,
        journal=None,
        folder=None,
        record=lambda node, event: events.append(event),
        show=None,
        regions={},
        verdicts=["of before"],
    )
    return Site(services, robot, streams, events)


def test_a_machine_without_stones_and_without_a_map_tells_its_state_and_its_jaws():
    found = site(jaw_rad=0.02)
    assert found.observe() == 0
    assert found.robot.told == ["stop"]  # the lidars are not switched: no map takes their scans
    assert isinstance(found.events[0], WorldObserved)
    assert found.seen() == {
        "status": "GLOBAL", "jaw_rad": 0.02, "held": None, "is_held": False, "payload_kg": None,
        "seen": [], "unseen": [],
    }  # fmt: skip


def test_the_lidars_are_on_for_six_revolutions_of_the_slowest():
    found = site(mapping=object())
    assert found.observe() == 12  # 6 / (10 Hz) in ticks of 0.05 s
    assert found.robot.told == ["stop", "lidars on", "lidars off"]
    found = site(mapping=object(), lidar_rates_hz=())
    assert found.observe() == 0
    assert found.robot.told == ["stop"]


def test_the_lidars_are_off_again_when_the_observation_is_given_up():
    found = site(mapping=object())
    steps = Observation(found.services).steps()
    next(steps)
    steps.close()
    assert found.robot.told == ["stop", "lidars on", "lidars off"]
    assert found.events == []


def test_a_stone_is_seen_where_five_of_its_points_have_a_return_within_ten_centimetres():
    places = {1: 0.09, 2: 0.12, 3: 0.09}  # how far beside a stone the returns lie [m]
    stones = [stone(n, points=ROW + [0.0, 3.0 * n, 0.0]) for n in places]
    returns = [one.points_map + [0.0, 0.0, places[one.id]] for one in stones]
    returns[2] = returns[2][:4]
    found = site(mapping=object(), objects=Objects(*stones))
    found.observe([scan_of(points) for points in returns])
    assert (found.seen()["seen"], found.seen()["unseen"]) == ([1], [2, 3])


def test_only_stones_that_lie_somewhere_are_looked_for():
    states = [StoneState.ON_GROUND, StoneState.PLACED, StoneState.SET_ASIDE, StoneState.LOST]
    stones = [stone(n, state, ROW + [0.0, n, 0.0]) for n, state in enumerate(states, 1)]
    found = site(objects=Objects(*stones))
    found.observe()  # without a scan
    assert (found.seen()["seen"], found.seen()["unseen"]) == ([], [1, 2, 3])


@pytest.mark.parametrize("jaw_rad", [0.08, 0.07])
def test_a_stone_is_held_by_jaws_that_are_open_and_otherwise_has_dropped(jaw_rad):
    monitors = Monitor(), Monitor(812.34), Monitor(5.0)
    held = stone(4, StoneState.HELD, BLOCK)  # of 2.7 t: much less hangs in the jaws
    found = site(jaw_rad, monitors, objects=Objects(stone(3), held))
    found.observe()
    assert found.seen() == {
        "status": "GLOBAL", "jaw_rad": jaw_rad, "held": 4, "is_held": jaw_rad == 0.08,
        "payload_kg": 812.3, "seen": [], "unseen": [3],
    }  # fmt: skip
    assert [one.holds for one in monitors] == [1, 1, 1]
    told = [(one.stamp_s, one.monitor, one.trouble) for one in found.services.verdicts]
    weighed_s = 7.0 + 0.4
    expected = [(pytest.approx(weighed_s, abs=0.06), "resume", Trouble.DROP)]
    assert told == ([] if jaw_rad == 0.08 else expected)


def test_a_stone_that_hangs_within_closed_jaws_is_held():
    held = stone(4, StoneState.HELD, BLOCK)
    found = site(0.0, (Monitor(0.9 * held.mass_by_volume_kg),), objects=Objects(held))
    found.observe()
    assert found.seen()["is_held"]
    assert found.services.verdicts == []


def test_monitors_are_told_of_no_hold_where_none_is_known():
    monitor = Monitor()
    found = site(monitors=(monitor,), objects=Objects(stone(3)))
    found.observe()
    assert monitor.holds == 0
    assert found.services.verdicts == ["of before"]


@pytest.mark.parametrize("missing", ["pose", "joints"])
def test_a_machine_that_is_not_localised_within_a_minute_does_not_move(missing):
    found = site(tick_s=1.0)
    if missing == "joints":
        found.streams.joints = None
    else:
        found.streams.status = "ALIGNING"
    steps = Observation(found.services).steps()
    for _ in range(60):
        next(steps)
    told = rf"not localised within 60 s .* its state is {found.streams.status}\. Nothing has moved"
    with pytest.raises(RobotError, match=told):
        next(steps)
    assert found.events == []
