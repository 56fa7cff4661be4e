"""Defaults and bounds of the settings of watched conditions."""


def test_settings(recorded, settings_in) -> None:
    recorded(settings_in("executive.watch"))
