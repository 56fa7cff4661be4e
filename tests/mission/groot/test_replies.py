"""Requests of the Groot2 protocol, answered for a mission that runs; no socket is needed for it."""

import json
import struct
from xml.etree import ElementTree

import pytest

from executive.errors import ConfigError
from executive.events.mission import PhaseChanged
from executive.journal import read_journal
from executive.mission.groot.breakpoints import Breakpoints
from executive.mission.groot.protocol import notice_header
from executive.mission.groot.replies import Replies
from executive.mission.groot.shown_tree import ShownTree
from executive.mission.options import Options
from executive.mission.run import Run
from executive.tree.load import load_mission

msgpack = pytest.importorskip("msgpack")

HEAD = """
api: 1
mission: dry
plugins:
  robot: {plugin: kinematic, model: m545}
  estimation: gnss_imu_filter
  mapping: voxel_map
"""
TREE = f"""{HEAD}
trees:
  main:
    sequence:
      - wait: 0.1 s
      - set: {{count: 1}}
      - call: pause
        in: {{time: "{{count}}"}}
      - call: pause
        in: {{time: 2}}
      - if: "{{count}} > 5"
        set: {{count: 9}}
      - timeout: 2 s
        retry: 2
        do: {{wait: 0.1 s}}
  pause:
    in: {{time: int}}
    sequence:
      - set: {{twice: "{{time}} * 2"}}
      - wait: 0.1 s
"""
SAVES = f"""{HEAD}
trees:
  main:
    sequence:
      - wait: 0.1 s
      - run: SaveMap
"""


def header(letter, number=7):
    return struct.pack("<BcI", 2, letter.encode(), number)


class Client:
    """Asks a running mission between two ticks."""

    def __init__(self, description, mission):
        self.reached = []
        self.tree = ShownTree(description, mission)
        self.breakpoints = Breakpoints(self.tree.node, mission.wishes, self.reached.append)
        self.replies = Replies(self.tree, self.breakpoints)

    def ask(self, letter, part=None):
        parts = [header(letter)]
        if part is not None:
            parts.append(part if isinstance(part, bytes) else json.dumps(part).encode())
        return self.replies.reply(parts)

    def uid_of(self, path):
        return next(uid for uid, node in self.tree._nodes.items() if node.path == path)

    def statuses(self):
        raw = self.ask("S")[1]
        return {raw[i] | raw[i + 1] << 8: raw[i + 2] for i in range(0, len(raw), 3)}


@pytest.fixture
def watched(tmp_path):
    """Run a mission, with a function that is called after each tick with a client and it."""

    def run_with(text, act):
        path = tmp_path / "dry.yaml"
        path.write_text(text)
        description, clients, escaped = load_mission(str(path), ()), [], []

        def after_tick(mission):
            try:
                if not clients:
                    clients.append(Client(description, mission))
                act(clients[0], mission)
            except BaseException as error:
                escaped.append(error)
                raise

        made = Run(description, Options(run_dir=tmp_path / "run"))
        result = made.execute(after_tick)
        if escaped:
            raise escaped[0]
        return result

    return run_with


def test_the_tree_has_a_number_at_each_node_and_expands_each_call(watched):
    found = []
    watched(TREE, lambda client, mission: found.append(client.ask("T")))
    assert found[0][0][:6] == header("T")
    assert found[0][0] == found[-1][0]
    assert len(found[0][0]) == 22
    root = ElementTree.fromstring(found[0][1])
    trees = root.findall("BehaviorTree")
    assert [one.get("ID") for one in trees] == ["main", "pause", "pause"]
    assert [one.get("_fullpath") for one in trees] == ["", "main/2:pause", "main/3:pause"]
    calls = root.findall("BehaviorTree//SubTree")
    assert [one.get("_fullpath") for one in calls] == ["main/2:pause", "main/3:pause"]
    nodes = [one for tree in trees for one in tree.iter() if one.get("_uid")]
    uids = [int(one.get("_uid")) for one in nodes]
    assert len(set(uids)) == len(uids) == 17
    tags = {one.tag for one in nodes}
    models = {one.get("ID") for one in root.find("TreeNodesModel")}
    assert {"If", "SetKeys"} <= tags & models
    assert "Timeout" in tags - models


def test_statuses_follow_the_tree(watched):
    seen = []

    def act(client, mission):
        found = client.statuses()
        seen.append(
            [
                found[client.uid_of(path)]
                for path in ("main/2:pause", "main/4:set@if", "main/5:retry/0:wait")
            ]
        )

    watched(TREE, act)
    assert seen[0] == [0, 0, 0]
    assert seen[-1] == [2, 4, 2]
    assert [1, 0, 0] in seen
    assert [2, 4, 1] in seen


def test_the_keys_of_a_tree_and_of_a_call_that_runs_are_shown(watched):
    found = []

    def act(client, mission):
        found.append(msgpack.unpackb(client.ask("B", b"main;main/2:pause;nothing")[1]))
        found.append(msgpack.unpackb(client.ask("B", b"")[1]))

    watched(TREE, act)
    keys = {"main": {"count": 1}, "main/2:pause": {"time": 1, "twice": 2}}
    assert found[4:6] == [keys, keys]
    assert found[-1] == {"main": {"count": 1}}


def at(client, path, **more):
    return {
        "uid": client.uid_of(path),
        "position": 0,
        "mode": 0,
        "once": False,
        "enabled": True,
        "desired_status": "SKIPPED",
        **more,
    }


UNLOCK = {"desired_status": "SKIPPED", "remove_when_done": False}


def reasons(result):
    entries = read_journal(result.folder.journal)
    return [e.event.reason for e in entries if isinstance(e.event, PhaseChanged)]


