"""The page on missions is true: its commands name missions, its table names nodes, its limits are
the code's.
"""

import re
from pathlib import Path

from executive import registry
from executive.leaf import rest
from executive.messages.command import START_TOLERANCE
from executive.tree.load import load_mission

PAGE = (Path(__file__).parents[2] / "docs" / "how-to" / "missions.md").read_text(encoding="utf-8")
ROWS = re.findall(r"^\| .* \| (.*) \|$", PAGE.split("## One stone")[1].split("##")[0], re.M)[1:]
KINDS = {"retry"}


def test_the_table_of_defaults_is_that_of_the_missions() -> None:
    plugins = load_mission("pick_and_place", []).plugins
    rows = PAGE.split("## Which algorithms run")[1].split("##")[0]
    told = dict(re.findall(r"^\| (\w+) \| ((?:`\w+`(?:, )?)+) \|", rows, re.M))
    chosen = {
        capability: ", ".join(f"`{one.name}`" for one in selected)
        for capability, selected in plugins.items()
        if capability not in ("robot", "surveying", "viewing")
    }
    assert told == chosen


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
