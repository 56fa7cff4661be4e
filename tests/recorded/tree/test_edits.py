"""What is said to a mission, to a part of it at a time, with one value wrong, gone or renamed."""

import runpy
from pathlib import Path
from typing import Any

import pytest

from executive.tree.load import load_mission

HERE = Path(__file__).parents[1]
EDITS = runpy.run_path(str(HERE / "edits.py"))
FAKES = runpy.run_path(str(HERE.parent / "tree" / "conftest.py"))
HEAD: dict[str, Any] = {
    "api": 1,
    "mission": "whole",
    "plugins": {"robot": "mujoco", "estimation": "gnss_imu", "mapping": "voxel_map"},
}
PICK = {"in": {"stone": "Stone", "tool": "str?"}, "out": {"held": "bool"}, "run": "Pick"}
SCAN = {"run": "Scan", "with": {"angle": "90 deg"}, "out": {"cloud": "{c}"}}
FIND = {"run": "FindStones", "in": {"cloud": "{c}"}, "out": {"stones": "{stones}"}}


def main(*nodes: Any) -> dict[str, Any]:
    return HEAD | {"trees": {"main": {"sequence": [*nodes]}}}


DOCUMENTS: dict[str, dict[str, Any]] = {
    "head": HEAD
    | {
        "description": "All there is.",
        "loop": {"tick": "50 ms", "time_limit": "1 h"},
        "plugins": HEAD["plugins"]
        | {
            "robot": {"plugin": "mujoco", "site": {"stones": {"count": 3}, "size_m": [1, 2]}},
            "monitoring": ["jaw_slip", {"plugin": "payload_drop"}],
        },
        "regions": {"yard": {"polygon": [[0, 0], [4, 0], [4, 3]]}},
        "trees": {"main": {"wait": 1}},
    },
    "leaves": main(
        SCAN | {"retry": {"attempts": 3, "pause": "1 s"}, "timeout": "30 s", "once": True},
        FIND | {"on_failure": {"wait": "1 s"}, "if": {"not": "Calm"}},
        {"check": "HasStones", "in": {"stones": "{stones}"}, "while": "Calm", "optional": True},
        SCAN | {"on_halt": {"set": {"a": 1}}, "name": "again"},
    ),
    "rounds": main(
        SCAN,
        FIND,
        {
            "for_each": {"item": "s", "in": "{stones}"},
            "do": {"call": "pick", "in": {"stone": "{s}"}, "out": {"held": "{held}"}},
        },
        {"loop": {"until": {"all": ["Calm", {"any": ["Calm"]}]}, "max": 3}, "do": {"wait": 1}},
        {"consume": {"item": "q", "from": "{stones}"}, "do": {"wait": 1}},
        {"loop": "forever", "do": {"wait": 1}, "timeout": 9},
    ),
    "choices": main(
        {"set": {"a": 2, "b": 4, "l": [1, 2]}},
        {"if": "{a} > 1 and {b} != 3", "then": {"wait": 1}, "else": {"wait": 2}},
        {"switch": "{a}", "cases": {"1": {"wait": 1}, "2": {"wait": 2}}, "else": {"wait": 3}},
        {"while": "Calm", "do": {"wait": 1}, "else": {"wait": 2}},
        {"ask": "Go on?", "default": False},
        {"ask": "Which?", "choices": ["left", "right"], "out": {"answer": "{side}"}},
        {"parallel": [{"wait": 1}, {"check": "Calm"}], "succeed": "one", "fail": 2},
        {"reactive_fallback": [{"check": "Calm"}, {"not": {"wait": 1}}]},
    ),
}
DOCUMENTS["rounds"]["trees"]["pick"] = PICK


@pytest.mark.parametrize("name", DOCUMENTS)
def test_edits(recorded, tmp_path, name) -> None:
    known = FAKES["TableCatalogue"](FAKES["LEAVES"], FAKES["PLUGINS"])
    path = tmp_path / "mission.yaml"

    def read(text: str):
        path.write_text(text, encoding="utf-8")
        return load_mission(str(path), (), known)

    recorded(EDITS["answers"](DOCUMENTS[name], 70, 7, tmp_path, read))