@pytest.mark.parametrize(("position", "status"), [(0, 1), (1, 1)])
def test_a_breakpoint_pauses_the_mission_until_it_is_unlocked(watched, position, status):
    steps, before = [], "main/5:retry/0:wait" if position == 0 else "main/2:pause/0:sequence/1:wait"

    def act(client, mission):
        if not steps:
            assert len(client.ask("I", at(client, before, position=position))) == 1
        steps.append((mission.phase, mission.clock.now_s()))
        paused = [one for one in steps if one[0] == "paused"]
        if steps[-1][0] == "paused" and len(paused) == 5:
            assert client.reached == [client.uid_of(before)]
            assert client.statuses()[client.uid_of(before)] == status
            client.ask("U", {**UNLOCK, "uid": client.uid_of(before), "position": position})

    result = watched(TREE, act)
    assert result.report.outcome == "success"
    assert result.report.pauses.count == 1
    where = f"breakpoint {'after' if position else 'before'} {before}"
    assert reasons(result)[1:3] == [where, "resumed by a Groot2 client"]


def test_a_breakpoint_at_each_node_steps_from_node_to_node(watched):
    reached = []

    def act(client, mission):
        if not client.breakpoints.as_json():
            nodes = client.tree._nodes.values()
            hooks = [at(client, node.path) for node in nodes if node.path.startswith("main/2")]
            client.ask("I", hooks)
        if mission.phase == "paused":
            (held,) = [one for one in client.breakpoints._all.values() if one.is_held]
            reached.append(held.node.path)
            client.ask("U", {**UNLOCK, "uid": held.uid, "position": 0})

    watched(TREE, act)
    inner = ("main/2:pause/0:sequence", "0:set", "1:wait")
    assert reached == ["main/2:pause", inner[0], *(f"{inner[0]}/{one}" for one in inner[1:])]


def test_a_breakpoint_that_is_removed_or_disabled_while_it_holds_lets_the_tree_go_on(watched):
    for letter, part in (("R", True), ("A", False), ("X", False)):
        asked = []

        def act(client, mission, letter=letter, part=part, asked=asked):
            if not asked:
                asked.append(
                    client.ask("I", at(client, "main/2:pause/0:sequence/1:wait", position=1))
                )
            if mission.phase == "paused":
                wanted = at(client, "main/2:pause/0:sequence/1:wait", position=1)
                asked.append(client.ask(letter, wanted if part else None))
                hooks = json.loads(client.ask("D")[1])
                assert [one["enabled"] for one in hooks] == ([False] if letter == "X" else [])

        (folder := watched(TREE, act).folder).path.rename(folder.path.with_name(f"run{letter}"))
        assert len(asked) == 2


def test_ctl_resume_lets_the_tree_go_on_as_well_and_once_holds_once(watched):
    asked, held = [], []

    def act(client, mission):
        if not asked:
            asked.append(client.ask("I", at(client, "main/5:retry/0:wait", once=True)))
        if mission.phase == "paused":
            mission.wishes.go_on("somebody")
            assert len(json.loads(client.ask("D")[1])) == 1
            held.append(1)
        if mission.is_ending:
            assert json.loads(client.ask("D")[1]) == []

    assert watched(TREE, act).report.pauses.count == 1
    assert held == [1]


def test_an_action_before_its_beginning_is_skipped_and_no_node_fails_on_demand(watched):
    told = []

    def act(client, mission):
        here = {"uid": client.uid_of("main/1:SaveMap"), "position": 0}
        if mission.phase == "paused":
            for status in ("FAILURE", "SUCCESS"):
                told.append(client.ask("U", {**UNLOCK, **here, "desired_status": status})[0])
        elif not client.breakpoints.as_json():
            client.ask("I", at(client, "main/1:SaveMap"))

    result = watched(SAVES, act)
    assert told[0] == b"error"
    assert told[1] != b"error"
    assert result.report.outcome == "success"


BAD = [
    ([b""], "wrong request header"),
    ([b"\x02T\x00\x00\x00\x00\x00"], "wrong request header"),
    ([header("Z")], "Request not recognized"),
    ([header("N")], "Request not recognized"),
    ([header("B")], "must be 2 parts message"),
    ([header("I"), b"{"], "no JSON"),
    ([header("I"), b"[1]"], "a hook is a JSON object"),
    ([header("I"), b'{"uid": 9999, "position": 0}'], "Node ID not found"),
    ([header("I"), b'{"uid": true, "position": 0}'], "'uid' must be a whole number"),
    ([header("I"), b'{"uid": 1, "position": 2}'], "'position' is 0"),
    ([header("I"), b'{"uid": 1, "position": 0, "mode": 1}'], "cannot be replaced"),
    ([header("R"), b'{"uid": 1, "position": 0}'], "Node ID not found"),
    ([header("U"), b'{"uid": 1, "position": 0}'], "Node ID not found"),
    ([header("U"), b"\xff\xfe"], "no JSON"),
]


def test_a_bad_request_is_replied_with_what_is_wrong(watched):
    replied = []

    def act(client, mission):
        if not replied:
            replied.extend(client.replies.reply(parts) for parts, _ in BAD)

    assert watched(TREE, act).report.outcome == "success"
    for (_, told), (error, text) in zip(BAD, replied, strict=True):
        assert error == b"error"
        assert told in text.decode()


def test_a_tree_beyond_the_numbers_of_the_protocol_is_refused(watched, monkeypatch):
    monkeypatch.setattr("executive.mission.groot.shown_tree._MOST_NODES", 3)
    with pytest.raises(ConfigError, match="at most 3 nodes"):
        watched(TREE, lambda client, mission: None)


def test_a_notice_has_the_header_of_a_request():
    assert notice_header(3) == header("N", 3)
