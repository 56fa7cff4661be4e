"""Defaults and bounds of the settings of steps that leaves share."""


def test_settings(recorded, settings_in) -> None:
    recorded(settings_in("executive.leaf"))
