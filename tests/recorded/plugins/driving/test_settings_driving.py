"""Defaults and bounds of the settings of driving."""


def test_settings(recorded, settings_in) -> None:
    recorded(settings_in("executive_plugins.driving"))
