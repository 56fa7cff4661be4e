"""A run is read back event by event: which nodes ran at a time, and how the others ended."""

import json

import pytest

from executive.errors import ConfigError
from executive.events.event import UnknownEvent
from executive.events.mission import PauseEnded
from executive.events.node import NodeEnded, NodeResult, NodeStarted
from executive.events.site import SiteScanned
from executive.journal import Entry, Journal
from executive.mission.record.journal_view import Moments, line_for_people, plain_entry, reading


def entries() -> list[Entry]:
    journal = Journal()
    for time_s, node, event in [
        (1.0, "main", NodeStarted()),
        (2.0, "main/scan", NodeStarted()),
        (3.0, "main/scan", SiteScanned(12)),
        (4.0, "main/scan", NodeEnded(NodeResult.FAILURE, "no lidar")),
        (5.0, "main", NodeEnded(NodeResult.SUCCESS, "")),
    ]:
        journal.append(int(20 * time_s), time_s, node, event)
    return list(journal.newest)


def lines(moments: Moments) -> list[str]:
    return list(moments.moment().lines())


def test_before_the_first_event_nothing_runs() -> None:
    assert lines(Moments(iter(entries()))) == ["before the first event"]


def test_a_step_on_shows_what_runs_inside_what() -> None:
    moments = Moments(iter(entries()))
    moments.step(2)
    assert lines(moments)[1:] == ["▶ main", "  ▶ scan"]
    moments.step(-1)
    assert lines(moments)[1:] == ["▶ main"]


def test_a_node_that_ends_tells_why_and_runs_no_longer() -> None:
    moments = Moments(iter(entries()))
    moments.step(4)
    assert lines(moments)[1:] == ["▶ main", "  failure: no lidar"]
    moments.step(1)
    assert lines(moments)[1:] == []


def test_steps_end_at_both_ends() -> None:
    moments = Moments(iter(entries()))
    moments.step(99)
    assert moments.at == len(moments) == 5
    moments.step(-99)
    assert moments.at == 0


@pytest.mark.parametrize(("time_s", "at"), [(0.5, 0), (1.0, 1), (2.9, 2), (3.0, 3), (9.0, 5)])
def test_a_time_is_that_of_the_last_event_until_then(time_s: float, at: int) -> None:
    moments = Moments(iter(entries()))
    moments.go_to(time_s)
    assert moments.at == at


def test_a_line_for_people_has_the_time_the_kind_and_the_words() -> None:
    scanned = entries()[2]
    words = "3.00 s site_scanned main/scan map of 12 points"
    assert " ".join(line_for_people(scanned).split()) == words
    journal = Journal()
    journal.append(1, 1.0, "main", PauseEnded(3.5))  # which has no words of its own
    (wordless,) = journal.newest
    assert line_for_people(wordless).endswith(json.dumps({"machine_s": 3.5}))


@pytest.mark.parametrize(
    ("path", "shown"),
    [
        ("main/4:relocate_all/2:loop/0:sequence/1:PlanPick", "…/2:loop/0:sequence/1:PlanPick"),
        (
            "main/0:relocate_all/1:move_stone/22:PlanGrasps",
            "…/0:relocate_all/1:move_stone/22:PlanGrasps",
        ),
        (
            "main/0:relocate/1:move_stone/2:PlanPlacement",
            "main/0:relocate/1:move_stone/2:PlanPlacement",
        ),
        ("m" * 60, f"…/{'m' * 60}"),  # one name is not cut
    ],
)
def test_of_a_long_path_the_end_is_shown_and_what_happened_is_not_cut_off(
    path: str, shown: str
) -> None:
    journal = Journal()
    journal.append(2, 1.0, path, PauseEnded(3.5))
    (entry,) = journal.newest
    words = line_for_people(entry).split()
    assert words[3] == shown
    assert words[4:] == ['{"machine_s":', "3.5}"]
    assert len(line_for_people(entry, 60)) == 60
    assert line_for_people(entry, 60).endswith("…")
    assert line_for_people(entry, 500) == line_for_people(entry)


def test_an_entry_is_plain_data() -> None:
    scanned = plain_entry(entries()[2])
    assert scanned.pop("payload")["points"] == 12
    assert scanned == {
        "sequence": entries()[2].sequence,
        "tick": 60,
        "time_s": 3.0,
        "kind": "site_scanned",
        "node": "main/scan",
    }


def test_a_folder_without_a_run_is_told(tmp_path) -> None:
    with pytest.raises(ConfigError, match="holds no run"), reading(tmp_path):
        pytest.fail("it is read")


def test_words_of_any_language_are_shown_as_they_are() -> None:
    journal = Journal()
    journal.append(0, 1.0, "main/Hügel", NodeEnded(NodeResult.FAILURE, "für die Prüfung"))
    journal.append(1, 2.0, "main", UnknownEvent("odd", {"told": "für"}))
    ended, odd = (line_for_people(entry) for entry in journal.newest)
    assert "main/Hügel" in ended
    assert "für die Prüfung" in ended
    assert odd.endswith('{"told": "für"}')
