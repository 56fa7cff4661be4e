"""Defaults and bounds of the settings of faults on purpose."""


def test_settings(recorded, settings_in) -> None:
    recorded(settings_in("executive.faults"))
