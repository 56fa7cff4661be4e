"""Clients of the Groot2 protocol over its sockets: a tiny one of our own, and the free `btview`."""

import json
import struct
import threading
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

from executive import extras
from executive.commands.main import app
from executive.errors import ConfigError
from executive.mission.groot.watching import publisher_at
from executive.mission.options import Options
from executive.mission.run import Run
from executive.tree.load import load_mission

zmq = pytest.importorskip("zmq", reason="needs the extra 'groot'")

WAITS = """
api: 1
mission: dry
plugins:
  robot: {plugin: kinematic, model: m545}
  estimation: gnss_imu_filter
trees:
  main:
    sequence:
      - set: {count: 3}
      - ask: Begin?
      - wait: 0.1 s
"""


@pytest.fixture
def port():
    """A port that is free, and the next one as well."""
    for candidate in range(21_667, 31_667, 2):
        try:
            publisher_at(candidate).close()
        except ConfigError:
            continue
        return candidate
    pytest.fail("no two free ports")


@pytest.fixture
def held(tmp_path):
    """Run a mission that waits for an answer; a client acts meanwhile, and answers at the end."""
    path = tmp_path / "dry.yaml"
    path.write_text(WAITS)

    def run_with(port, act, name="run"):
        options = Options(run_dir=tmp_path / name, groot=port, attended=True)
        made, asks, escaped = Run(load_mission(str(path), ()), options), threading.Event(), []

        def after_tick(mission):
            if not asks.is_set():
                missions.append(mission)
                asks.set()

        def client():
            asks.wait(60)
            try:
                act(missions[0])
            except BaseException as error:
                escaped.append(error)
            for put in missions[0].questions:
                put.question.take("yes")

        missions, other = [], threading.Thread(target=client)
        other.start()
        result = made.execute(after_tick)
        other.join(60)
        if escaped:
            raise escaped[0]
        return result

    return run_with


class Client:
    """The whole protocol in a few lines."""

    def __init__(self, port):
        self.context = zmq.Context()
        self.requests, self.notices = self.context.socket(zmq.REQ), self.context.socket(zmq.SUB)
        for one, at in ((self.requests, port), (self.notices, port + 1)):
            one.setsockopt(zmq.RCVTIMEO, 60_000)
            one.connect(f"tcp://127.0.0.1:{at}")
        self.notices.subscribe(b"")

    def ask(self, letter, *parts):
        self.requests.send_multipart([struct.pack("<BcI", 2, letter, 5), *parts])
        return self.requests.recv_multipart()

    def close(self):
        self.context.destroy(linger=0)


def test_a_client_holds_the_mission_at_a_breakpoint_and_lets_it_go_on(held, port):
    told = []

    def act(mission):
        client = Client(port)
        head, xml = client.ask(b"T")
        assert struct.unpack("<BcI", head[:6]) == (2, b"T", 5)
        assert b'_uid="4"' in xml
        assert client.requests.getsockopt(zmq.TYPE) == zmq.REQ
        assert client.ask(b"\xff") == [b"error", b"Request not recognized"]
        assert client.ask(b"S")[1][:3] == b"\x01\x00\x01"
        time.sleep(0.1)  # a subscription takes a moment to arrive
        hook = {"uid": 4, "position": 0, "mode": 0, "once": True, "enabled": True}
        assert len(client.ask(b"I", json.dumps(hook).encode())) == 1
        mission.questions[0].question.take("yes")
        told.append(client.notices.recv_multipart())
        while mission.phase != "paused":
            pass
        unlock = {"uid": 4, "position": 0, "desired_status": "SKIPPED", "remove_when_done": True}
        told.append(client.ask(b"U", json.dumps(unlock).encode()))
        client.close()

    result = held(port, act)
    assert result.report.outcome == "success"
    assert told[0][0][:2] == b"\x02N"
    assert told[0][1] == b"4"
    assert len(told[1]) == 1
    kinds = [
        line
        for line in result.folder.journal.read_text().splitlines()
        if "control_requested" in line
    ]
    assert ["breakpoint" in kinds[0], "unlock" in kinds[1]] == [True, True]


def test_it_listens_on_this_computer_alone(held, port):
    listening = []

    def act(mission):
        for line in Path("/proc/net/tcp").read_text().splitlines()[1:]:
            local, state = line.split()[1], line.split()[3]
            if state == "0A" and int(local.split(":")[1], 16) in (port, port + 1):
                listening.append(local.split(":")[0])
        assert str(port) not in Path("/proc/net/tcp6").read_text()

    held(port, act)
    assert listening == ["0100007F", "0100007F"]


def test_btview_shows_tree_statuses_and_keys_over_a_reload(held, port):
    client = pytest.importorskip("btview.client", reason="the peer 'btview' is not installed")
    seen = []

    def act(mission):
        tree = watcher.fetch_tree()
        names = {node.uid: node.display_name for node in tree.walk()}
        statuses = watcher.poll().statuses
        seen.append({names[uid]: state.status.name for uid, state in statuses.items()})
        seen.append(watcher.fetch_blackboard())
        seen.append(watcher.tree_uuid)

    watcher = client.Groot2Client(port=port, timeout_ms=60_000)
    held(port, act, "first")
    held(port, act, "second")
    watcher.close()
    assert seen[0] == {
        "sequence [Sequence]": "RUNNING",
        "set [SetKeys]": "SUCCESS",
        "ask [Ask]": "RUNNING",
        "wait [Sleep]": "IDLE",
    }
    assert seen[1] == {"main": {"count": 3}}
    assert seen[3:5] == seen[:2]
    assert seen[5] != seen[2]


def test_a_port_in_use_and_a_missing_extra_are_refused_before_anything_moves(
    tmp_path, port, monkeypatch
):
    path = tmp_path / "dry.yaml"
    path.write_text(WAITS)
    words = ["run", str(path), "--run-dir", str(tmp_path / "run"), "--groot-port", str(port)]
    taken = publisher_at(port + 1)
    refused = CliRunner().invoke(app, words).exception
    taken.close()
    assert f"port {port + 1} of 127.0.0.1 cannot be used" in str(refused)
    monkeypatch.setattr(extras, "missing_packages", lambda *_: ("pyzmq",))
    assert "needs the extra 'groot'" in str(CliRunner().invoke(app, words).exception)
    assert not (tmp_path / "run").exists()
