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


GNSS = MACHINE.sensors["gnss_left"]
GNSS_PERIOD_S = 1.0 / GNSS.rate_hz


def streamed(ages: Ages, periods: "set[int]", until: int) -> "list[tuple[str, int]]":
    """Return what is told of gaps while one antenna sends samples of some periods only."""
    told: list[tuple[str, int]] = []
    for k in range(1, until + 1):
        if k in periods:
            ages.take(GNSS.name, k * GNSS_PERIOD_S, "")
        told += [
            one for one in ages.gaps(k * GNSS_PERIOD_S + GNSS.latency_s) if one[0] == GNSS.name
        ]
    return told


def test_a_stream_that_is_complete_has_no_gap() -> None:
    ages = Ages(MACHINE, frozenset(), 0.0)
    assert streamed(ages, set(range(1, 51)), 50) == []
    assert GNSS.name not in ages.missing()


def test_a_gap_is_told_when_the_next_but_one_sample_is_due() -> None:
    ages = Ages(MACHINE, frozenset(), 0.0)
    assert streamed(ages, {1, 2}, 3) == []  # the third may still be on its way
    assert GNSS.name not in dict(ages.gaps(3.9 * GNSS_PERIOD_S + GNSS.latency_s))
    assert (GNSS.name, 1) in list(ages.gaps(4 * GNSS_PERIOD_S + GNSS.latency_s))
    assert ages.missing()[GNSS.name] == 1
    assert GNSS.name not in dict(ages.gaps(5 * GNSS_PERIOD_S + GNSS.latency_s))  # the same gap
    assert ages.missing()[GNSS.name] == 2


def test_missing_samples_are_counted_and_told_ever_more_seldom() -> None:
    ages = Ages(MACHINE, frozenset(), 0.0)
    every_fourth = set(range(1, 401, 4))
    assert streamed(ages, every_fourth, 397) == [(GNSS.name, 2**n) for n in range(7)]
    assert ages.missing()[GNSS.name] == 3 * 99


def test_a_sample_that_is_missing_alone_is_counted_when_the_next_one_comes() -> None:
    ages = Ages(MACHINE, frozenset(), 0.0)
    streamed(ages, {1, 2, 4, 5}, 5)
    assert ages.missing()[GNSS.name] == 1


def test_a_sample_that_is_refused_is_not_missing() -> None:
    ages = Ages(MACHINE, frozenset(), 0.0)
    ages.take(GNSS.name, GNSS_PERIOD_S, "")
    ages.take(GNSS.name, 2 * GNSS_PERIOD_S, "holds values that are not finite")
    assert GNSS.name not in dict(ages.gaps(10.0))
    ages.take(GNSS.name, 10.0, "")
    assert GNSS.name not in ages.missing()


def test_a_lidar_that_is_off_misses_nothing() -> None:
    ages = Ages(MACHINE, frozenset(), 0.0)
    assert LIDAR.name not in dict(ages.gaps(100.0))
    ages.command(SwitchLidars(True), 100.0)
    assert LIDAR.name not in dict(ages.gaps(100.0 + 3 / LIDAR.rate_hz))
    assert LIDAR.name in dict(ages.gaps(101.0))
