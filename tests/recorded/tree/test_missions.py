"""The shipped missions as text and graph, and the settings of the language."""

import pytest

from executive.tree.export import export
from executive.tree.load import load_mission

MISSIONS = ("map_site", "pick_and_place", "relocate")


@pytest.mark.parametrize("name", MISSIONS)
@pytest.mark.parametrize("form", ["text", "dot", "xml"])
def test_exports(recorded, name, form) -> None:
    recorded("\n".join(line for line in export(load_mission(name), form).splitlines()))


def test_settings(recorded, settings_in) -> None:
    recorded(settings_in("executive.tree"))
