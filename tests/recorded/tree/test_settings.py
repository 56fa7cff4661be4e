"""Defaults and bounds of the settings of the mission language."""


def test_settings(recorded, settings_in) -> None:
    recorded(settings_in("executive.tree"))
