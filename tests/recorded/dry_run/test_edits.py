"""What is said to a file of mocks with one value wrong, gone or renamed."""

import runpy
from pathlib import Path
from typing import Any

from executive.dry_run.mock_file import read_mocks
from executive.dry_run.places import places_of
from executive.tree.catalogue import TableCatalogue
from executive.tree.load import load_mission

HERE = Path(__file__).parents[1]
EDITS = runpy.run_path(str(HERE / "edits.py"))
SMALL = runpy.run_path(str(HERE.parent / "dry_run" / "conftest.py"))
TREE = """
    sequence:
      - {run: Look, out: {rock: "{rock}", count: "{count}"}}
      - {check: Calm}
      - {ask: "Left or right?", choices: [left, right], out: {answer: "{side}"}}
      - {ask: "Sure?", name: sure}
      - fallback: [{run: Turn, name: first turn, timeout: 10 s}, {run: Turn}]
"""
MOCKS: dict[str, Any] = {
    "api": 1,
    "mocks": {
        "Look": {"after": "12 s", "outputs": {"rock": {"mass": "2.5 t"}, "count": 3}},
        "Calm": [{"status": "failure", "reason": "wind"}, {"status": "success", "after": 3}],
        "2:ask": {"answer": "left"},
        "first turn": {"status": "failure", "after": "2 s", "final": True},
        "main/4:fallback/1:Turn": ["failure", "success"],
        "sure": "success",
    },
    "expect": {
        "outcome": "success",
        "within": "1 min",
        "visited": ["sure"],
        "not_visited": ["first turn"],
        "ends": {"Look": ["success"], "Calm": ["failure", "success"]},
        "keys": {"count": 3},
        "that": ["{count} > 2", "{rock.mass} > 2 t"],
    },
}


def test_edits(recorded, tmp_path) -> None:
    mission, mocks = tmp_path / "small.yaml", tmp_path / "mocks.yaml"
    mission.write_text(f"{SMALL['HEADER']}trees:\n  main:{TREE}", encoding="utf-8")
    known = TableCatalogue(SMALL["LEAVES"], SMALL["PLUGINS"])
    places = places_of(load_mission(str(mission), (), known))

    def read(text: str):
        mocks.write_text(text, encoding="utf-8")
        return read_mocks(mocks, places)

    recorded(EDITS["answers"](MOCKS, 120, 3, tmp_path, read))
