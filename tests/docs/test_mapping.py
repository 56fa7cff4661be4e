"""The page on the map is true: its selections load, and the settings that it names exist."""

import re
from pathlib import Path

import pytest

from executive import registry
from executive.tree.load import load_mission

PAGE = (Path(__file__).parents[2] / "docs" / "how-to" / "mapping.md").read_text(encoding="utf-8")
PLUGINS = {point.name for point in registry.installed("mapping")}


def test_it_names_every_mapper() -> None:
    choice = PAGE[: PAGE.index("## ")]
    assert set(re.findall(r"^\| `(\w+)` \|", choice, flags=re.MULTILINE)) == PLUGINS


@pytest.mark.parametrize(
    "settings", [["mapping=voxel_map"], ["mapping.plugin=pose_graph", "mapping.window=300"]]
)
def test_its_selections_load(settings: list[str]) -> None:
    (chosen,) = load_mission("map_site", settings).plugins["mapping"]
    assert chosen.name in PAGE


def test_the_default_is_the_one_that_the_page_names() -> None:
    (chosen,) = load_mission("pick_and_place", []).plugins["mapping"]
    assert f"The shipped missions run **`{chosen.name}`**" in PAGE


def test_the_settings_that_it_names_exist() -> None:
    fields = set(registry.load("mapping", "pose_graph").Settings.model_fields)
    assert {"padding_m", "shadow_m", "window", "process"} <= fields
    assert all(f"`{name}" in PAGE for name in ("padding_m", "shadow_m", "window", "process"))
