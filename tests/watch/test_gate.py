"""The gate refuses what cannot be true on the machine, and lets everything else pass."""

from dataclasses import replace

import numpy as np
import pytest

from executive.machine.machine import load_machine
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.watch.antenna_check import AntennaCheck
from executive.watch.gate import FUTURE, NOT_FINITE, NOT_FIXED, OUT_OF_ORDER, REPEATED, Gate
from executive.watch.sources import sensor_of

MACHINE = load_machine("m545")
N = len(MACHINE.joint_names)
AT = np.append(MACHINE.posture("carry"), 0.5)


def gate(**options):
    return Gate(MACHINE, AntennaCheck(MACHINE, lambda: (), lambda: None), **options)


def joints(stamp_s, position=AT, velocity=0.0, seed=None):
    noise = np.random.default_rng(round(1e3 * stamp_s) if seed is None else seed)
    off = 1e-4 * noise.standard_normal(N)
    return JointSample(stamp_s, MACHINE.joint_names, position + off, np.full(N, velocity), off)


def imu(stamp_s, frame="imu_cabin", rate=0.0):
    noise = 1e-3 * np.random.default_rng(round(1e3 * stamp_s)).standard_normal(3)
    return ImuSample(stamp_s, frame, noise + [0, 0, rate], noise + [0, 0, 9.81])


def refusals(one, samples):
    return [one.refusal(sample, sample.stamp_s)[1] for sample in samples]


def test_good_samples_pass():
    samples = [s for i in range(1, 50) for s in (joints(i / 100), imu(i / 100))]
    assert not any(refusals(gate(), samples))


def test_an_offset_that_lasts_stays_refused_and_its_end_is_taken():
    good = [joints(i / 100) for i in range(1, 10)]
    off = [joints(i / 100, AT + 0.05) for i in range(10, 200)]
    after = [joints(i / 100) for i in range(200, 210)]
    answers = refusals(gate(), [*good, *off, *after])
    assert not any(answers[:9])
    assert all("has jumped by" in told for told in answers[9:199])
    assert not any(answers[199:])


def test_a_position_that_a_gap_explains_passes():
    one = gate()
    assert not any(refusals(one, [joints(0.01), joints(0.02), joints(5.0, AT + 0.05)]))


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"position": AT + [0, 9, 0, 0, 0, 0, 0, 0]}, "J_BOOM is at"),
        ({"velocity": np.full(N, 50.0)}, "J_TURN moves at 50"),
        ({"effort": np.full(N, 1e9)}, "J_TURN has the effort"),
    ],
)
def test_values_beyond_the_machines_limits_are_refused(change, told):
    assert told in refusals(gate(), [replace(joints(0.01), **change)])[0]


def test_stamps_in_the_future_and_out_of_order_are_refused():
    one = gate()
    assert one.refusal(joints(1.0), 0.5)[1] == FUTURE
    assert one.refusal(joints(0.5), 0.5)[1] == ""
    assert one.refusal(joints(0.5, seed=9), 0.5)[1] == OUT_OF_ORDER
    assert one.refusal(joints(0.4), 0.5)[1] == OUT_OF_ORDER


def test_repeated_values_are_a_fault_only_of_sensors_with_noise():
    twice = [joints(0.01, seed=3), joints(0.02, seed=3)]
    assert refusals(gate(), twice) == ["", REPEATED]
    assert refusals(gate(is_ideal=True), twice) == ["", ""]


def test_an_imu_that_the_other_and_the_turn_joint_contradict_is_refused():
    one = gate()
    calm = [s for i in range(1, 5) for s in (joints(i / 100), imu(i / 100, "imu_base"))]
    assert not any(refusals(one, calm))
    assert "off imu_base and the turn joint" in refusals(one, [imu(0.05, rate=0.1)])[0]
    assert refusals(one, [imu(0.051)]) == [""]


