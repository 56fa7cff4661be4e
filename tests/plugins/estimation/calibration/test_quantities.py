"""What a solution says of each sensor: in the link's axes, with bounds and advice."""

from collections.abc import Iterable
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.estimation.calibration import quantities
from executive_plugins.estimation.calibration.keyframe_problem import Receiver, Solved, Unknowns
from executive_plugins.estimation.calibration.odometry_fit import OdometryFit
from executive_plugins.estimation.calibration.settings import KeyframeBatchSettings
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import Inertial

from executive.arrays import Float
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import from_rpy
from executive.interfaces.calibration import Quantity
from executive.messages.odometry import LidarIncrement

SETTINGS = KeyframeBatchSettings()
MOUNTED = pose(from_rpy(np.pi / 2, 0.0, np.pi / 2), np.array([0.1, 0.2, 0.3]))
R = MOUNTED[:3, :3]
IMU = SimpleNamespace(
    name="imu",
    link="cabin",
    T_link_sensor=MOUNTED,
    rate_hz=100.0,
    gyro_noise_rad_s=0.004,
    accel_noise_m_s2=0.06,
)
CLOCKS = "motion that starts, halts and turns while there are fixes of centimetres"
TURNS_ACROSS = "turns about the two axes across it: yaw for x and y, roll or pitch for z"
TURNS = "turns about at least two axes, or longer ways"
NO_CHANGE = "no change: measurements err by no more than they declare"


def told(one: Quantity) -> tuple[object, ...]:
    arrays = (one.value, one.std, one.declared)
    lists = [np.round(array, 9).tolist() for array in arrays]
    return one.sensor, one.name, *lists, one.is_found.tolist(), one.advice


def antenna(xyz_m: tuple[float, ...]) -> SimpleNamespace:
    return SimpleNamespace(link="cabin", xyz_m=xyz_m)


def solution(scales: tuple[float, float] = (1.0, 3.0)) -> Solved:
    """Two receivers; the second has the better known antenna."""
    arms = {"left": np.array([1.0, 2.0, 3.0]), "right": np.array([-1.0, 0.5, 2.0])}
    receivers = (
        Receiver(("left",), 0.05, scales[0]),
        Receiver(("right",), -0.02, scales[1]),
    )
    variances = [0.01**2, 0.02**2, 0.03**2, 0.006**2, 0.004**2, 0.005**2, 0.002**2, 0.003**2]
    among = Unknowns(arms, arms, receivers, 0.3, 0.15)
    attitude = np.diag([1e-6, 2e-6, 3e-6])
    return Solved(among, 0.0, np.diag(variances), attitude, 1.0, 50, ())


def samples(count: int, std: tuple[float, float] = (0.0, 0.0), dt_s: float = 0.02) -> SampleBuffer:
    rng, found = np.random.default_rng(1), SampleBuffer()
    for k in range(count):
        rate, force = std[0] * rng.normal(size=3), std[1] * rng.normal(size=3)
        found.append(Inertial(k * dt_s, rate, force, dt_s))
    return found


def test_a_few_samples_tell_the_rate_alone() -> None:
    inf = float("inf")
    advice = "more samples: some seconds of them"
    noise = [
        ("imu", "gyro_noise_rad_s", [0.004], [inf], [0.004], [False], advice),
        ("imu", "accel_noise_m_s2", [0.06], [inf], [0.06], [False], advice),
    ]
    assert [told(one) for one in quantities.inertial_quantities(IMU, samples(1))] == noise
    rate = ("imu", "rate_hz", [50.0], [0.0], [100.0], [True], "")
    assert [told(one) for one in quantities.inertial_quantities(IMU, samples(2))] == [rate, *noise]


def test_the_rate_is_that_of_most_samples() -> None:
    gapped = samples(5)
    gapped.append(Inertial(9.0, np.zeros(3), np.zeros(3), 8.9))
    gapped.append(Inertial(9.02, np.zeros(3), np.zeros(3), 0.02))
    assert quantities.inertial_quantities(IMU, gapped)[0].value == pytest.approx([50.0])


