"""Which settings the estimators ask for on a recorded log."""

import pytest

from executive import registry
from executive.interfaces.recorded_log import RecordedBody

DATUM = (48.1, 11.5, 520.0)
PLUGINS = (
    ("estimation", "dual_graph"),
    ("estimation", "error_state_ekf"),
    ("estimation", "gnss_imu_filter"),
    ("smoothing", "batch_graph"),
)


@pytest.mark.parametrize(("capability", "name"), PLUGINS)
def test_the_settings_are_valid_and_place_the_map_at_the_first_fix(
    capability: str, name: str
) -> None:
    plugin = registry.load(capability, name)
    for is_described in (True, False):
        body = RecordedBody(("imu_link",), DATUM, is_described)
        settings = plugin.Settings.model_validate(plugin.settings_for(body))
        assert settings.datum == DATUM
        assert settings.imu == "imu_link"


@pytest.mark.parametrize(("capability", "name"), PLUGINS)
def test_a_described_machine_keeps_its_thresholds_and_an_unknown_body_gets_wider_ones(
    capability: str, name: str
) -> None:
    plugin = registry.load(capability, name)
    default = plugin.Settings()
    bodies = [RecordedBody(("imu_cabin",), DATUM, is_described) for is_described in (True, False)]
    described, unknown = (
        plugin.Settings.model_validate(plugin.settings_for(body)) for body in bodies
    )
    assert described == default.model_copy(update={"datum": DATUM})
    assert unknown.rest.max_rate_std_rad_s > default.rest.max_rate_std_rad_s
    assert _gate(unknown) > _gate(default)


@pytest.mark.parametrize("name", ["dual_graph", "error_state_ekf", "gnss_imu_filter"])
def test_a_clock_may_agree_unless_it_was_calibrated_or_is_described(name: str) -> None:
    plugin = registry.load("estimation", name)
    unknown = RecordedBody(("imu",), DATUM, is_described=False)
    calibrated = RecordedBody(("imu",), DATUM, is_described=False, clock_std_s=0.002)
    described = RecordedBody(("imu",), DATUM, is_described=True)
    shares = [
        plugin.Settings.model_validate(plugin.settings_for(body)).clock_agrees
        for body in (unknown, calibrated, described)
    ]
    assert shares == [0.5, 0.0, 0.0]


def test_the_default_sensor_is_followed_wherever_it_appears_in_the_log() -> None:
    plugin = registry.load("estimation", "gnss_imu_filter")
    body = RecordedBody(("imu_base", "imu_cabin"), DATUM, is_described=True)
    assert plugin.settings_for(body)["imu"] == "imu_cabin"


@pytest.mark.parametrize("name", ["scan_to_submap", "kiss_icp"])
def test_an_odometry_follows_its_default_lidar_or_else_the_first(name: str) -> None:
    plugin = registry.load("odometry", name)
    assert plugin.settings_for(["front", "lidar_horizontal"]) == {}
    assert plugin.settings_for(["front", "rear"]) == {"frame": "front"}


def _gate(settings) -> float:
    return settings.smoother.gate.innovation if hasattr(settings, "smoother") else settings.gate
