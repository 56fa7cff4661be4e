"""The page on missions is true: its commands name missions, its table names nodes, its limits are
the code's.
"""

import re
from pathlib import Path

import pytest

from executive import registry
from executive.leaf import rest
from executive.messages.command import START_TOLERANCE
from executive.tree.load import load_mission

PAGE = (Path(__file__).parents[2] / "docs" / "missions.md").read_text(encoding="utf-8")
ROWS = re.findall(r"^\| .* \| (.*) \|$", PAGE.split("## One stone")[1].split("##")[0], re.M)[1:]
KINDS = {"retry"}


@pytest.mark.parametrize("name", re.findall(r"executive \w+ (\w+)", PAGE))
def test_the_commands_name_missions(name: str) -> None:
    assert load_mission(name, []).name == name


def test_the_table_names_what_there_is() -> None:
    behaviours = {one.name for one in registry.installed(registry.BEHAVIOURS)}
    trees = set(load_mission("pick_and_place", []).trees)
    named = {name for row in ROWS for name in re.findall(r"`(\w+)`", row)}
    assert len(named) > 8
    assert named <= behaviours | trees | KINDS


def test_the_limits_are_those_of_the_code() -> None:
    assert f"no joint faster than {rest._STANDING} rad/s" in PAGE
    assert f"strayed by 2 cm or {rest._STAYING:.2g} rad within a second" in PAGE.replace("\n", " ")
    assert f"farther than {START_TOLERANCE} rad" in PAGE
