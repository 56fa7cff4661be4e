"""Defaults and bounds of the settings of the topics of a log."""


def test_settings(recorded, settings_in) -> None:
    recorded(settings_in("executive.logs"))
