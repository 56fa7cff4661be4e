"""A person controls a running mission over its socket; the journal keeps who asked for what."""

import json
import os
import threading
import time
from collections import deque

import pytest
from typer.testing import CliRunner

from executive.commands.main import app
from executive.control.client import ask
from executive.control.request import Request, Verb
from executive.events.control import ControlRequested
from executive.events.mission import PhaseChanged
from executive.journal import read_journal
from executive.mission.control.desk import Desk
from executive.mission.options import Options
from executive.mission.resume import resumed_run
from executive.mission.run import Run
from executive.tree.load import load_mission

HEAD = """
api: 1
mission: dry
plugins:
  robot: {plugin: kinematic, model: m545}
  estimation: gnss_imu_filter
  mapping: voxel_map
  motion: hermite
  objects: sqlite
trees:
  main:
    sequence:
      - ask: Begin?
"""
WAITS = f"{HEAD}      - wait: 0.5 s\n"
LOADS = f"""{HEAD}      - run: LoadMap
        with: {{file: site.ply}}
      - wait: 0.1 s
"""
SAVES = f"{HEAD}      - {{run: SaveMap, with: {{file: none/site.ply}}}}\n"
SWINGS = f"{HEAD}      - {{run: ScanSwing, with: {{angle: 60 deg, duration: 8 s}}}}\n"
OPENS = f"{HEAD}      - run: OpenGripper\n"


class Control:
    """What a person does at another terminal, and what the run replies."""

    def __init__(self, folder):
        self.folder = folder

    def __call__(self, verb, argument="", node=""):
        return ask(self.folder, Request(Verb(verb), argument, node), 60)

    def status(self):
        return self("status").status

    def wait_for(self, phase):
        return self.until(lambda found: found["phase"] == phase)

    def until(self, holds):
        deadline_s = time.monotonic() + 60
        while not holds(found := self.status()):
            assert time.monotonic() < deadline_s, found
            time.sleep(0.005)
        return found


@pytest.fixture
def operate(tmp_path):
    """Run a mission with a person at its socket; return the result."""

    def run_with(text, person, prepare=lambda run: None, **options):
        path = tmp_path / "dry.yaml"
        path.write_text(text)
        folder, listens, escaped = tmp_path / "run", threading.Event(), []
        made = Run(load_mission(str(path), ()), Options(run_dir=folder, **options))
        prepare(made)

        def act():
            listens.wait(60)
            try:
                person(Control(folder))
            except BaseException as error:
                escaped.append(error)
                os.kill(os.getpid(), 2)

        other = threading.Thread(target=act)
        other.start()
        try:
            result = made.execute(lambda mission: listens.set())
        finally:
            listens.set()
            other.join(60)
        if escaped:
            raise escaped[0]
        return result

    return run_with


def events(result, kind):
    return [e.event for e in read_journal(result.folder.journal) if isinstance(e.event, kind)]


def entries_of(result, kind):
    return [entry for entry in read_journal(result.folder.journal) if entry.kind == kind]


def test_a_question_is_answered_and_the_mission_paused_stepped_and_resumed(operate):
    steps = []

    def person(ctl):
        assert ctl.wait_for("awaiting_operator")["questions"][0]["text"] == "Begin?"
        assert "did you mean 'no'" in ctl("answer", "noo").text.lower()
        assert ctl("pause").is_done
        assert not ctl("pause").is_done
        assert "answer it first" in ctl("step").text
        assert ctl("answer", "yes").is_done
        ctl.wait_for("paused")
        for _ in range(2):
            steps.append(ctl.status()["mission_s"])
            assert ctl("step", "3").is_done
            ctl.until(lambda found: found["mission_s"] > steps[-1] + 0.149)
            ctl.wait_for("paused")
        steps.append(ctl.status()["mission_s"])
        assert ctl("resume").is_done

    result = operate(WAITS, person, attended=True)
    assert result.report.outcome == "success"
    assert [round(later - steps[0], 6) for later in steps] == [0.0, 0.15, 0.3]
    requests = events(result, ControlRequested)
    assert [(one.verb, one.is_done) for one in requests] == [
        ("answer", False),
        ("pause", True),
        ("pause", False),
        ("step", False),
        ("answer", True),
        ("step", True),
        ("step", True),
        ("resume", True),
    ]
    assert {(one.uid, one.pid) for one in requests} == {(os.geteuid(), os.getpid())}
    assert f"paused by {requests[0].user} (ctl)" in {
        one.reason for one in events(result, PhaseChanged)
    }
    assert [e.event.source for e in entries_of(result, "question_answered")] == ["ctl"]


