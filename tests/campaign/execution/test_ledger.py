"""What is asked for, begun and finished is on the disk, once, and survives whatever happens."""

import shutil
import sqlite3
from dataclasses import replace
from pathlib import Path

import pytest

from executive.campaign.execution.disk_space import DiskFullError
from executive.campaign.execution.folder_lock import FolderInUseError, FolderLock
from executive.campaign.execution.ledger import Ledger, Session, TryState
from executive.campaign.execution.pool import RefusedError
from executive.campaign.trial import Outcome, Status
from executive.errors import DataError


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "results.sqlite"


@pytest.fixture
def ledger(path: Path, trial):
    made = Ledger(path)
    made.begin([trial(number=number, for_s=0.5) for number in range(3)], "digest")
    made.add_session(Session("2026-01-01T00:00:00+00:00", "host:1", "executive …", "0.2", "abc"))
    yield made
    made.close()


def done(number: int, tries: int = 1) -> Outcome:
    answer = {"report": {"outcome": "success", "picks": [1.5, "ü"]}}
    return Outcome(number, Status.DONE, "", answer, 2.5, 1.5, 1 << 33, tries, "host:17")


def test_an_outcome_is_read_back_as_it_was_written(ledger) -> None:
    ledger.claim(1)
    ledger.finish(done(1))
    assert list(ledger.outcomes()) == [done(1)]
    assert ledger.counts() == {Status.DONE: 1}
    assert ledger.done() == [1]


def test_trials_are_read_back_as_they_were_written(ledger, trial) -> None:
    assert list(ledger.trials()) == [trial(number=number, for_s=0.5) for number in range(3)]
    assert ledger.digest == "digest"


def test_arguments_that_many_trials_share_are_written_once(path, trial) -> None:
    mission = "trees: 1\n" * 10_000
    ledger = Ledger(path)
    ledger.begin([trial(number=n, mission=mission + "#" * (n % 2)) for n in range(200)], "digest")
    found = list(ledger.trials())
    ledger.close()
    assert path.stat().st_size < 4 * len(mission)
    assert [one.arguments["mission"][-1] for one in found[:3]] == ["\n", "#", "\n"]


def test_what_is_claimed_or_finished_is_not_pending(ledger) -> None:
    assert ledger.pending() == [0, 1, 2]
    assert ledger.claim(0) == 1
    ledger.claim(2)
    ledger.finish(done(2))
    assert ledger.pending() == [1]
    assert ledger.claims() == [(0, 1)]


def test_a_released_claim_is_pending_and_its_next_try_has_another_number(ledger) -> None:
    ledger.claim(0)
    ledger.release(0, TryState.RELEASED)
    assert ledger.pending() == [0, 1, 2]
    assert ledger.claim(0) == 2


def test_a_second_outcome_of_a_trial_is_refused(ledger) -> None:
    ledger.claim(0)
    ledger.finish(done(0))
    with pytest.raises(sqlite3.IntegrityError):
        ledger.finish(replace(done(0), status=Status.CRASHED))
    assert list(ledger.outcomes()) == [done(0)]


def test_outcomes_of_a_status_are_put_back(ledger) -> None:
    for number, status in enumerate((Status.KILLED, Status.DONE, Status.CRASHED)):
        ledger.claim(number)
        ledger.finish(replace(done(number), status=status))
    assert ledger.put_back(Status.KILLED) == 1
    assert ledger.pending() == [0]
    assert [one.number for one in ledger.outcomes()] == [1, 2]


def test_lost_workers_are_counted_until_the_trial_is_put_back(ledger) -> None:
    for expected in (1, 2):
        ledger.claim(0)
        ledger.release(0, TryState.LOST, "its worker is gone")
        assert ledger.lost(0) == expected
    ledger.claim(0)
    ledger.finish(replace(done(0), status=Status.CRASHED))
    ledger.put_back(Status.CRASHED)
    assert ledger.lost(0) == 0


def test_the_file_alone_holds_everything_when_it_is_closed(ledger, path, tmp_path) -> None:
    ledger.claim(0)
    ledger.finish(done(0))
    ledger.close()
    copied = tmp_path / "elsewhere" / "results.sqlite"
    copied.parent.mkdir()
    shutil.copy(path, copied)
    again = Ledger(copied)
    assert list(again.outcomes()) == [done(0)]
    assert [one.command for one in again.sessions()] == ["executive …"]
    again.close()


def test_a_full_disk_loses_nothing_that_was_written(ledger, path) -> None:
    ledger.claim(0)
    ledger.finish(done(0))
    ledger.claim(1)
    pages = ledger._database.execute("PRAGMA page_count").fetchone()[0]
    ledger._database.execute(f"PRAGMA max_page_count = {pages}")
    large = replace(done(1), answer={"report": [hash((i, "x")) for i in range(20_000)]})
    with pytest.raises(DiskFullError, match=r"results\.sqlite"):
        ledger.finish(large)
    ledger._database.execute("PRAGMA max_page_count = 100000")
    assert list(ledger.outcomes()) == [done(0)]
    assert ledger.claims() == [(1, 1)]
    ledger.finish(large)
    assert ledger.done() == [0, 1]


def test_another_file_is_refused(path) -> None:
    path.write_bytes(b"this is no database" * 100)
    with pytest.raises(DataError, match=r"results\.sqlite"):
        Ledger(path)


def test_a_ledger_of_another_form_is_refused(ledger, path) -> None:
    ledger._database.execute("PRAGMA user_version = 7")
    ledger.close()
    for is_read_only in (True, False):
        with pytest.raises(DataError, match="its tables are of form 7"):
            Ledger(path, is_read_only=is_read_only)


def test_it_is_read_while_it_is_written(ledger, path) -> None:
    ledger.claim(0)
    ledger.finish(done(0))
    reader = Ledger(path, is_read_only=True)
    assert list(reader.outcomes()) == [done(0)]
    ledger.claim(1)
    ledger.finish(done(1))
    assert reader.done() == [0, 1]
    with pytest.raises(DataError, match="readonly"):
        reader.claim(2)
    reader.close()
    assert ledger.pending() == [2]


def test_it_is_read_from_where_nothing_can_be_written(ledger, path, tmp_path) -> None:
    ledger.claim(0)
    ledger.finish(done(0))
    ledger.close()
    before = {one.name: one.read_bytes() for one in tmp_path.iterdir()}
    reader = Ledger(path, is_read_only=True)
    assert list(reader.outcomes()) == [done(0)]
    reader.close()
    assert {one.name: one.read_bytes() for one in tmp_path.iterdir()} == before
    with pytest.raises(DataError, match=r"nowhere\.sqlite"):
        Ledger(tmp_path / "nowhere.sqlite", is_read_only=True)
    assert not (tmp_path / "nowhere.sqlite").exists()


def test_a_folder_has_one_campaign_at_a_time(tmp_path) -> None:
    lock = FolderLock(tmp_path / "campaign.lock")
    with pytest.raises(FolderInUseError, match=r"process \d+ on .*--out"):
        FolderLock(tmp_path / "campaign.lock")
    lock.release()
    FolderLock(tmp_path / "campaign.lock").release()


def test_a_refusal_names_its_trial() -> None:
    refused = RefusedError(3, "no such plugin")
    assert (refused.number, str(refused)) == (3, "no such plugin")
