"""Bounds that several values of a setting have together: the bounds belong to the range."""

from typing import Any

import pytest
from executive_plugins.grasping.settings import SampledPlannerSettings
from executive_plugins.registration.settings import SegmentShotSettings
from executive_plugins.robot.mujoco.sensors.dropout import Dropout, check_dropouts, is_silent
from executive_plugins.robot.mujoco.site.settings import (
    ObstacleSettings,
    PersonSettings,
    StoneSettings,
)
from pydantic import ValidationError

from executive.config import Settings
from executive.errors import ConfigError

AT = {"at_m": (1.0, 2.0)}
SENSOR = {"sensor": "imu_cabin"}

GOOD: list[tuple[type[Settings], dict[str, Any]]] = [
    (ObstacleSettings, {**AT, "size_m": (0.05, 100, 1.0)}),
    (ObstacleSettings, {**AT, "size_m": (100, 0.05, 0.05)}),
    (PersonSettings, {"path_m": ((0.0, 0.0), (1.0, 0.0), (0.0, 0.0))}),
    (StoneSettings, {"volume_m3": (0.001, 20)}),
    (StoneSettings, {"volume_m3": (0.7, 0.7)}),
    (StoneSettings, {}),
    (Dropout, {**SENSOR, "from_s": 0, "to_s": 0.001}),
    (SampledPlannerSettings, {"steel_friction": (0.05, 2)}),
    (SampledPlannerSettings, {"steel_friction": (0.3, 0.3)}),
    (SampledPlannerSettings, {"steel_friction": None}),
    (SampledPlannerSettings, {"scale": 0.5, "rehearsed": 0}),
    (SampledPlannerSettings, {"scale": 1, "rehearsed": 3}),
]
BAD: list[tuple[type[Settings], dict[str, Any], str]] = [
    (ObstacleSettings, {**AT, "size_m": (0.049, 1.0, 1.0)}, "within 0.05 to 100 m"),
    (ObstacleSettings, {**AT, "size_m": (1.0, 1.0, 100.1)}, "within 0.05 to 100 m"),
    (PersonSettings, {"path_m": ((0.0, 0.0), (0.0, 0.0))}, "the same corner twice"),
    (PersonSettings, {"path_m": ((0.0, 0.0), (1.0, 0.0), (1.0, 0.0))}, "the same corner twice"),
    (StoneSettings, {"volume_m3": (0.0009, 1.0)}, "within 0.001 to 20"),
    (StoneSettings, {"volume_m3": (0.5, 20.1)}, "within 0.001 to 20"),
    (StoneSettings, {"volume_m3": (0.7, 0.6)}, "within 0.001 to 20"),
    (Dropout, {**SENSOR, "from_s": 1.0, "to_s": 1.0}, "must be later than"),
    (SampledPlannerSettings, {"steel_friction": (0.04, 1.0)}, "within 0.05 to 2"),
    (SampledPlannerSettings, {"steel_friction": (0.3, 2.1)}, "within 0.05 to 2"),
    (SampledPlannerSettings, {"steel_friction": (0.3, 0.2)}, "within 0.05 to 2"),
    (SampledPlannerSettings, {"scale": 0.5, "rehearsed": 1}, "full size only"),
]


@pytest.mark.parametrize(("kind", "values"), GOOD)
def test_what_is_within_the_range_is_taken_as_it_is(
    kind: type[Settings], values: dict[str, Any]
) -> None:
    settings = kind.model_validate(values)
    assert {name: getattr(settings, name) for name in values} == values


@pytest.mark.parametrize(("kind", "values", "words"), BAD)
def test_what_is_beyond_is_refused_with_the_range(
    kind: type[Settings], values: dict[str, Any], words: str
) -> None:
    with pytest.raises(ValidationError, match=words):
        kind.model_validate(values)


@pytest.mark.parametrize(
    ("payload_kg", "expected"),
    [(9000.0, (0.5, 1.0)), (2700.0, (0.5, 1.0)), (1350.0, (0.25, 0.5)), (270.0, (0.05, 0.1))],
)
def test_stones_fit_a_machine_that_lifts_less(
    payload_kg: float, expected: tuple[float, float]
) -> None:
    """Of 2,700 kg/m³, a cubic metre weighs 2.7 t."""
    assert StoneSettings().volumes_m3(payload_kg) == pytest.approx(expected)
    assert StoneSettings(volume_m3=(0.2, 0.3)).volumes_m3(payload_kg) == (0.2, 0.3)


def test_a_sensor_is_silent_from_the_first_time_without_samples_to_the_first_with_some() -> None:
    dropouts = [Dropout(sensor="imu_cabin", from_s=1.0, to_s=2.0)]
    times_s = (0.99, 1.0, 1.5, 1.99, 2.0)
    silent = [is_silent(dropouts, "imu_cabin", time_s) for time_s in times_s]
    assert silent == [False, True, True, True, False]
    assert not is_silent(dropouts, "imu_base", 1.5)
    check_dropouts(dropouts, ["imu_cabin"])
    with pytest.raises(ConfigError, match=r"no sensor 'imu_cabin'.*'imu_cabinet'"):
        check_dropouts(dropouts, ["imu_cabinet", "other"])


@pytest.mark.parametrize(("preset", "radius_m"), [("sure", 0.40), ("paper", 0.10)])
def test_a_radius_of_ones_own_goes_before_that_of_a_preset(preset: str, radius_m: float) -> None:
    """The paper's is that of Table 3."""
    assert SegmentShotSettings.model_validate({"preset": preset}).shot_radius_m == radius_m
    own = SegmentShotSettings.model_validate({"preset": preset, "shot_radius_m": 0.77})
    assert own.shot_radius_m == 0.77
    with pytest.raises(ValidationError, match="'sure' or 'paper'"):
        SegmentShotSettings.model_validate({"preset": "rough"})
