"""When a sensor counts as lost: some periods without a good sample, beside its latency."""

from dataclasses import dataclass

import pytest
from pydantic import ValidationError

from executive.machine.machine import load_machine
from executive.machine.sensor import Encoders, Gnss, Imu, Lidar


@dataclass(frozen=True)
class Case:
    rate_hz: float
    latency_s: float
    age_periods: float
    limit_s: float


@pytest.mark.parametrize(
    "case", [Case(10.0, 0.0, 3.0, 0.3), Case(100.0, 0.02, 5.0, 0.07), Case(0.5, 0.0, 1.0, 2.0)]
)
def test_a_sensor_is_lost_after_its_latency_and_so_many_periods(case: Case) -> None:
    (lidar, *_) = load_machine("m545").sensors_of("lidar")
    assert isinstance(lidar, Lidar)
    changed = lidar.model_copy(
        update={
            "rate_hz": case.rate_hz,
            "latency_s": case.latency_s,
            "age_periods": case.age_periods,
        }
    )
    assert changed.age_limit_s == pytest.approx(case.limit_s)


ORIGIN = {"name": "a", "link": "base", "rate_hz": 10.0, "provenance": "guess"}
LIDAR = {
    "kind": "lidar",
    "lasers": 16,
    "elevation_rad": (-0.2, 0.2),
    "azimuth_step_rad": 0.01,
    "range_m": (0.5, 50.0),
    "range_noise_m": 0.02,
}
IMU = {
    "kind": "imu",
    **dict.fromkeys(
        (
            "gyro_noise_rad_s",
            "gyro_bias_rad_s",
            "gyro_walk_rad_s",
            "accel_noise_m_s2",
            "accel_bias_m_s2",
            "accel_walk_m_s2",
        ),
        0.0,
    ),
}
GNSS = {"kind": "gnss", "horizontal_noise_m": 0.01, "vertical_noise_m": 0.02}
ENCODERS = {
    "kind": "encoders",
    **dict.fromkeys(("angle_noise_rad", "length_noise_m", "velocity_noise", "effort_noise"), 0.0),
}


def made(kind: type, given: dict, **changes: object) -> object:
    return kind(**{**ORIGIN, **given, **changes})


def test_what_is_not_said_of_a_sensor_is_usual() -> None:
    lidar, imu = made(Lidar, LIDAR), made(Imu, IMU)
    assert (lidar.latency_s, lidar.age_periods, lidar.may_repeat) == (0.0, 3.0, False)
    assert (imu.gyro_range_rad_s, imu.accel_range_m_s2) == (8.7, 78.0)


@pytest.mark.parametrize(
    ("kind", "given", "name", "good", "bad"),
    [
        (Lidar, LIDAR, "rate_hz", (0.5,), (0.0,)),
        (Lidar, LIDAR, "latency_s", (0.0, 0.99), (-0.1, 1.0)),
        (Lidar, LIDAR, "age_periods", (1.0, 1000.0), (0.9, 1000.5)),
        (Lidar, LIDAR, "lasers", (1, 128), (0, 129)),
        (Lidar, LIDAR, "azimuth_step_rad", (0.001, 0.19), (0.0, 0.2)),
        (Lidar, LIDAR, "range_noise_m", (0.0,), (-0.01,)),
        (Imu, IMU, "gyro_range_rad_s", (0.5,), (0.0,)),
        (Imu, IMU, "accel_range_m_s2", (0.5,), (0.0,)),
        *((Imu, IMU, name, (0.0, 0.5), (-0.01,)) for name in IMU if name != "kind"),
        (Gnss, GNSS, "horizontal_noise_m", (0.5,), (0.0,)),
        (Gnss, GNSS, "vertical_noise_m", (0.5,), (0.0,)),
        (Encoders, ENCODERS, "angle_noise_rad", (0.0, 0.5), (-0.01,)),
        (Encoders, ENCODERS, "length_noise_m", (0.0, 0.5), (-0.01,)),
        (Encoders, ENCODERS, "velocity_noise", (0.0, 0.5), (-0.01,)),
        (Encoders, ENCODERS, "effort_noise", (0.0, 0.99), (-0.01, 1.0)),
    ],
)
def test_figures_of_sensors_have_bounds(
    kind: type, given: dict, name: str, good: tuple, bad: tuple
) -> None:
    for value in good:
        assert getattr(made(kind, given, **{name: value}), name) == value
    for value in bad:
        with pytest.raises(ValidationError, match=name):
            made(kind, given, **{name: value})
