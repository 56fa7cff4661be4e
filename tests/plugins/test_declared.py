"""What plugins declare apart from their classes is what the classes show."""

import pytest

from executive import registry
from executive.extras import MissingExtraError
from executive.interfaces.declaration import declared_by_class
from executive.registry import SETTINGS, BrokenPluginError

ANNOUNCED = [tuple(one.name.split(".", 1)) for one in registry.installed(SETTINGS)]


def test_every_shipped_plugin_with_settings_announces_them_apart() -> None:
    shipped = {
        (capability, one.name)
        for capability in registry.capabilities()
        for one in registry.installed(capability)
        if one.distribution == "executive"
    }
    assert shipped - set(ANNOUNCED) == {("viewing", "none")}


@pytest.mark.parametrize(("capability", "name"), ANNOUNCED)
def test_settings_needs_and_facilities_are_those_of_the_class(capability: str, name: str) -> None:
    try:
        plugin = registry.load(capability, name)
    except (BrokenPluginError, MissingExtraError):
        pytest.skip("the plugin cannot be imported here")
    assert registry.declared(capability, name) == declared_by_class(plugin)
