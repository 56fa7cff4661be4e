"""A run that was cut off is read from its folder, and its mission goes on after it."""

from types import SimpleNamespace

import pytest

from executive.errors import ConfigError
from executive.events.mission import MissionEnded, PauseEnded
from executive.events.node import LeafAnswered, LeafCalled, NodeEnded, NodeResult, NodeStarted
from executive.journal import Journal, read_journal
from executive.mission.record.account import Account
from executive.mission.record.keeper import Instant
from executive.mission.record.resumption import PastClock, Resumption
from executive.mission.run_folder import RunFolder
from executive.tree.modifiers import IfNode, RetryNode

LEAF, OTHER, THIRD = "main/0:swing", "main/1:scan", "main/2:drive"


@pytest.fixture
def folder(tmp_path):
    return RunFolder(tmp_path)


def write(folder, *entries, torn=b""):
    """Write a journal of entries: tick, node, event, at 0.1 s a tick, and a torn last line."""
    journal = Journal(folder.journal)
    for tick, node, event in entries:
        journal.append(tick, tick * 0.1, node, event)
    with folder.journal.open("ab") as file:
        file.write(torn)
    return Resumption.read(folder)


STORY = [(1, "main", NodeStarted()), (2, LEAF, LeafCalled({})), (7, LEAF, NodeStarted())]


def test_a_torn_last_line_is_taken_out_and_the_journal_goes_on_after_the_one_before(folder):
    found = write(folder, *STORY, torn=b'{"sequence": 3')
    assert found.cut_off_bytes == 14
    account, journal = Account(), Journal(folder.journal)
    found.write_after(journal, account)
    assert (account.last.kind, account.last.tick) == ("node_started", 7)
    journal.append(8, 0.8, "", PauseEnded(1.0))
    lines = [(e.sequence, e.tick, e.kind) for e in read_journal(folder.journal)]
    assert lines == [
        (0, 1, "node_started"), (1, 2, "leaf_called"), (2, 7, "node_started"),
        (3, 8, "pause_ended"),
    ]  # fmt: skip


def test_a_journal_without_a_line_is_a_past_without_an_end(folder):
    found = write(folder, torn=b"{")
    account, journal = Account(), Journal()
    found.write_after(journal, account)
    assert (found.cut_off_bytes, account.last, journal.length) == (1, None, 0)
    assert folder.journal.read_bytes() == b""
    assert found.instant(None, 0.1) == Instant(1, 0.1, 0.1)
    kept = Instant(0, 0.0, 2.0)  # the machine's clock ran for 2 s before the mission began
    assert found.instant(kept, 0.1) is kept


def test_a_mission_that_has_ended_is_not_resumed(folder):
    told = r"the mission has ended \(stopped\); there is nothing to resume"
    with pytest.raises(ConfigError, match=told):
        write(folder, *STORY, (9, "", MissionEnded("stopped", "by the operator")))


@pytest.mark.parametrize(
    ("kept", "instant"),
    [
        (None, (8, 0.8, 0.8)),
        (Instant(6, 0.6, 3.6), (8, 0.8, 3.8)),  # the pauses before it took 3 s
        (Instant(7, 0.7, 3.7), (7, 0.7, 3.7)),
        (Instant(9, 0.9, 3.9), (9, 0.9, 3.9)),
    ],
)
def test_the_mission_goes_on_where_the_machine_was_kept_and_not_before_its_journals_end(
    folder, kept, instant
):
    found = write(folder, *STORY).instant(kept, 0.1)
    assert (found.tick, found.mission_s, found.machine_s) == pytest.approx(instant, rel=1e-12)


def test_what_is_told_of_a_resumption_names_what_was_under_way(folder):
    calls = [(n, node, LeafCalled({})) for n, node in enumerate((OTHER, LEAF, THIRD, "main/3"))]
    ends = [
        (5, THIRD, LeafAnswered(True, "")), (5, "main/3", LeafAnswered(True, "")),
        (6, "main/4", NodeEnded(NodeResult.SUCCESS, "")), (6, THIRD, LeafCalled({})),
        (6, THIRD, NodeEnded(NodeResult.HALTED, "")),
    ]  # fmt: skip
    found = write(folder, *calls, *ends, torn=b"{}")
    assert found.event(("mapping",), ("estimation", "robot")).payload() == {
        "lines": 9, "cut_off_bytes": 2, "restored": ["mapping"],
        "not_restored": ["estimation", "robot"], "under_way": [LEAF, OTHER],
    }  # fmt: skip


def node(kind, *, is_repeated):
    made = object.__new__(kind)
    made.is_repeated = is_repeated
    return made


@pytest.mark.parametrize(
    ("kind", "is_repeated", "ticks"),
    [
        (RetryNode, True, [1, 2, 3, 4]),
        (RetryNode, False, [1, 4]),
        (IfNode, True, [1, 4]),
    ],
)
def test_silent_ticks_are_gone_through_where_a_node_that_is_ticked_anew_counts(
    folder, kind, is_repeated, ticks
):
    past = {1: ("main", NodeStarted()), 4: (LEAF, LeafCalled({})), 7: (LEAF, NodeStarted())}
    resumption = write(folder, *((tick, *told) for tick, told in past.items()))
    begun, ticked = [], []

    def tick_once():
        ticked.append(resumption.history.tick)
        if ticked[-1] in past:
            resumption.history.compare(*past[ticked[-1]])

    nodes = [node(IfNode, is_repeated=False), node(kind, is_repeated=is_repeated)]
    root = SimpleNamespace(iterate=lambda: iter(nodes), tick_once=tick_once)
    resumption.follow(root, SimpleNamespace(begin_tick=begun.append))
    assert ticked == begun == ticks
    assert resumption.history.tick == 7  # in which the run was cut off


def test_the_clock_of_the_past_shows_the_time_of_the_tick_that_is_followed():
    history = SimpleNamespace(time_s=3.5)
    clock = PastClock(history)
    assert (clock.now_s(), clock.machine_s(), clock.advance(0.1)) == (3.5, 3.5, 0.0)
    clock.go_on_at(9, 0.1, 0.9, 0.9)
    clock.idle()
    history.time_s = 3.6
    assert (clock.now_s(), clock.machine_s()) == (3.6, 3.6)
