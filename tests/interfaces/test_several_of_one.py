"""Of which capabilities a mission may have several plugins at once."""

from executive import registry


def test_a_mission_may_have_several_monitors_and_one_plugin_of_every_other_capability() -> None:
    assert {name for name in registry.capabilities() if registry.is_plural(name)} == {"monitoring"}
