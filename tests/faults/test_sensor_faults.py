"""Each fault of a sensor acts on the samples of its sensor, and on no others."""

import numpy as np
import pytest

from executive.clock import SimulatedClock
from executive.events.event import plain
from executive.faults.description import SensorFault
from executive.faults.injector import Injector
from executive.machine.machine import load_machine
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan

MACHINE = load_machine("m545")
TICK_S = 0.05


class Robot:
    """Sends noisy samples of some sensors at their rates."""

    def __init__(self) -> None:
        self.rng, self.steps = np.random.default_rng(1), 0

    def read(self, until_s):
        found = []
        while (self.steps + 1) * 0.01 <= until_s + 1e-9:
            self.steps += 1
            found += self.step(self.steps * 0.01)
        return found

    def command(self, command):
        """Take a command and do nothing."""

    def step(self, now_s):
        noise = self.rng.normal
        n = len(MACHINE.joint_names)
        found = [
            ImuSample(now_s, "imu_cabin", noise(0, 1e-3, 3), noise(0, 1e-2, 3) + [0, 0, 9.8]),
            ImuSample(now_s, "imu_base", noise(0, 1e-3, 3), noise(0, 1e-2, 3) + [0, 0, 9.8]),
            JointSample(now_s, MACHINE.joint_names, *(noise(0, 1e-3, (3, n)))),
        ]
        if self.steps % 5 == 0:
            place = np.array([47.4, 8.5, 440.0]) + noise(0, 1e-8, 3)
            found.append(GnssFix(now_s, "gnss_left", place, 1e-4 * np.eye(3), True))
        if self.steps % 10 == 0:
            points = noise(0, 0.01, (4, 3)) + [5.0, 0.0, 0.0]
            found.append(
                LidarScan(now_s, "lidar_vertical", points, now_s - np.arange(4)[::-1] / 50)
            )
        return found


def run(until_s=1.0, seed=1, **fault):
    """Return what arrives of a robot with one fault, and the events that it leaves."""
    clock, robot, events = SimulatedClock(), Robot(), []
    injector = Injector([SensorFault(**fault)], MACHINE, seed, clock)
    injector.install({"robot": robot}, events.append)
    arrived = []
    while clock.now_s() <= until_s + 1e-9:
        injector.step()
        arrived.append((clock.now_s(), robot.read(clock.now_s())))
        clock.advance(TICK_S)
    return arrived, events, injector


def samples(arrived, sensor, from_s=-1.0, to_s=99.0):
    """Return what has arrived of a sensor in the ticks of a span."""

    def name(one):
        return getattr(one, "frame", None) or getattr(one, "antenna", None) or "encoders"

    return [
        one
        for at_s, all_ in arrived
        if from_s < at_s <= to_s
        for one in all_
        if name(one) == sensor
    ]


SENSORS = ["imu_cabin", "encoders", "gnss_left", "lidar_vertical"]


def values(one):
    for name in ("specific_force_m_s2", "geodetic", "position", "points_lidar"):
        if hasattr(one, name):
            return getattr(one, name)
    raise AssertionError(one)


@pytest.mark.parametrize("sensor", SENSORS)
def test_a_silent_sensor_sends_nothing_for_its_span_and_again_after_it(sensor):
    arrived, events, _ = run(sensor=sensor, how="silent", at=0.3, lasts=0.4)
    assert not samples(arrived, sensor, 0.28, 0.68)
    assert samples(arrived, sensor, 0, 0.28)
    assert samples(arrived, sensor, 0.68)
    assert len(samples(arrived, "imu_base")) == 100
    assert [e.kind for e in events] == ["fault_injected", "fault_removed"]
    assert events[1].acted > 0


@pytest.mark.parametrize("sensor", SENSORS)
def test_a_stuck_sensor_repeats_its_values_under_new_stamps(sensor):
    arrived, _, _ = run(sensor=sensor, how="stuck", at=0.3)
    stuck = samples(arrived, sensor, 0.28)
    assert len({one.stamp_s for one in stuck}) == len(stuck) > 3
    assert all(np.array_equal(values(one), values(stuck[0])) for one in stuck)


@pytest.mark.parametrize("sensor", SENSORS)
def test_garbage_is_of_any_size(sensor):
    arrived, _, _ = run(sensor=sensor, how="garbage", at=0.3)
    assert max(np.abs(values(one)).max() for one in samples(arrived, sensor, 0.28)) > 1e6
    assert max(np.abs(values(one)).max() for one in samples(arrived, sensor, 0, 0.28)) < 1e3


@pytest.mark.parametrize("sensor", SENSORS)
def test_a_wrong_sensor_is_off_by_a_constant(sensor):
    good = [
        values(one) for one in samples(run(sensor="lidar", how="silent", at=99)[0], sensor, 0.28)
    ]
    bad = [values(one) for one in samples(run(sensor=sensor, how="wrong", at=0.3)[0], sensor, 0.28)]
    apart = [np.abs(b - g) for g, b in zip(good, bad, strict=True)]
    assert all(one.max() > 1e-7 for one in apart)
    assert np.allclose(apart[0], apart[-1], rtol=0.2, atol=1e-3)


