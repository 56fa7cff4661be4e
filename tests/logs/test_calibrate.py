"""A body that swings, halts and nods, with a late receiver and an antenna declared elsewhere."""

import json

import numpy as np
import pytest
import typer
from scipy.spatial.transform import Rotation

from executive.commands.logs.calibrate import calibrate
from executive.errors import ConfigError, DataError
from executive.estimate.calibration import Calibration, read_calibration
from executive.estimate.material import Material
from executive.estimate.options import EstimateOptions
from executive.messages.gnss import GnssFix

ARM, DECLARED, LATE_S = np.array([0.6, -0.3, 0.8]), (0.5, -0.2, 0.8), 0.12
SECONDS = 30.0


def _turned(t, turns=1.0):
    angles = [1.2 * np.sin(0.5 * t), 0.2 * np.sin(0.9 * t), 0.2 * np.cos(1.3 * t)]
    return Rotation.from_euler("ZYX", turns * np.array(angles))


def _place(t):
    return np.array([3 * np.sin(0.7 * t), 2 * np.cos(0.5 * t), 0.3 * np.sin(0.4 * t)])


def _swinging(ros, turns=1.0, fix_m=0.01):
    """Each sample is the mean since the one before; the receiver's stamps are late."""
    rng, dt, h = np.random.default_rng(3), 0.02, 1e-3
    frames = [("base", "imu", (0, 0, 0), (1, 0, 0, 0)), ("base", "gnss", DECLARED, (1, 0, 0, 0))]
    yield 0.0, "/tf_static", ros.tf(frames)
    for k in range(1, round(SECONDS / dt)):
        middle, t = (k - 0.5) * dt, k * dt
        turn = _turned((k - 1) * dt, turns).inv() * _turned(t, turns)
        pull = (_place(middle + h) - 2 * _place(middle) + _place(middle - h)) / h**2
        force = _turned(middle, turns).inv().apply(pull + [0, 0, 9.81])
        rate = turn.as_rotvec() / dt
        yield (
            t,
            "/imu/data",
            ros.imu(t, "imu", rate + rng.normal(0, 2e-3, 3), force + rng.normal(0, 0.02, 3)),
        )
        if k % 10 == 0:
            at = _place(t) + _turned(t, turns).apply(ARM) + rng.normal(0, fix_m, 3)
            yield t, "/gnss/fix", ros.fix(t + LATE_S, "gnss", at)


@pytest.fixture(scope="module")
def calibrated(ros2, tmp_path_factory, write_mcap):
    folder = tmp_path_factory.mktemp("calibrate")
    log = write_mcap(folder / "swinging.mcap", ros2, _swinging(ros2))
    calibrate(log, folder / "found.yaml")
    return log, folder / "found.yaml"


def test_it_finds_the_clock_and_the_arm_and_writes_them(calibrated) -> None:
    _, path = calibrated
    gnss = read_calibration(path).sensors["gnss"]
    assert gnss.stamp_late_s == pytest.approx(LATE_S, abs=0.005)
    assert gnss.stamp_std_s < 0.005
    np.testing.assert_allclose(gnss.xyz_m, ARM, atol=0.03)
    assert read_calibration(path).sensors["imu"].accel_noise_m_s2 == pytest.approx(0.02, rel=0.2)


def test_estimate_takes_what_was_found(calibrated) -> None:
    log, path = calibrated
    plain = Material.read(log, EstimateOptions())
    told = Material.read(log, EstimateOptions(calibration=read_calibration(path)))
    stamps = [
        next(a.observation.stamp_s for a in one.arrivals if isinstance(a.observation, GnssFix))
        for one in (plain, told)
    ]
    assert stamps[0] - stamps[1] == pytest.approx(LATE_S, abs=0.005)
    np.testing.assert_allclose(told.rig.sensors["gnss"].T_link_sensor[:3, 3], ARM, atol=0.03)
    assert plain.body().clock_std_s is None
    assert 0 < told.body().clock_std_s < 0.005


def test_without_turns_and_with_bad_fixes_nothing_is_found_and_status_1_says_so(
    ros2, write_mcap, tmp_path, capsys: pytest.CaptureFixture
) -> None:
    log = write_mcap(tmp_path / "straight.mcap", ros2, _swinging(ros2, turns=0.0, fix_m=0.3))
    with pytest.raises(typer.Exit) as ended:
        calibrate(log, tmp_path / "found.yaml", as_json=True)
    assert ended.value.exit_code == 1
    said = capsys.readouterr()
    assert "turns about the two axes" in said.err
    found = {one["name"]: one for one in json.loads(said.out)["quantities"]}
    assert found["xyz_m"]["found"] == [False, False, False]
    assert found["stamp_late_s"]["found"] == [False]
    assert read_calibration(tmp_path / "found.yaml").sensors["gnss"].xyz_m is None


def test_a_log_without_motion_is_refused(ros2, write_mcap, tmp_path) -> None:
    still = (row for row in _swinging(ros2) if row[0] < 1.0)
    log = write_mcap(tmp_path / "still.mcap", ros2, still)
    with pytest.raises(DataError, match="no motion to begin with"):
        calibrate(log, tmp_path / "found.yaml")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("api: 1\nsensors: {gnss: {xyzm: [0, 0, 0]}}", "sensors.gnss.xyzm"),
        ("api: 1\nsensors: {gnss: {xyz_m: [0, 0]}}", "sensors.gnss.xyz_m"),
        ("api: 2", "api"),
        ("7", "Calibration"),
    ],
)
def test_a_wrong_file_is_refused_with_the_field(text, says, tmp_path) -> None:
    path = tmp_path / "wrong.yaml"
    path.write_text(text)
    with pytest.raises(ConfigError, match=says):
        read_calibration(path)


def test_a_calibration_of_another_rig_is_refused(car_log) -> None:
    for sensors, says in (
        ({"gns": {"rate_hz": 5.0}}, "no sensor 'gns'"),
        ({"gnss": {"gyro_noise_rad_s": 0.1}}, "sensors.gnss.gyro_noise_rad_s"),
    ):
        known = Calibration.model_validate({"sensors": sensors})
        with pytest.raises(ConfigError, match=says):
            Material.read(car_log, EstimateOptions(calibration=known))
