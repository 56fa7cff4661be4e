"""Figures of a replay: errors against fixes, corrections, outages, tables, drops and offsets."""

from types import SimpleNamespace

import numpy as np

from executive.errors import ConfigError
from executive.estimate.compare import odometry_steps, reported, table
from executive.estimate.drop import Drop
from executive.estimate.measures import (
    Track,
    consistency,
    fix_errors,
    outages,
    spread,
    statistics,
)
from executive.estimate.offset import Offset
from executive.geometry.geodesy import geodetic_from_enu
from executive.geometry.pose import pose
from executive.geometry.rotation import exp_so3
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.lidar import LidarScan
from executive.messages.odometry import LidarIncrement

DATUM = np.array([47.4084, 8.5106, 440.0])


def track(count: int = 160) -> Track:
    """Return a cabin that turns and drives, whose map steps now and then."""
    rng, stamps = np.random.default_rng(1), np.arange(count) / 32
    T = np.array(
        [pose(exp_so3(np.array([0, 0, 0.3 * t])), np.array([t, 0.2 * t, 1])) for t in stamps]
    )
    steps = np.cumsum(0.02 * (np.arange(count) % 20 == 0))
    T_odom_map = np.array([pose(t=np.array([s, 0, 0])) for s in steps])
    v, w = rng.normal(0, 1, (2, count, 3))
    return Track(stamps, T, T_odom_map @ T, T @ pose(t=np.array([0, 0, 1.0])), v, w)


def fixes(count: int = 45) -> list[GnssFix]:
    made = []
    for k in range(-2, count):
        t, name = k / 8, ("gnss_left", "gnss_right")[k % 2]
        enu = np.array([t, 0.2 * t, 3.0])
        made.append(GnssFix(t, name, geodetic_from_enu(enu, DATUM), np.eye(3) * 1e-4, True))
    return made


DROPS = [
    Drop("gnss", 1.0, 2.0),
    Drop("gnss_left", 3.0, 4.0),
    Drop("imu", 1.0, 2.0),
    Drop("gnss", 9, 10),
]


def test_errors(recorded, machine) -> None:
    errors = fix_errors(track(), fixes(), machine, DATUM, DROPS)
    told = errors, outages(errors, DROPS), consistency(track()), odometry_steps(track())
    # Coordinates of the earth's radius lose nine digits to metres.
    recorded((told, spread(errors.predicted_m)), absolute=1e-7)


def test_statistics(recorded) -> None:
    values = np.random.default_rng(2).normal(0, 1, 50)
    recorded(
        [
            statistics(values),
            statistics(values, 2),
            statistics(values[:0]),
            spread(np.zeros((0, 3))),
        ]
    )


def estimated(statuses: str) -> SimpleNamespace:
    kinds = {"G": "GLOBAL", "F": "FALLBACK", "R": "RECOVERING"}
    states = [{"time_s": 0.5 * k, "status": kinds[s]} for k, s in enumerate(statuses)]
    lost = [
        {"sensor": "gnss", "from_s": a, "to_s": b, "error_at_end_m": 0.12345, "max_error_m": 0.5,
         "way_m": 12.0} for a, b in ((1.0, 2.0), (2.0, 2.75), (4.0, 9.0))
    ]  # fmt: skip
    figures = {"mean": 0.0123, "std": 0.004, "p95": 0.02, "p99": 0.03, "max": 0.05, "n": 7}
    report = {"states": states, "outages": lost, "prediction_m": figures, "posterior_m": {"n": 0},
              "consistency_m": figures, "latency_us": figures, "replay_speed": 12.34}  # fmt: skip
    replay = SimpleNamespace(states=[SimpleNamespace(stamp_s=0.25 * k) for k in range(30)])
    return SimpleNamespace(report=report, track=track(), replay=replay)


def truth(states):
    error = {
        "mean": 0.01 * len(states),
        "std": 0.002,
        "max": 0.1,
        "bias": [0.1, 0, 0],
        "std_axis": 0.1,
    }
    return {"error_m": error | {"bias_m": 0.02, "component_std": 0.01}, "error_rad": error}


def test_comparisons(recorded) -> None:
    plain = {name: reported(estimated(name)) for name in ("GGGGFFRGGG", "FFFFFFFFFF", "GGGGG")}
    told: list[object] = [plain, table(plain)]
    judged = {name: reported(estimated(name), truth) for name in ("GGGGFFRGGG", "GGFFG")}
    told.append(judged)
    recorded(told)


def observations() -> list[object]:
    return [
        GnssFix(1.0, "gnss_left", DATUM, np.eye(3), True),
        ImuSample(2.0, "imu_cabin", np.zeros(3), np.ones(3)),
        LidarScan(2.0, "lidar_horizontal", np.ones((2, 3)), np.array([1.9, 2.0])),
        LidarIncrement(1.5, 2.0, "lidar_horizontal", np.eye(4), np.eye(6)),
    ]


def test_drops_and_offsets(recorded) -> None:
    told: list[object] = []
    for text in ("gnss:1:2", "gnss_left:0.5:1", "imu:2:2.5", "lidar:0:2", "lidar:1.9:2.1", "a:2:1",
                 "a:1:1", "gnss:1", "gnss:a:b", "x:y:1:2"):  # fmt: skip
        try:
            drop = Drop.parse(text)
            told.append((drop, [drop.takes(one) for one in observations()]))
        except ConfigError as error:
            told.append(error)
    for text in ("gnss:0.25", "lidar:-1", "imu_cabin:1e-3", "gnss:", ":1", "gnss", "a:b:2"):
        try:
            offset = Offset.parse(text)
            told.append((offset, [offset.applied(one) for one in observations()]))
        except ConfigError as error:
            told.append(error)
    recorded(told)
