"""What is said to a campaign with one value wrong, gone or renamed."""

import runpy
from pathlib import Path
from typing import Any

from executive.campaign.description.load import load_campaign
from executive.tree.catalogue import TableCatalogue

HERE = Path(__file__).parents[1]
EDITS = runpy.run_path(str(HERE / "edits.py"))
FAKES = runpy.run_path(str(HERE.parent / "tree" / "conftest.py"))
MISSION = "trees:\n  main: {sequence: [{ask: How?, choices: [slowly, quickly]}, {wait: 1 s}]}\n"
CAMPAIGN: dict[str, Any] = {
    "api": 1,
    "campaign": "whole",
    "description": "All there is.",
    "missions": ["waits.yaml"],
    "seeds": "3:5",
    "set": {"robot.site.stones.count": 4, "loop.tick": "100 ms"},
    "answers": ["slowly"],
    "factors": {
        "mapping.voxel_m": [0.1, 0.2],
        "stones": {"few": {"robot.site.stones.count": 2}, "many": {"robot.model": "mini"}},
    },
    "limits": {"time": "20 min", "memory": "4 GB"},
    "metrics": {
        "success": {"at_least": 0.9},
        "placement_error": {"median": {"at_most": "0.1 m"}, "p95": {"at_most": "30 cm"}},
        "collisions": {"max": {"at_most": 0}},
        "cycle_time": {},
    },
    "compare": [{"factor": "mapping.voxel_m", "baseline": 0.1, "metrics": ["success"]}],
}


def test_edits(recorded, tmp_path) -> None:
    known = FAKES["TableCatalogue"](FAKES["LEAVES"], FAKES["PLUGINS"])
    assert isinstance(known, TableCatalogue)
    (tmp_path / "waits.yaml").write_text(FAKES["HEADER"] + MISSION, encoding="utf-8")
    path = tmp_path / "campaign.yaml"

    def read(text: str):
        path.write_text(text, encoding="utf-8")
        return load_campaign(str(path), catalogue=known)

    recorded(EDITS["answers"](CAMPAIGN, 45, 9, tmp_path, read))
