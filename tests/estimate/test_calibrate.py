"""What a calibrator found is told with its certainty, and written to a file that is read back."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from executive.errors import ConfigError
from executive.estimate.calibrate import is_any_found, lines, report, write_calibration
from executive.estimate.calibration import Calibration, SensorCalibration, read_calibration
from executive.interfaces.calibration import Quantity
from executive.machine.machine import load_machine
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample


def quantity(sensor, name, value, is_found, std=0.001, declared=0.0, advice=""):
    value = np.atleast_1d(np.array(value, dtype=float))
    is_found = np.broadcast_to(np.array(is_found), value.shape)
    filled = [np.broadcast_to(np.array(one, dtype=float), value.shape) for one in (std, declared)]
    return Quantity(sensor, name, value, *filled, is_found, advice)


LATE = quantity("top", "stamp_late_s", 0.0312344, True, std=0.002)
PLACE = quantity(
    "top", "xyz_m", [1.0, 2.0, 3.0], [True, False, True], declared=[0.5, 2.5, 3.5], advice="a turn"
)
NOISE = quantity("imu", "gyro_noise_rad_s", 0.003, True)
NOTHING = quantity("bottom", "xyz_m", [1.0, 2.0, 3.0], False, advice="a drive")


def test_noise_alone_is_no_calibration():
    assert is_any_found([NOISE, PLACE])
    assert is_any_found([LATE])
    assert not is_any_found([NOISE, NOTHING])
    assert not is_any_found([quantity("top", "covariance_scale", 2.0, True)])
    assert not is_any_found([quantity("imu", "rate_hz", 100.0, True)])
    assert not is_any_found([quantity("imu", "accel_noise_m_s2", 0.1, True)])
    assert not is_any_found([])


def test_each_quantity_is_told_on_a_line_with_what_is_missing():
    late, place = lines([LATE, PLACE])
    assert late == "top stamp_late_s: 0.031234 ± 0.002"
    assert place == (
        "top xyz_m: 1.0 ± 0.001, 2.0 ± 0.001 (not found), 3.0 ± 0.001; "
        "not certain enough: needs a turn"
    )


def test_the_report_holds_value_declaration_and_advice():
    material = SimpleNamespace(
        log=SimpleNamespace(path=Path("drive.mcap")), rig=SimpleNamespace(name="m545")
    )
    told = report(material, "batch", [PLACE])
    assert (told["log"], told["body"], told["calibrator"]) == ("drive.mcap", "m545", "batch")
    assert told["quantities"] == [
        {
            "sensor": "top",
            "name": "xyz_m",
            "value": [1.0, 2.0, 3.0],
            "std": [0.001] * 3,
            "declared": [0.5, 2.5, 3.5],
            "found": [True, False, True],
            "advice": "a turn",
        }
    ]


def test_a_file_holds_what_was_found_and_elsewhere_what_was_declared(tmp_path):
    path = tmp_path / "found.yaml"
    write_calibration(path, Path("logs/drive.mcap"), [LATE, NOISE, PLACE, NOTHING])
    read = read_calibration(path)
    assert read.log == "drive.mcap"
    assert set(read.sensors) == {"top", "imu"}  # nothing was found of the others
    top = read.sensors["top"]
    assert (top.stamp_late_s, top.stamp_std_s, top.xyz_m) == (0.031234, 0.002, (1.0, 2.5, 3.0))
    assert read.sensors["imu"].gyro_noise_rad_s == 0.003


def test_a_file_that_cannot_be_written_is_told(tmp_path):
    with pytest.raises(ConfigError, match="cannot be written: "):
        write_calibration(tmp_path / "none" / "found.yaml", Path("drive.mcap"), [LATE])


def calibration(**sensors):
    return Calibration(sensors={name: SensorCalibration(**one) for name, one in sensors.items()})


def test_what_was_found_is_put_in_the_place_of_what_was_declared():
    rig = load_machine("m545")
    name, before = next((n, s) for n, s in rig.sensors.items() if s.kind == "gnss")
    applied = calibration(**{name: {"xyz_m": (1.0, 2.0, 3.0), "stamp_late_s": 0.1}}).applied(rig)
    assert tuple(applied.sensors[name].xyz_m) == (1.0, 2.0, 3.0)
    assert applied.sensors[name].rpy_rad == before.rpy_rad
    assert rig.sensors[name] is before
    assert Calibration().applied(rig) is rig
    with pytest.raises(ConfigError, match=f"has no sensor '{name}x'. Did you mean"):
        calibration(**{f"{name}x": {"rate_hz": 5.0}}).applied(rig)
    with pytest.raises(ConfigError, match=f"'{name}' is of the kind gnss"):
        calibration(**{name: {"gyro_noise_rad_s": 0.1}}).applied(rig)


def test_stamps_that_are_late_are_put_earlier():
    found = calibration(top={"stamp_late_s": 0.1}, imu={"rate_hz": 5.0}, low={"stamp_late_s": -0.2})
    assert [(one.sensor, one.seconds) for one in found.offsets] == [("top", -0.1), ("low", 0.2)]


def test_a_covariance_is_scaled_by_what_was_found_of_its_sensor():
    fix = GnssFix(1.0, "top", np.zeros(3), np.diag([1.0, 2.0, 3.0]), True)
    scaled = calibration(top={"covariance_scale": 4.0}).scaled(fix)
    assert scaled.covariance_enu_m2 == pytest.approx(np.diag([4.0, 8.0, 12.0]))
    assert calibration(top={"rate_hz": 5.0}).scaled(fix) is fix
    assert calibration(low={"covariance_scale": 4.0}).scaled(fix) is fix
    sample = ImuSample(1.0, "top", np.zeros(3), np.zeros(3))
    assert calibration(top={"covariance_scale": 4.0}).scaled(sample) is sample


def test_the_clock_is_as_certain_as_its_least_certain_antenna():
    found = calibration(top={"stamp_std_s": 0.01}, low={"stamp_std_s": 0.03}, far={"rate_hz": 5.0})
    assert found.clock_std_s(["top", "low"]) == 0.03
    assert found.clock_std_s(["top"]) == 0.01
    assert found.clock_std_s(["top", "far"]) is None
    assert found.clock_std_s(["top", "unknown"]) is None
    assert found.clock_std_s([]) is None


@pytest.mark.parametrize(
    ("field", "value"),
    [("stamp_late_s", 2.1), ("stamp_late_s", -2.1), ("stamp_std_s", -0.1), ("stamp_std_s", 2.1),
     ("covariance_scale", 0.0), ("covariance_scale", 1.1e4), ("rate_hz", 0.0),
     ("gyro_noise_rad_s", -0.1), ("accel_noise_m_s2", -0.1), ("gyro_walk_rad_s", -0.1),
     ("accel_walk_m_s2", -0.1)],
)  # fmt: skip
def test_a_value_that_no_sensor_has_is_refused_with_its_field(tmp_path, field, value):
    path = tmp_path / "found.yaml"
    path.write_text(f"api: 1\nsensors: {{top: {{{field}: {value}}}}}\n")
    with pytest.raises(ConfigError, match=f"sensors.top.{field}: "):
        read_calibration(path)


@pytest.mark.parametrize(
    ("field", "value"),
    [("stamp_late_s", 2.0), ("stamp_late_s", -2.0), ("stamp_std_s", 0.0), ("stamp_std_s", 2.0),
     ("covariance_scale", 1e4), ("gyro_noise_rad_s", 0.0), ("accel_noise_m_s2", 0.0),
     ("gyro_walk_rad_s", 0.0), ("accel_walk_m_s2", 0.0)],
)  # fmt: skip
def test_a_value_at_its_bound_is_taken(field, value):
    assert getattr(SensorCalibration(**{field: value}), field) == value
