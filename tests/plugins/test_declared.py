"""What plugins declare apart from their classes is what the classes show."""

import pytest

from executive import registry
from executive.extras import MissingExtraError
from executive.interfaces.declaration import declared_by_class
from executive.registry import SETTINGS, BrokenPluginError
from executive.tree.load import load_mission
from executive.tree.sources import shipped_names

ANNOUNCED = [tuple(one.name.split(".", 1)) for one in registry.installed(SETTINGS)]


def test_every_plugin_of_a_shipped_mission_announces_its_settings_apart() -> None:
    for mission in shipped_names():
        chosen = load_mission(mission).plugins
        named = {(key.partition(".")[0], one.name) for key in chosen for one in chosen[key]}
        assert named <= set(ANNOUNCED) | {("viewing", "none")}


@pytest.mark.parametrize(("capability", "name"), ANNOUNCED)
def test_settings_needs_and_facilities_are_those_of_the_class(capability: str, name: str) -> None:
    try:
        plugin = registry.load(capability, name)
    except (BrokenPluginError, MissingExtraError):
        pytest.skip("the plugin cannot be imported here")
    assert registry.declared(capability, name) == declared_by_class(plugin)
