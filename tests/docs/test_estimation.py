"""The page on estimation is true: its selections are plugins, its default is the missions'."""

import re
from pathlib import Path

import pytest
import yaml

from executive import registry
from executive.tree.load import load_mission

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "how-to" / "estimation.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```(\w+)\n(.*?)```", PAGE, re.S)


def test_its_selections_are_plugins() -> None:
    (body,) = (body for language, body in BLOCKS if language == "yaml")
    for capability, name in yaml.safe_load(body).items():
        assert name in {plugin.name for plugin in registry.installed(capability)}


@pytest.mark.parametrize("capability", ["estimation", "odometry"])
def test_it_shows_every_plugin(capability: str) -> None:
    for plugin in registry.installed(capability):
        assert f"| `{plugin.name}` |" in PAGE


def test_the_default_is_the_one_that_the_page_names() -> None:
    (chosen,) = load_mission("pick_and_place", []).plugins["estimation"]
    assert f"The shipped missions run **`{chosen.name}` without lidar odometry**" in PAGE
    assert "odometry" not in load_mission("pick_and_place", []).plugins
