"""The vertical by the sensor of a chassis at rest, through the turn joint and two mountings."""

from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.estimation.start.chassis_level import ChassisLevel

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.machine.machine import load_machine

M545 = load_machine("m545")
UP = np.array([0.0, 0.0, 1.0])
R_BASE_SENSOR, R_IMU_CABIN = from_rpy(0.3, -0.2, 1.0), from_rpy(-0.1, 0.4, 2.0)
R_CABIN_BASE = from_rpy(0.0, 0.0, 0.7)
R_MAP_BASE = from_rpy(0.15, -0.25, 0.5)  # the chassis stands on a slope


def level(force: Float | None, *, is_known: bool = True, bias: float = 0.05) -> ChassisLevel:
    sensor = SimpleNamespace(accel_bias_m_s2=bias, T_link_sensor=pose(R_BASE_SENSOR))
    turn = SimpleNamespace(is_known=is_known, T_cabin_base=lambda stamp_s: pose(R_CABIN_BASE))
    standing = SimpleNamespace(force=lambda stamp_s: force)
    return ChassisLevel(sensor, pose(R_IMU_CABIN), turn, standing)


def test_the_vertical_is_that_of_the_map_in_the_cabins_sensor() -> None:
    R_map_sensor = R_MAP_BASE @ R_BASE_SENSOR
    force = R_map_sensor.T @ (9.81 * UP)
    R_map_imu = R_MAP_BASE @ R_CABIN_BASE.T @ R_IMU_CABIN.T
    found = level(force).up_imu(1.0)
    np.testing.assert_allclose(R_map_imu @ found, UP, atol=1e-12)


def test_without_rest_or_a_known_turn_there_is_none() -> None:
    assert level(None).up_imu(1.0) is None
    assert level(9.81 * UP, is_known=False).up_imu(1.0) is None


@pytest.mark.parametrize(("bias", "expected"), [(0.05, 0.05), (1e-4, 1e-3), (0.0, 1e-3)])
def test_no_accelerometer_is_without_a_bias(bias: float, expected: float) -> None:
    assert level(9.81 * UP, bias=bias).accel_bias_m_s2 == expected


@pytest.mark.parametrize(
    ("name", "is_there"),
    [("imu_base", True), ("imu_cabin", False), ("gnss_left", False), ("imu_nowhere", False)],
)
def test_only_an_inertial_sensor_that_is_not_on_the_cabin_levels(name: str, is_there: bool) -> None:
    given = (np.eye(4), SimpleNamespace(), SimpleNamespace())
    assert (ChassisLevel.of(M545, name, *given) is not None) is is_there
