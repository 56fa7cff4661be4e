"""Trees as a monitor of BehaviorTree.CPP shows them, with every kind of node and modifier."""

import runpy
from itertools import count
from pathlib import Path

import pytest

from executive.tree.btcpp.live_xml import live_xml
from executive.tree.build import build_tree
from executive.tree.export import export
from executive.tree.load import load_mission

TESTS = Path(__file__).parents[2]
FAKES = runpy.run_path(str(TESTS / "tree" / "conftest.py"))
TREES = """
trees:
  main:
    sequence:
      - run: Scan
        with: {angle: 90 deg}
        timeout: 30 s
        retry: {attempts: 3, pause: 500 ms}
        on_failure: {wait: 2 s}
        on_halt: {set: {halted: true}}
        out: {cloud: "{cloud}"}
      - {run: FindStones, in: {cloud: "{cloud}"}, out: {stones: "{stones}"}, once: true}
      - for_each: {item: stone, in: "{stones}"}
        do:
          call: pick_one
          in: {stone: "{stone}"}
          if: {all: [Calm, {not: {check: HasStones, in: {stones: "{stones}"}}}]}
          while: Calm
          optional: true
      - loop: {until: Calm, max: 3}
        do: {ask: "Go on?", default: true}
      - set: {a: 1, b: "{stones}"}
      - fallback: [{check: Calm}, {wait: 1 s}]
      - reactive_sequence: [{check: Calm}, {wait: 1 s}]
      - reactive_fallback: [{check: Calm}, {wait: 1 s}]
      - parallel: [{check: Calm}, {wait: 1 s}]
      - if: "{a} > 1"
        then: {wait: 1 s}
        else: {wait: 2 s}
      - switch: "{a}"
        cases: {1: {wait: 1 s}, 2: {wait: 2 s}}
        else: {wait: 3 s}
      - check: "{a} > 1"
  pick_one:
    in: {stone: Stone}
    sequence:
      - {run: Pick, in: {stone: "{stone}"}}
"""


def test_every_kind(recorded, tmp_path) -> None:
    path = tmp_path / "mission.yaml"
    path.write_text(FAKES["HEADER"] + TREES, encoding="utf-8")
    catalogue = FAKES["TableCatalogue"](FAKES["LEAVES"], FAKES["PLUGINS"])
    mission = load_mission(str(path), (), catalogue)
    root, numbers = build_tree(mission, FAKES["FakeRuntime"]()), count(1)
    recorded(live_xml(mission, root, lambda _: next(numbers)))
    for form in ("text", "dot", "xml"):
        recorded(export(mission, form))


@pytest.mark.parametrize("name", ["map_site"])
def test_shipped_missions(recorded, name) -> None:
    mission, numbers = load_mission(name), count(1)
    root = build_tree(mission, FAKES["FakeRuntime"]())
    recorded(live_xml(mission, root, lambda _: next(numbers)))