def test_noise_is_found_within_half_of_itself() -> None:
    _, gyro, accel = quantities.inertial_quantities(IMU, samples(1200, (0.01, 0.2)))
    assert (gyro.name, accel.name) == ("gyro_noise_rad_s", "accel_noise_m_s2")
    assert gyro.value == pytest.approx([0.01], rel=0.1)
    assert accel.value == pytest.approx([0.2], rel=0.1)
    assert gyro.is_found.all()
    assert gyro.std[0] < 0.1 * gyro.value[0]
    assert (gyro.advice, accel.advice) == ("", "")


@pytest.mark.parametrize(("std", "is_found"), [(0.25, True), (0.26, False)])
def test_the_bound_of_noise_is_two_sided_at_95_percent(
    monkeypatch: pytest.MonkeyPatch, std: float, is_found: bool
) -> None:
    """Of a noise of 1, a half is 1.96 times 0.2551."""
    monkeypatch.setattr(quantities, "white_noise", lambda values: (1.0, std))
    _, gyro, _ = quantities.inertial_quantities(IMU, samples(2))
    assert gyro.is_found.tolist() == [is_found]
    assert gyro.advice == ("" if is_found else "more samples: some seconds of them")


def test_antennas_are_told_in_the_axes_of_the_link() -> None:
    """The IMU's x axis is the link's y, its y the link's z, its z the link's x."""
    assert np.round(R, 9).tolist() == [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
    rig = SimpleNamespace(sensors={"left": antenna((3, 1, 2)), "right": antenna((2, -1, 1))})
    found = [told(one) for one in quantities.receiver_quantities(solution(), rig, IMU, SETTINGS)]
    assert found == [
        ("left", "stamp_late_s", [0.05], [0.002], [0.0], [True], ""),
        (
            "left",
            "xyz_m",
            [3.1, 1.2, 2.3],
            [0.03, 0.01, 0.02],
            [3.0, 1.0, 2.0],
            [False, True, False],
            TURNS_ACROSS,
        ),
        ("left", "covariance_scale", [1.0], [0.2], [1.0], [False], NO_CHANGE),
        ("right", "stamp_late_s", [-0.02], [0.003], [0.0], [False], CLOCKS),
        (
            "right",
            "xyz_m",
            [2.1, -0.8, 0.8],
            [0.005, 0.006, 0.004],
            [2.0, -1.0, 1.0],
            [True] * 3,
            "",
        ),
        ("right", "covariance_scale", [3.0], [0.6], [1.0], [True], ""),
    ]


def test_a_scale_is_found_within_half_of_itself() -> None:
    """Its standard deviation is √(2 / free): with 30 free residuals 0.2582 > 0.5 / 1.96."""
    rig = SimpleNamespace(sensors={"left": antenna((3, 1, 2)), "right": antenna((2, -1, 1))})
    for free, is_found in ((30, False), (31, True)):
        among = replace(solution(), free=free)
        scales = [
            one.is_found.all()
            for one in quantities.receiver_quantities(among, rig, IMU, SETTINGS)
            if one.name == "covariance_scale"
        ]
        assert scales == [False, is_found]


TURNED = pose(from_rpy(0.3, -0.2, 0.1), np.array([0.4, 0.5, 0.6]))  # in the link
VARIANCES = np.diag([1e-6, 2e-6, 3e-6, 1e-4, 2e-4, 3e-4, 0.001**2, 1.0, 1.0, 1.0, 1.0])


class Problem:
    """Stands for the hand-eye problem: keeps what it is given, has a fit at hand."""

    given: list["Problem"] = []
    fit: OdometryFit | None = None

    def __init__(
        self, own: Iterable[LidarIncrement], track: object, T: Float, stds: tuple[float, ...]
    ) -> None:
        self.own, self.track, self.T, self.stds = list(own), track, T, stds
        self.is_enough = len(self.own) > 1
        self.given.append(self)

    def solved(self) -> OdometryFit | None:
        return self.fit


@pytest.fixture
def problems(monkeypatch: pytest.MonkeyPatch) -> list[Problem]:
    fit = OdometryFit(inverse(MOUNTED) @ TURNED, 0.03, VARIANCES.copy(), 2.0, 50)
    monkeypatch.setattr(Problem, "given", [])
    monkeypatch.setattr(Problem, "fit", fit)
    monkeypatch.setattr(quantities, "OdometryProblem", Problem)
    monkeypatch.setattr(quantities, "MotionTrack", lambda *given: given)
    return Problem.given


def increment(frame: str, from_s: float = 0.0) -> LidarIncrement:
    return LidarIncrement(from_s, from_s + 0.1, frame, np.eye(4), np.eye(6))


def odometry(increments: list[LidarIncrement]) -> list[Quantity]:
    lidar = SimpleNamespace(
        link="cabin",
        T_link_sensor=pose(np.eye(3), np.array([1.0, 0.0, 0.0])),
        xyz_m=(1.0, 0.0, 0.0),
        rpy_rad=(0.1, 0.2, 0.3),
    )
    below = SimpleNamespace(**vars(lidar) | {"link": "chassis"})
    rig = SimpleNamespace(sensors={"lidar": lidar, "rear": lidar, "below": below})
    buffer = samples(1)
    return list(quantities.odometry_quantities(increments, solution(), buffer, rig, IMU, SETTINGS))


def test_each_sensor_on_the_link_is_laid_beside_the_motion(problems: list[Problem]) -> None:
    known = [increment("rear", 0.0), increment("lidar", 0.0), increment("lidar", 0.1)]
    found = odometry([increment("below"), increment("unknown"), *known])
    assert [one.own for one in problems] == [known[1:], known[:1]]
    assert problems[0].stds == (0.1, 0.3, 0.15)
    expected = inverse(MOUNTED) @ pose(np.eye(3), np.array([1.0, 0.0, 0.0]))
    assert pytest.approx(expected) == problems[0].T
    assert problems[0].track[2] == SETTINGS.gravity_m_s2
    assert {one.sensor for one in found} == {"lidar"}  # the other has too few increments


def test_a_mounting_errs_as_the_motion_does_too(problems: list[Problem]) -> None:
    """The motion errs by its best known antenna, here the second, and by its attitude."""
    late, arm, turn, scale = odometry([increment("lidar"), increment("lidar")])
    assert told(late) == ("lidar", "stamp_late_s", [0.03], [0.001], [0.0], [True], "")
    arms = np.diag([1e-4 + 0.006**2, 2e-4 + 0.004**2, 3e-4 + 0.005**2])
    assert arm.value == pytest.approx([0.4, 0.5, 0.6])
    assert arm.std == pytest.approx(np.sqrt(np.diag(R @ arms @ R.T)))
    assert arm.declared.tolist() == [1.0, 0.0, 0.0]
    assert arm.is_found.tolist() == [False, True, True]  # 17.9, 11.7 and 14.7 mm
    assert arm.advice == TURNS_ACROSS
    T = inverse(MOUNTED)[:3, :3] @ TURNED[:3, :3]
    turns = np.diag([1e-6, 2e-6, 3e-6]) + T.T @ np.diag([1e-6, 2e-6, 3e-6]) @ T
    assert turn.value == pytest.approx([0.3, -0.2, 0.1])
    expected = np.sqrt(np.diag(TURNED[:3, :3] @ turns @ TURNED[:3, :3].T))
    assert turn.std == pytest.approx(expected)
    assert turn.declared.tolist() == [0.1, 0.2, 0.3]
    assert (turn.name, turn.is_found.tolist(), turn.advice) == ("rpy_rad", [True] * 3, "")
    assert told(scale) == ("lidar", "covariance_scale", [2.0], [0.4], [1.0], [True], "")


def test_what_is_uncertain_needs_other_motion(
    problems: list[Problem], monkeypatch: pytest.MonkeyPatch
) -> None:
    vague = OdometryFit(inverse(MOUNTED) @ TURNED, 0.03, 100.0 * VARIANCES, 0.5, 50)
    monkeypatch.setattr(Problem, "fit", vague)
    found = odometry([increment("lidar"), increment("lidar")])
    assert [one.advice for one in found] == [CLOCKS, TURNS_ACROSS, TURNS, NO_CHANGE]
    assert not any(one.is_found.any() for one in found)
    monkeypatch.setattr(Problem, "fit", None)  # the increments do not determine it
    assert odometry([increment("lidar"), increment("lidar")]) == []
