"""`executive journal` chooses lines of a run; `executive replay` goes through it event by event."""

import io
import json
import re
import sys

import pytest

from executive.commands.main import main
from executive.events.mission import PauseEnded
from executive.events.node import NodeEnded, NodeResult, NodeStarted
from executive.journal import Journal

STORY = [
    (1.0, "main", NodeStarted()),
    (2.0, "main/1:scan", NodeStarted()),
    (3.0, "main/1:scan@retry", NodeStarted()),
    (3.5, "main/1:scan/0:look", NodeStarted()),
    (4.0, "main/10:drive", NodeStarted()),
    (5.0, "main/10:drive", NodeEnded(NodeResult.FAILURE, "rain")),
    (6.0, "", PauseEnded(1.0)),
]


@pytest.fixture
def run(tmp_path):
    journal = Journal(tmp_path / "journal.jsonl")
    for time_s, node, event in STORY:
        journal.append(round(20 * time_s), time_s, node, event)
    return tmp_path


@pytest.fixture
def read(run, capsys, monkeypatch):
    """Run a verb over the run; return its lines on standard output and on standard error."""

    def read(verb, *options):
        monkeypatch.setattr(sys, "argv", ["executive", verb, str(run), *options])
        with pytest.raises(SystemExit) as end:
            main()
        assert end.value.code == 0
        told = capsys.readouterr()
        return told.out.splitlines(), told.err.splitlines()

    return read


def times(lines):
    return [float(line.split()[0]) for line in lines]


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ((), [1.0, 2.0, 3.0, 3.5, 4.0, 5.0, 6.0]),
        (("--kind", "node_ended", "--kind", "pause_ended"), [5.0, 6.0]),
        (("--node", "main/1"), [2.0, 3.0, 3.5]),
        (("--node", "main/1:scan"), [2.0, 3.0, 3.5]),
        (("--node", "main/10"), [4.0, 5.0]),
        (("--node", "main"), [1.0, 2.0, 3.0, 3.5, 4.0, 5.0]),
        (("--from", "3", "--to", "4"), [3.0, 3.5, 4.0]),
        (("--from", "0", "--to", "0"), []),
        (("--from", "3", "--node", "main/1", "--kind", "node_started"), [3.0, 3.5]),
    ],
)
def test_lines_are_chosen_by_kind_node_and_time(read, options, expected):
    lines, told = read("journal", *options)
    assert (times(lines), len(told)) == (expected, 0 if expected else 1)


def test_a_line_is_printed_for_people_or_as_json(read):
    lines, _ = read("journal", "--kind", "node_ended")
    told = '{"status": "failure", "reason": "rain"}'
    assert lines == [f"     5.00 s  node_ended           {'main/10:drive':<44}  {told}"]
    (line,), _ = read("journal", "--kind", "node_ended", "--json")
    assert json.loads(line) == {
        "sequence": 5, "tick": 100, "time_s": 5.0, "kind": "node_ended", "node": "main/10:drive",
        "payload": {"status": "failure", "reason": "rain"},
    }  # fmt: skip


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("--node", "main/99"), "--node"),
        (("--from", "30", "--to", "3"), "--from, --to"),
        (("--kind", "stone_grasped", "--json"), "--kind"),
    ],
)
def test_a_choice_that_leaves_no_entry_is_told(read, words, named):
    lines, told = read("journal", *words)
    assert lines == []
    assert re.fullmatch(rf"warning: none of the \d+ entries is chosen by {named}", told[-1])


def test_a_kind_that_no_event_has_is_named(read):
    lines, told = read("journal", "--kind", "node_endet", "--kind", "node_ended")
    assert len(lines) == 1
    assert told == ["warning: no event of kind 'node_endet'. Did you mean 'node_ended'?"]


def test_the_tree_is_shown_as_it_was_at_a_time(read):
    lines, told = read("replay", "--at", "2.5")
    started = f"     2.00 s  node_started         {'main/1:scan':<44}  {{}}"
    assert lines == [started, "▶ main", "  ▶ 1:scan"]
    assert told == []


@pytest.mark.parametrize(
    ("options", "kind", "count"), [(("--at", "2"), "node_started", 2), ((), "pause_ended", 5)]
)
def test_the_tree_at_a_time_or_at_the_end_is_given_as_json(read, options, kind, count):
    lines, _ = read("replay", "--json", *options)
    found = json.loads("\n".join(lines))
    assert (found["event"]["kind"], len(found["nodes"])) == (kind, count)
    assert found["nodes"]["main"] == ["running", ""]


def test_before_the_first_event_there_is_none(read):
    lines, _ = read("replay", "--json", "--at", "0.5")
    assert json.loads("\n".join(lines)) == {"event": None, "nodes": {}}


@pytest.mark.parametrize("end", ["q\n", ""])
def test_a_person_steps_through_a_run(read, monkeypatch, end):
    keys = ["", "n", "b", "3", "-2", "@4.5", "N", "-99"]
    typed = "".join(f"{key}\n" for key in keys)
    monkeypatch.setattr(sys, "stdin", io.StringIO(typed + end))
    lines, told = read("replay")
    at = [line.split()[0] for line in lines if line.endswith(" of 7]")]
    assert at == ["[0", "[1", "[2", "[1", "[4", "[2", "[5", "[6", "[0"]
    assert len(told) == 1


@pytest.mark.parametrize("typed", ["what", "@now", "--5", "@", "-"])
def test_a_key_without_a_meaning_shows_the_keys_again(read, monkeypatch, typed):
    monkeypatch.setattr(sys, "stdin", io.StringIO(f"{typed}\nq\n"))
    lines, told = read("replay")
    assert lines == ["[0 of 7]", "before the first event"] * 2
    assert told[0] == told[1]
    assert "NUMBER" in told[0]