def test_a_mission_is_stopped(operate):
    result = operate(WAITS, lambda ctl: ctl("stop"), attended=True)
    assert (result.report.outcome, result.exit_status) == ("stopped", 1)
    assert not (result.folder.path / "control.sock").exists()


def test_what_makes_no_sense_is_refused_with_the_reason(operate):
    told = {}

    def person(ctl):
        ctl.wait_for("awaiting_operator")
        told["resume"] = ctl("resume").text
        told["step"] = ctl("step").text
        told["skip"] = ctl("skip").text
        told["retry"] = ctl("retry", node="main/9:No").text
        told["reset"] = ctl("reset").text
        told["answer"] = ctl("answer", "yes", node="main/7:x").text
        ctl("answer", "no")

    result = operate(WAITS, person, attended=True)
    assert result.report.outcome == "failure"
    assert told == {
        "resume": "it awaits an answer: use `answer`",
        "step": "a step needs a paused mission, and it is awaiting_operator",
        "skip": "no action runs; use `answer`",
        "retry": "no action runs at 'main/9:No'; there is none",
        "reset": "no safe stop is latched",
        "answer": "no question is open at main/7:x",
    }


def test_an_action_that_failed_waits_for_a_person_and_is_tried_again(operate, tmp_path):
    def person(ctl):
        ctl("pause", "on_failure")
        ctl("answer", "yes")
        found = ctl.wait_for("paused")
        assert found["failed"][0]["node"] == "main/1:LoadMap"
        assert "writes 'loaded_map'" in ctl("skip").text
        (tmp_path / "run" / "site.ply").write_bytes(
            b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
            b"property float z\nend_header\n0 0 0\n"
        )
        assert ctl("retry").is_done

    result = operate(LOADS, person, attended=True)
    assert result.report.outcome == "success", result.report.reason
    assert len(entries_of(result, "leaf_called")) == 2


@pytest.mark.parametrize(("verb", "outcome"), [("skip", "success"), ("resume", "failure")])
def test_a_failure_is_skipped_or_stands(operate, verb, outcome):
    def person(ctl):
        ctl("answer", "yes")
        ctl.wait_for("paused")
        assert ctl(verb).is_done

    result = operate(SAVES, person, attended=True, pause_on_failure=True)
    assert result.report.outcome == outcome


def pause_in_action(ctl):
    """Pause before the action begins, and let it begin."""
    ctl.wait_for("awaiting_operator")
    ctl("pause")
    ctl("answer", "yes")
    ctl.wait_for("paused")
    ctl("step", "2")
    ctl.until(lambda found: found["running"] and found["phase"] == "paused")


def test_a_wait_is_under_way_as_an_action_is(operate):
    told = []

    def person(ctl):
        pause_in_action(ctl)
        told.extend(ctl.status()["running"])
        ctl("resume")

    operate(WAITS, person, attended=True)
    (running,) = told
    assert running["node"].startswith("main/1")
    assert running["says"].endswith(" s left")


