"""A run that was cut off is told with plugin, verb and place, and has a report all the same."""

import json
from dataclasses import asdict

import pytest

from executive.interfaces.report import CutOffReport
from executive.interfaces.report_file import read_report
from executive.supervision.cut_off import CutOff

STACK = """Current thread (most recent call first):
  File "/usr/lib/numpy/linalg.py", line 12 in solve
  File "/site/my_plugin/plan.py", line 34 in step
  File "/site/my_plugin/plan.py", line 56 in move
"""
ACTIVITY = {"component": "motion plugin 'mine'", "capability": "motion", "name": "mine",
            "verb": "move", "place": "plan.py:50", "folder": "/site/my_plugin"}  # fmt: skip


class Beacon:
    def __init__(self, folder, activity=None, stack=None, loop=None):
        self.activity_now, self.loop_now = activity or {}, loop or {}
        self.texts = {"run_dir": str(folder), "mission": "small"}
        if stack is not None:
            (folder / "stack").write_text(stack)
            self.texts["stack"] = str(folder / "stack")

    def text(self, name):
        return self.texts.get(name, "")

    def activity(self):
        return self.activity_now

    def loop(self):
        return self.loop_now


@pytest.mark.parametrize(
    ("code", "told"),
    [
        (-9, "the executive's process was ended by SIGKILL"),
        (-11, "the executive's process was ended by SIGSEGV"),
        (7, "the executive's process ended with exit status 7 before its run was over"),
        (0, "the executive's process ended with exit status 0 before its run was over"),
    ],
)
def test_a_process_that_ended_is_told_by_how_it_did(tmp_path, code, told):
    assert CutOff(Beacon(tmp_path), code, "").reason == told


def test_why_it_was_stopped_comes_before_how_its_process_ended(tmp_path):
    assert CutOff(Beacon(tmp_path), -9, "the loop was silent").reason == "the loop was silent"


def test_the_place_is_the_innermost_line_of_the_plugin_itself(tmp_path):
    cut_off = CutOff(Beacon(tmp_path, ACTIVITY, STACK), -9, "it hangs")
    told = "motion plugin 'mine' failed in 'move': it hangs (/site/my_plugin/plan.py:34)"
    assert cut_off.reason == told
    assert not (tmp_path / "stack").exists()  # it is of this process, and not of a later one


def test_without_a_line_of_the_plugin_the_place_is_that_of_its_verb(tmp_path):
    elsewhere = STACK.replace("/site/my_plugin", "/site/other")
    assert CutOff(Beacon(tmp_path, ACTIVITY, elsewhere), 1, "x").reason.endswith("x (plan.py:50)")
    assert CutOff(Beacon(tmp_path, ACTIVITY), 1, "x").reason.endswith("x (plan.py:50)")


def test_outside_of_a_plugin_the_place_is_the_innermost_line(tmp_path):
    assert CutOff(Beacon(tmp_path, {}, STACK), 1, "x").reason == "x (/usr/lib/numpy/linalg.py:12)"


LEAF = {"component": "behaviour 'Dig'", "name": "Dig", "node": "main/1:Dig"}


def test_what_the_loop_was_in_is_told_where_no_job_was_computed(tmp_path):
    verb = {**ACTIVITY, "verb": "observe"}
    told = CutOff(Beacon(tmp_path, loop=verb, stack=STACK), -9, "it hangs").reason
    assert told == "motion plugin 'mine' failed in 'observe': it hangs (/site/my_plugin/plan.py:34)"
    cut_off = CutOff(Beacon(tmp_path, loop=LEAF, stack=STACK), -9, "it hangs")
    assert cut_off.reason == "behaviour 'Dig' failed: it hangs (/usr/lib/numpy/linalg.py:12)"
    cut_off.write_report()
    fault = read_report(tmp_path / "report.json").fault
    assert (fault.component, fault.name, fault.verb, fault.node) == (
        "behaviour 'Dig'", "Dig", "", "main/1:Dig",
    )  # fmt: skip


@pytest.mark.parametrize(
    ("loop", "where"),
    [(LEAF, "behaviour 'Dig'"), ({**ACTIVITY, "verb": "see"}, "'see' of motion plugin 'mine'")],
)
def test_beside_a_job_it_is_told_where_the_loop_was(tmp_path, loop, where):
    told = CutOff(Beacon(tmp_path, ACTIVITY, loop=loop), -9, "").reason
    assert told.startswith("motion plugin 'mine' failed in 'move': the executive's process was")
    assert told.endswith(f"(plan.py:50); the loop was in {where}")
    assert "; " not in CutOff(Beacon(tmp_path, ACTIVITY, loop=ACTIVITY), -9, "").reason


def test_the_report_says_what_is_known(tmp_path):
    CutOff(Beacon(tmp_path, ACTIVITY, STACK), -9, "it hangs").write_report()
    report = read_report(tmp_path / "report.json")
    assert isinstance(report, CutOffReport)
    assert (report.mission, report.outcome) == ("small", "fault")
    assert report.reason.startswith("motion plugin 'mine' failed in 'move': it hangs")
    assert asdict(report.fault) == {
        "component": "motion plugin 'mine'",
        "capability": "motion",
        "name": "mine",
        "verb": "move",
        "node": "",
        "error": "it hangs",
        "place": "/site/my_plugin/plan.py:34",
        "traceback": STACK,
    }


def test_outside_of_a_plugin_the_mission_itself_has_failed(tmp_path):
    CutOff(Beacon(tmp_path), 7, "").write_report()
    fault = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))["fault"]
    assert fault["component"] == "the mission"
    assert {fault[name] for name in ("capability", "name", "verb", "place", "traceback")} == {""}


def test_a_report_that_is_there_is_kept(tmp_path):
    (tmp_path / "report.json").write_text("the run's own")
    CutOff(Beacon(tmp_path), 7, "").write_report()
    assert (tmp_path / "report.json").read_text() == "the run's own"


def test_a_folder_that_is_gone_has_no_report(tmp_path):
    CutOff(Beacon(tmp_path / "gone"), 7, "").write_report()
    beacon = Beacon(tmp_path)
    beacon.texts["run_dir"] = ""
    CutOff(beacon, 7, "").write_report()
    assert list(tmp_path.iterdir()) == []
