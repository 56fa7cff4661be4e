"""What takes longer than a share of a tick is called by no leaf itself: it is handed to a job."""

import ast
from pathlib import Path

import executive.behaviours
import executive.leaf
from executive.registry import load

FOLDERS = [Path(one.__path__[0]) for one in (executive.behaviours, executive.leaf)]
VERBS = {*load("mapping", "voxel_map").beside_tick, *load("objects", "sqlite").beside_tick}
FUNCTIONS = {"form_evidence", "form_refusal", "is_refuted", "read_map", "write_map"}
# They call the evidence where a job computes it; and a condition cannot wait.
ALLOWED = {"form_evidence.py", "mark_region.py", "removal.py"}


def slow_calls(source):
    """Return the lines that call one of the slow verbs or functions."""
    calls = [one for one in ast.walk(ast.parse(source)) if isinstance(one, ast.Call)]
    return [
        call.lineno
        for call in calls
        if getattr(call.func, "attr", "") in VERBS or getattr(call.func, "id", "") in FUNCTIONS
    ]


def test_a_call_in_the_tick_is_found():
    assert slow_calls("def run(self):\n    cloud = self.context.use(Mapper).cloud()") == [2]
    assert slow_calls("form = form_evidence(points, model, 0.3)") == [1]
    assert not slow_calls("cloud = yield from self.context.job(self.context.use(Mapper).cloud)")


def test_no_leaf_makes_one():
    found = [
        f"{file.name}:{line}"
        for folder in FOLDERS
        for file in sorted(folder.glob("*.py"))
        if file.name not in ALLOWED
        for line in slow_calls(file.read_text(encoding="utf-8"))
    ]
    assert found == []