@pytest.mark.parametrize("sensor", SENSORS)
def test_a_slow_sensor_sends_at_a_tenth_of_its_rate(sensor):
    rate_hz = MACHINE.sensors[sensor].rate_hz
    slow = samples(run(3.0, sensor=sensor, how="slow", at=1.0)[0], sensor, 0.98)
    assert len(slow) == pytest.approx(2.0 * rate_hz / 10, abs=3)
    slow = samples(run(3.0, sensor=sensor, how="slow", at=1.0, rate=rate_hz / 2)[0], sensor, 0.98)
    assert len(slow) == pytest.approx(2.0 * rate_hz / 2, abs=3)


@pytest.mark.parametrize("sensor", SENSORS)
def test_delayed_samples_arrive_later_with_their_stamps_and_none_is_lost(sensor):
    fault = {"sensor": sensor, "how": "delayed", "at": 0.3, "lasts": 0.3, "delay": 0.2}
    arrived, _, _ = run(2.0, **fault)
    late = [
        at_s - one.stamp_s
        for at_s, all_ in arrived
        for one in all_
        if one in samples([(at_s, all_)], sensor, 0.28, 0.68)
    ]
    assert max(late) >= 0.2 - 1e-9
    usual = samples(run(2.0, sensor="lidar", how="silent", at=99)[0], sensor)
    assert len(samples(arrived, sensor)) == len(usual)


@pytest.mark.parametrize("sensor", SENSORS)
def test_an_intermittent_sensor_loses_the_same_samples_for_the_same_seed(sensor):
    def stamps(seed):
        arrived, _, _ = run(6.0, seed=seed, sensor=sensor, how="intermittent", at=0.0, share=0.5)
        return [one.stamp_s for one in samples(arrived, sensor)]

    assert 0.2 * 6.0 < len(stamps(1)) / MACHINE.sensors[sensor].rate_hz < 0.8 * 6.0
    assert stamps(1) == stamps(1) != stamps(2)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("sensor", SENSORS)
def test_an_intermittent_sensor_loses_its_first_sample(sensor, seed):
    fault = {"sensor": sensor, "how": "intermittent", "at": 0.3, "share": 0.01}
    usual = samples(run(sensor="lidar", how="silent", at=99)[0], sensor, 0.28)
    arrived = samples(run(seed=seed, **fault)[0], sensor, 0.28)
    assert len(usual) - 1 >= len(arrived) > 0.5 * len(usual) - 1
    assert arrived[0].stamp_s > usual[0].stamp_s


@pytest.mark.parametrize("sensor", SENSORS)
def test_nan_duplicates_and_jumps_of_the_clock(sensor):
    bad = samples(run(sensor=sensor, how="nan", at=0.3)[0], sensor, 0.28)
    assert all(np.isnan(values(one)).all() for one in bad)
    twice = samples(run(sensor=sensor, how="duplicate", at=0.3)[0], sensor, 0.28)
    assert all(a is b for a, b in zip(twice[::2], twice[1::2], strict=True))
    jumped = samples(run(sensor=sensor, how="clock_jump", at=0.3, jump=5.0)[0], sensor, 0.28)
    assert min(one.stamp_s for one in jumped) > 5.0


def test_a_float_fix_says_so_and_a_multipath_does_not():
    floating = samples(run(sensor="gnss", how="float", at=0.3)[0], "gnss_left", 0.28)
    assert not any(one.is_rtk_fixed for one in floating)
    assert min(np.diag(one.covariance_enu_m2).min() for one in floating) > 0.1
    good = samples(run(sensor="lidar", how="silent", at=99)[0], "gnss_left", 0.28)
    for how in ("multipath", "wrong_fix"):
        bad = samples(run(sensor="gnss", how=how, at=0.3)[0], "gnss_left", 0.28)
        assert all(one.is_rtk_fixed for one in bad)
        metres = [
            1.1e5 * np.abs(b.geodetic - g.geodetic)[:2].max()
            for g, b in zip(good, bad, strict=True)
        ]
        assert min(metres) > 0.1


@pytest.mark.parametrize("how", ["silent", "stuck", "garbage", "wrong", "nan"])
def test_a_fault_of_efforts_leaves_positions_alone(how):
    good = samples(run(sensor="lidar", how="silent", at=99)[0], "encoders", 0.28)
    bad = samples(run(sensor="efforts", how=how, at=0.3)[0], "encoders", 0.28)
    assert all(np.array_equal(g.position, b.position) for g, b in zip(good, bad, strict=True))
    assert any(not np.array_equal(g.effort, b.effort) for g, b in zip(good, bad, strict=True))


def test_a_fault_of_a_node_begins_so_long_after_its_second_start():
    from executive.events.node import NodeStarted

    clock, robot, events = SimulatedClock(), Robot(), []
    fault = SensorFault(sensor="imu", how="silent", node="Swing", nth=2, after=0.1, lasts=0.2)
    injector = Injector([fault], MACHINE, 1, clock)
    injector.install({"robot": robot}, lambda event: events.append((clock.now_s(), event.kind)))
    for tick in range(20):
        injector.step()
        if tick in (3, 8):
            injector.heed("main/0:sequence/1:Swing", NodeStarted())
        clock.advance(TICK_S)
    assert [kind for _, kind in events] == ["fault_injected", "fault_removed"]
    assert [at_s for at_s, _ in events] == pytest.approx([0.5, 0.7])


def test_chance_is_drawn_from_the_seed():
    def spans(seed):
        _, _, injector = run(60.0, seed=seed, sensor="imu", how="silent", chance=0.1, lasts=1.0)
        return plain(injector.report()[0])["spans"]

    assert 2 <= len(spans(1)) <= 12  # 6 expected
    assert spans(1) == spans(1) != spans(2)
