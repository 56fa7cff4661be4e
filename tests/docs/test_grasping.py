"""The page on grasping is true: its selections load, its commands have the options that it gives them."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from executive import registry

PAGE = (Path(__file__).parents[2] / "docs" / "grasping.md").read_text(encoding="utf-8")
SELECTIONS = re.findall(r"grasping: (\{.*?\}|\w+)", re.search(r"```yaml\n(.*?)```", PAGE, re.S).group(1))
COMMANDS = re.findall(r"^(executive .*?)(?:\s+#.*)?$", re.search(r"```sh\n(.*?)```", PAGE, re.S).group(1), re.M)


@pytest.mark.parametrize("selection", SELECTIONS)
def test_a_selection_of_the_page_is_a_plugin_with_such_settings(selection: str) -> None:
    chosen = yaml.safe_load(selection)
    chosen = chosen if isinstance(chosen, dict) else {"plugin": chosen}
    name = chosen.pop("plugin")
    registry.settings_of("grasping", name).model_validate(chosen)


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_of_the_page_knows_its_options(command: str) -> None:
    executive = Path(sys.executable).with_name("executive")
    verb = command.split()[1]
    usage = subprocess.run([executive, verb, "--help"], capture_output=True, text=True, timeout=60, check=True).stdout
    assert set(re.findall(r"--\w+", command)) <= set(re.findall(r"--\w+", usage))


def test_the_page_shows_every_planner() -> None:
    assert {plugin.name for plugin in registry.installed("grasping")} <= set(re.findall(r"\w+", PAGE))
    assert len(SELECTIONS) == 5
    assert len(COMMANDS) == 3