def test_rates_beyond_the_sensors_range_are_refused():
    assert "beyond its range" in refusals(gate(), [imu(0.01, rate=50.0)])[0]


ANTENNA = next(iter(MACHINE.sensors_of("gnss"))).name
LIDAR = next(iter(MACHINE.sensors_of("lidar"))).name
GEODETIC = np.array([47.0, 8.0, 440.0])


def damaged(sample, name, value):
    """Return a sample with a value that no message can be made with."""
    values = getattr(sample, name).copy()
    values[1] = value
    object.__setattr__(sample, name, values)
    return sample


def fix(stamp_s, **change):
    return replace(GnssFix(stamp_s, ANTENNA, GEODETIC, 1e-4 * np.eye(3), True), **change)


@pytest.mark.parametrize(
    ("sample", "told"),
    [
        (damaged(joints(0.01), "position", np.nan), NOT_FINITE),
        (damaged(imu(0.01), "angular_velocity_rad_s", -np.inf), NOT_FINITE),
        (replace(imu(0.01), stamp_s=np.nan), NOT_FINITE),
        (fix(0.01, is_rtk_fixed=False), NOT_FIXED),
    ],
)
def test_what_holds_no_measurement_is_refused_and_counted_by_its_reason(sample, told):
    one = gate()
    name = sensor_of(sample, MACHINE).name
    assert one.refusal(sample, 0.01) == (name, told)
    assert one.refused == {(name, told): 1}
    assert one.refusal(sample, -1.0)[1] in (FUTURE, NOT_FINITE)
    assert one.refused.total() == 2
    assert one.good(name) is None


def test_the_newest_good_observation_of_each_sensor_is_known():
    one = gate()
    seen = [imu(0.01), fix(0.02), imu(0.03), fix(0.04, is_rtk_fixed=False)]
    assert [one.refusal(sample, sample.stamp_s)[0] for sample in seen] == [
        "imu_cabin",
        ANTENNA,
        "imu_cabin",
        ANTENNA,
    ]
    assert one.good("imu_cabin") is seen[2]
    assert one.good(ANTENNA) is seen[1]
    assert one.good("another") is None


def test_a_stamp_may_be_ahead_by_one_period_of_its_sensor():
    rate_hz = MACHINE.sensors["imu_cabin"].rate_hz
    assert gate().refusal(imu(1.0 + 0.9 / rate_hz), 1.0)[1] == ""
    assert gate().refusal(imu(1.0 + 1.1 / rate_hz), 1.0)[1] == FUTURE


def test_what_is_of_no_sensor_of_the_machine_passes_and_is_not_kept():
    one = gate()
    unknown = imu(0.01, "imu_of_a_visitor")
    assert one.refusal(unknown, 0.0) == ("", "")
    assert one.refusal(unknown, 0.0) == ("", "")
    assert one.good("imu_of_a_visitor") is None
    assert not one.refused


def test_after_a_hold_joints_may_be_elsewhere():
    kept, forgot = gate(), gate()
    for one in (kept, forgot):
        assert not any(refusals(one, [joints(0.01), joints(0.02)]))
        assert "has jumped by" in refusals(one, [joints(0.03, AT + 0.05)])[0]
    forgot.forget()
    assert refusals(forgot, [joints(5.0, AT + 0.05)]) == [""]  # there was time to move
    assert "has jumped by" in refusals(kept, [joints(0.04, AT + 0.05)])[0]


def test_a_scan_is_checked_against_its_sensors_range():
    one = gate()
    near = np.random.default_rng(3).normal(0, 1.0, (50, 3)) + [5, 0, 0]
    stamps = np.linspace(0.0, 0.1, 50)
    assert refusals(one, [LidarScan(0.1, LIDAR, near, stamps)]) == [""]
    told = refusals(one, [LidarScan(0.2, LIDAR, 1000 * near, stamps + 0.1)])[0]
    assert told not in ("", NOT_FINITE)
