"""Defaults and bounds of the settings of leaves."""


def test_settings(recorded, settings_in) -> None:
    recorded(settings_in("executive.behaviours"))
