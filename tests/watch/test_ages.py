"""How old the newest good sample of each sensor is, and from when on it is too old."""

import pytest

from executive.machine.machine import load_machine
from executive.messages.command import MoveJaws, SwitchLidars
from executive.watch.ages import Ages

MACHINE = load_machine("m545")
IMU = MACHINE.sensors["imu_cabin"]
LIDAR = next(iter(MACHINE.sensors_of("lidar")))
JUST_S = 1e-3


def test_a_sensor_is_lost_once_its_newest_good_sample_is_older_than_its_limit() -> None:
    ages = Ages(MACHINE, frozenset(), 10.0)
    assert ages.troubles(10.0 + IMU.age_limit_s) == {}
    assert "imu_cabin" in ages.troubles(10.0 + IMU.age_limit_s + JUST_S)
    ages.take("imu_cabin", 11.0, "")
    ages.take("imu_cabin", 10.5, "")  # an older one makes it no older
    limit_s = 11.0 + IMU.age_limit_s
    assert "imu_cabin" not in ages.troubles(limit_s)
    told = ages.troubles(limit_s + JUST_S)["imu_cabin"]
    assert told == f"imu_cabin: no good sample for {IMU.age_limit_s + JUST_S:.2f} s"


def test_a_sample_that_is_refused_is_none_and_its_reason_is_told() -> None:
    ages = Ages(MACHINE, frozenset(), 0.0)
    ages.take("imu_cabin", 5.0, "holds values that are not finite")
    told = ages.troubles(5.0)["imu_cabin"]
    assert told.endswith(
        "no good sample for 5.00 s; the newest one holds values that are not finite"
    )
    ages.take("imu_cabin", 5.0, "")
    assert "imu_cabin" not in ages.troubles(5.0)
    ages.take("imu_of_a_visitor", 5.0, "")  # no sensor of the machine


@pytest.mark.parametrize("kind", ["imu", "gnss", "lidar", "encoders"])
def test_what_a_robot_lacks_is_never_lost(kind: str) -> None:
    ages = Ages(MACHINE, frozenset({kind}), 0.0)
    ages.command(SwitchLidars(True), 0.0)
    lost = {MACHINE.sensors[name].kind for name in ages.troubles(1e3)}
    assert lost == {one.kind for one in MACHINE.sensors.values()} - {kind}


def test_lidars_are_due_while_they_are_on_from_their_second_revolution_on() -> None:
    ages = Ages(MACHINE, frozenset(), 0.0)
    assert LIDAR.name not in ages.troubles(1e3)
    ages.command(MoveJaws(0.3, 8000.0), 90.0)
    assert LIDAR.name not in ages.troubles(1e3)
    ages.command(SwitchLidars(True), 100.0)
    limit_s = 100.0 + 2.0 / LIDAR.rate_hz + LIDAR.age_limit_s
    assert LIDAR.name not in ages.troubles(limit_s)
    assert LIDAR.name in ages.troubles(limit_s + JUST_S)
    ages.command(SwitchLidars(True), 200.0)  # it was on: nothing begins anew
    assert LIDAR.name in ages.troubles(200.0)
    ages.command(SwitchLidars(False), 201.0)
    assert LIDAR.name not in ages.troubles(1e3)
