"""A log that was read: where its map begins, and which sensors it has."""

from types import SimpleNamespace

import numpy as np
import pytest

from executive.errors import DataError
from executive.estimate import material as material_of_a_log
from executive.estimate.material import Material, _first_fix, _odometry, _without_scans
from executive.interfaces.odometry import LidarOdometry
from executive.logs.log import Arrival
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.odometry import LidarIncrement
from executive.tree.choices import Choices

RIG = SimpleNamespace(name="car", sensors={"gnss_left": None, "gnss_right": None})


def fix(stamp_s: float, antenna: str = "gnss_left", is_rtk_fixed: bool = True) -> Arrival:
    where = np.array([47.0, 8.0, 400.0 + stamp_s])
    return Arrival(stamp_s, GnssFix(stamp_s, antenna, where, np.eye(3), is_rtk_fixed))


def sample(stamp_s: float, frame: str) -> Arrival:
    return Arrival(stamp_s, ImuSample(stamp_s, frame, np.zeros(3), np.zeros(3)))


def material(*arrivals: Arrival) -> Material:
    log = SimpleNamespace(path="a.mcap")
    return Material(log, RIG, arrivals, np.array([47.0, 8.0, 400.0]))  # type: ignore[arg-type]


def test_the_map_begins_at_the_first_fix_with_a_fixed_solution(caplog) -> None:
    arrivals = [sample(0.5, "imu"), fix(1.0, is_rtk_fixed=False), fix(2.0), fix(3.0)]
    assert _first_fix("a.mcap", RIG, arrivals).stamp_s == 2.0
    assert not caplog.records


def test_without_a_fixed_solution_it_begins_at_the_first_fix_with_a_warning(caplog) -> None:
    arrivals = [fix(1.0, is_rtk_fixed=False), fix(2.0, is_rtk_fixed=False)]
    assert _first_fix("a.mcap", RIG, arrivals).stamp_s == 1.0
    assert "none of 2 fixes has a fixed RTK solution" in caplog.text


def test_a_log_without_a_fix_has_no_map() -> None:
    with pytest.raises(DataError, match="the receiver has no fix in the whole log"):
        _first_fix("a.mcap", RIG, [sample(0.5, "imu")])


def test_an_antenna_that_the_rig_lacks_is_named_with_the_cure() -> None:
    with pytest.raises(DataError, match=r"car has no antenna gnss_roof; name the machine"):
        _first_fix("a.mcap", RIG, [fix(1.0), fix(2.0, "gnss_roof")])


def test_a_log_without_inertial_samples_describes_no_body() -> None:
    with pytest.raises(DataError, match=r"^a\.mcap: the inertial topic holds no message$"):
        material(fix(1.0)).body()


def test_a_body_has_its_inertial_sensors_in_order_of_their_first_sample_and_the_datum() -> None:
    body = material(sample(0.0, "b"), fix(0.5), sample(1.0, "a"), sample(2.0, "b")).body()
    assert tuple(body.imus) == ("b", "a")
    assert body.datum == (47.0, 8.0, 400.0)
    assert not body.is_described


class Odometry(LidarOdometry):
    """Makes an increment of every second scan, and keeps what it is given."""

    def __init__(self) -> None:
        self.taken: list[tuple[str, float]] = []
        self.is_closed = False

    def add_imu(self, sample: ImuSample) -> None:
        self.taken.append(("imu", sample.stamp_s))

    def add_joints(self, sample: JointSample) -> None:
        self.taken.append(("joints", sample.stamp_s))

    def add_scan(self, scan: LidarScan) -> LidarIncrement | None:
        self.taken.append(("scan", scan.stamp_s))
        scans = sum(kind == "scan" for kind, _ in self.taken)
        increment = LidarIncrement(0.0, scan.stamp_s, "lidar", np.eye(4), np.eye(6))
        return None if scans % 2 else increment

    def close(self) -> None:
        self.is_closed = True


def arrivals_of_a_lidar() -> list[Arrival]:
    joints = JointSample(0.2, ("J",), np.zeros(1), np.zeros(1), np.zeros(1))
    scans = [LidarScan(t, "lidar", np.ones((1, 3)), np.array([t])) for t in (0.3, 0.6)]
    return [
        sample(0.1, "imu"),
        Arrival(0.25, joints),
        Arrival(0.35, scans[0]),
        fix(0.4),
        Arrival(0.65, scans[1]),
    ]


def test_an_odometry_is_given_all_that_it_takes_and_its_increments_stand_for_the_scans(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    odometry = Odometry()
    monkeypatch.setattr(material_of_a_log, "_odometry", lambda plugins, rig: odometry)
    arrivals = arrivals_of_a_lidar()
    found = list(_without_scans(arrivals, Choices(()), RIG))  # type: ignore[arg-type]
    assert odometry.taken == [("imu", 0.1), ("joints", 0.2), ("scan", 0.3), ("scan", 0.6)]
    assert odometry.is_closed
    assert found[:3] == [arrivals[0], arrivals[1], arrivals[3]]
    (last,) = found[3:]
    assert isinstance(last.observation, LidarIncrement)
    assert (last.arrival_s, last.observation.to_s) == (0.65, 0.6)


def test_without_an_odometry_scans_are_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(material_of_a_log, "_odometry", lambda plugins, rig: None)
    arrivals = arrivals_of_a_lidar()
    found = list(_without_scans(arrivals, Choices(()), RIG))  # type: ignore[arg-type]
    assert found == [arrivals[0], arrivals[1], arrivals[3]]


@pytest.mark.parametrize("lidars", [(), (SimpleNamespace(name="lidar"),)])
def test_without_a_lidar_or_a_choice_there_is_no_odometry(lidars: tuple[object, ...]) -> None:
    rig = SimpleNamespace(sensors_of=lambda kind: lidars)
    assert _odometry(Choices(()), rig) is None  # type: ignore[arg-type]
