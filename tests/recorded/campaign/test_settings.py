"""Defaults and bounds of the settings of campaigns."""


def test_settings(recorded, settings_in) -> None:
    recorded(settings_in("executive.campaign"))
