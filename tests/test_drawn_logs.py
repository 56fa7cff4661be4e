"""The drawn logs are consistent with their truth; without errors, the samples give the motion."""

import importlib
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from executive.geometry.geodesy import enu_from_geodetic
from executive.geometry.rotation import exp_so3
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.odometry import LidarIncrement

BENCHMARKS = Path(__file__).parent / "benchmarks"


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    return importlib.import_module("drawn_logs.drawn_log")


@pytest.mark.parametrize("kind", ["foot", "car", "flyer", "excavator"])
def test_samples_without_errors_reproduce_the_motion(drawn, kind: str) -> None:
    measuring = importlib.import_module("drawn_logs.measuring")
    motions = importlib.import_module("drawn_logs.motion")
    rng = np.random.default_rng(7)
    sheet = importlib.import_module("drawn_logs.sheets").ImuSheet.draw(rng)
    perfect = replace(
        sheet,
        rate_hz=100.0,
        gyro_std=0.0,
        accel_std=0.0,
        gyro_bias=np.zeros(3),
        accel_bias=np.zeros(3),
        gyro_walk=0.0,
        accel_walk=0.0,
    )
    motion = motions.draw_motion(kind, rng, 20.0, 100.0, 0.0)
    R, v, p = motion.R_map_body[0], motion.v_map[0], motion.p_map[0]
    gravity = np.array([0.0, 0.0, -motions.GRAVITY_M_S2])
    for arrival in measuring.inertial(motion, perfect, rng):
        turn = arrival.observation.angular_velocity_rad_s * 0.01
        pull = R @ exp_so3(turn / 2) @ arrival.observation.specific_force_m_s2 + gravity
        R, v, p = R @ exp_so3(turn), v + 0.01 * pull, p + 0.01 * v + 0.5 * 0.01**2 * pull
    assert np.linalg.norm(motion.v_map, axis=1).max() > 0.1
    assert np.abs(R - motion.R_map_body[-1]).max() < 1e-6
    assert np.abs(v - motion.v_map[-1]).max() < 1e-6
    assert np.abs(p - motion.p_map[-1]).max() < 1e-3


def test_fixes_are_those_of_the_antennas_with_the_declared_noise(drawn) -> None:
    measuring = importlib.import_module("drawn_logs.measuring")
    log = next(
        log
        for log in (drawn.draw_log(seed, 20.0) for seed in range(40))
        if len(log.gnss.antennas) == 2 and log.gnss.offset_s == 0 and log.gnss.truth == 1
    )
    errors = []
    for fix in (a.observation for a in log.arrivals if isinstance(a.observation, GnssFix)):
        T = measuring.true_pose(log.motion, fix.stamp_s)
        arm = log.rig.sensors[fix.antenna].T_link_sensor[:3, 3]
        away = enu_from_geodetic(fix.geodetic, log.datum) - (T[:3, :3] @ arm + T[:3, 3])
        errors.append(away / np.sqrt(np.diag(fix.covariance_enu_m2)))
    assert 0.7 < np.std(errors) < 1.3


def test_a_seed_gives_the_same_log_and_half_of_the_logs_move_from_the_start(drawn) -> None:
    def bytes_of(log) -> bytes:
        samples = [a.observation for a in log.arrivals if isinstance(a.observation, ImuSample)]
        return np.array([sample.specific_force_m_s2 for sample in samples]).tobytes()

    assert bytes_of(drawn.draw_log(3, 5.0)) == bytes_of(drawn.draw_log(3, 5.0))
    logs = [drawn.draw_log(seed, 1.0) for seed in range(100)]
    assert 35 < sum(log.motion.moves_from_s == 0 for log in logs) < 65
    assert {log.motion.kind for log in logs} == {"foot", "car", "flyer", "excavator"}
    kinds = {type(a.observation) for log in logs for a in log.arrivals}
    assert kinds == {ImuSample, GnssFix, LidarIncrement}


def test_the_peer_finds_the_heading_of_a_body_that_moves_from_the_start(drawn) -> None:
    estimators = importlib.import_module("drawn_logs.estimators")
    judge = importlib.import_module("drawn_logs.judge").judge
    log = next(
        log
        for log in (drawn.draw_log(seed, 15.0) for seed in range(1, 80, 4))
        if log.gnss.is_rtk_fixed
        and log.gnss.truth == 1
        and log.gnss.offset_s == 0
        and log.motion.moves_from_s == 0
        and log.gnss.rate_hz <= 5
    )
    replay, _ = estimators.replayed(estimators.PEER, log)
    verdict = judge(replay.states, log.motion)
    late = verdict.stamps_s > 10
    assert np.median(verdict.error_rad[late]) < 0.2
    assert np.median(verdict.error_m[late]) < 0.3


def test_a_sick_sensor_is_sick_for_its_time_and_the_others_are_sound(drawn) -> None:
    sicknesses = importlib.import_module("drawn_logs.sickness").SICKNESSES
    log, rng = drawn.draw_log(1, 8.0, is_sound=True), np.random.default_rng(1)
    sick = sicknesses["fixes: silent 3 s"].of(log.arrivals, log.datum, 2.0, rng)
    gone = [a for a in log.arrivals if not any(a is b for b in sick)]
    assert gone
    assert all(isinstance(a.observation, GnssFix) and 2.0 <= a.arrival_s < 5.0 for a in gone)
    assert len(sicknesses) >= 60
    for sickness in sicknesses.values():
        changed = sickness.of(log.arrivals, log.datum, 2.0, rng)
        before = [a for a in log.arrivals if a.arrival_s < 2.0]
        assert all(a is b for a, b in zip(before, changed, strict=False))


def test_a_wrong_claim_misses_its_bound_and_an_unknown_kind_ends_with_2(drawn, capsys) -> None:
    trials = importlib.import_module("trials.sick_sensors")
    bounds = importlib.import_module("bounds")
    sound = trials.Trial("fixes: jump 1.0 m", "log", 0.2, 0.5, 0.1, float("inf"))
    assert bounds.verdict(trials.figures([sound])) == 0
    assert bounds.verdict(trials.figures([sound, replace(sound, wrong_s=3.4)])) == 1
    assert "missed at: fixes: jump 1.0 m" in capsys.readouterr().out
    with pytest.raises(SystemExit) as ended:
        importlib.import_module("sick_sensors").main(["1", "--kinds", "sonar"])
    assert ended.value.code == 2
