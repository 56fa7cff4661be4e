"""Defaults and bounds of the settings of calibration files."""


def test_settings(recorded, settings_in) -> None:
    recorded(settings_in("executive.estimate"))