def test_an_action_under_way_begins_again_or_counts_as_done(operate):
    def person(ctl):
        pause_in_action(ctl)
        assert "when the mission goes on" in ctl("retry").text
        ctl("step")
        ctl.until(lambda found: found["running"] and found["phase"] == "paused")
        assert ctl("skip", node="main/1:ScanSwing").is_done
        ctl("resume")

    result = operate(SWINGS, person, attended=True)
    assert result.report.outcome == "success", result.report.reason
    answered = entries_of(result, "leaf_answered")[-1]
    assert answered.event.reason.startswith("skipped by")
    assert answered.time_s < 1.0


def test_an_irreversible_action_under_way_is_neither_skipped_nor_begun_again(operate):
    told = []

    def person(ctl):
        pause_in_action(ctl)
        told.extend([ctl("skip").text, ctl("retry").text])
        ctl("resume")

    result = operate(OPENS, person, attended=True)
    assert result.report.outcome == "success"
    assert all("OpenGripper cannot be taken back" in text for text in told)


def test_a_latched_stop_is_released_while_the_mission_is_held(operate):
    robots = []

    def person(ctl):
        ctl.wait_for("awaiting_operator")
        robots[0].safe_stop("somebody pressed the button")
        assert ctl.status()["latched"] == "somebody pressed the button"
        assert ctl("reset").is_done
        assert robots[0].latched() == ""
        ctl("stop")

    operate(
        WAITS,
        person,
        prepare=lambda run: robots.append(run._assembly.plugins["robot"]),
        attended=True,
    )


def test_a_run_that_was_cut_off_after_orders_of_a_person_goes_on(operate, tmp_path, monkeypatch):
    """The orders are in the journal as what they made of the leaf, so that it can be followed."""

    def person(ctl):
        pause_in_action(ctl)
        ctl("skip")
        ctl("resume")

    monkeypatch.setattr("executive.mission.run_folder.RunFolder.forget_state", lambda self: None)
    result = operate(f"{SWINGS}      - wait: 1 s\n", person, attended=True)
    assert result.report.outcome == "success"
    journal = result.folder.journal
    lines = journal.read_bytes().splitlines(keepends=True)
    cut = next(n for n, line in enumerate(lines) if b"skipped by" in line) + 3
    journal.write_bytes(b"".join(lines[:cut]))
    again = resumed_run(result.folder.path).execute(lambda mission: None)
    assert again.report.outcome == "success", again.report.reason


def test_the_command_says_what_the_run_replies_and_refuses_what_it_cannot_mean(tmp_path, operate):
    runner, said = CliRunner(), {}

    def person(ctl):
        ctl.wait_for("awaiting_operator")
        for words in (["status"], ["status", "--json"], ["step"], ["answer", "yes"]):
            said[" ".join(words)] = runner.invoke(app, ["ctl", str(tmp_path / "run"), *words])

    operate(WAITS, person, attended=True)
    assert "asks          Begin? [yes, no]  main/0:ask" in said["status"].output
    assert json.loads(said["status --json"].stdout)["phase"] == "awaiting_operator"
    assert (said["step"].exit_code, said["answer yes"].exit_code) == (1, 0)
    for words, told in (
        (["puase"], "Did you mean 'pause'"),
        (["pause", "now"], "takes no word"),
        (["answer"], "give the answer"),
        (["stop", "--on-failure"], "belongs to pause"),
        (["stop", "--timeout=0"], "more than 0 s"),
        (["stop", "--timeout=nan"], "more than 0 s"),
        (["stop"], r"has ended (success)"),
    ):
        refused = runner.invoke(app, ["ctl", str(tmp_path / "run"), *words])
        assert told in str(refused.exception), words


def test_a_client_that_floods_is_served_over_several_ticks(monkeypatch):
    class Server:
        def __init__(self):
            self.asked, self.looks, self.replies = deque(), deque(range(50)), 0

        def reply(self, asked, reply):
            self.replies += 1

    server = Server()
    desk = Desk(None, server)
    monkeypatch.setattr(Desk, "_reply", lambda self, asked: None)
    desk.serve()
    assert server.replies == 2
    desk.close()
    assert server.replies == 50
