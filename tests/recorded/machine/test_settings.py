"""Defaults and bounds of the settings of machine descriptions."""


def test_settings(recorded, settings_in) -> None:
    recorded(settings_in("executive.machine"))
