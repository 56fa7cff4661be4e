"""A campaign ends with one outcome a trial, whatever its runs do and whenever it is stopped."""

import errno
import os
import signal
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from executive.campaign.description.campaign import Campaign
from executive.campaign.engine import Plan, run_campaign
from executive.campaign.execution.disk_space import DiskFullError
from executive.campaign.execution.folder import CampaignFolder
from executive.campaign.execution.ledger import Ledger, Session
from executive.campaign.execution.local_pool import LocalPool
from executive.campaign.execution.pool import Lost, Pool, RefusedError
from executive.campaign.execution.progress import Progress
from executive.campaign.execution.run_answer import RunAnswer, fingerprint, write_answer
from executive.campaign.trial import Outcome, Status, Trial
from executive.errors import ConfigError


class ScriptedPool(Pool):
    """Ends each run as a script says: the last begun first, one a call."""

    def __init__(self, script, slots: int = 2) -> None:
        self._script = script
        self._slots = slots
        self.begun: list[tuple[int, int]] = []
        self._open: list[tuple[Trial, int]] = []
        self.is_closed = False

    @property
    def slots(self) -> int:
        return self._slots

    def begin(self, trial: Trial, folder: Path, tries: int) -> None:
        folder.mkdir(parents=True)
        self.begun.append((trial.number, tries))
        self._open.append((trial, tries))

    def wait(self, timeout_s: float) -> Sequence[Outcome | Lost]:
        return [self._script(*self._open.pop())] if self._open else []

    def close(self) -> None:
        self.is_closed = True


def campaign(trials: Sequence[Trial], digest: str = "digest") -> Campaign:
    return Campaign("test", "", tuple(trials), {}, (), (), (), digest, "executive campaign test")


def done(trial: Trial, tries: int) -> Outcome:
    return Outcome(trial.number, Status.DONE, answer={"n": trial.number}, wall_s=1.0, tries=tries)


@pytest.fixture
def run(tmp_path: Path):
    """Return what runs a campaign in the test's folder."""

    def go(trials, pool, after_change=lambda _: None, **plan) -> Progress:
        digest = plan.pop("digest", "digest")
        return run_campaign(
            campaign(trials, digest), Plan(tmp_path / "out", **plan), pool, after_change
        )

    return go


@pytest.fixture
def outcomes(tmp_path: Path):
    """Return what reads the outcomes by number."""

    def read() -> dict[int, Outcome]:
        ledger = Ledger(CampaignFolder(tmp_path / "out").results)
        found = {one.number: one for one in ledger.outcomes()}
        ledger.close()
        return found

    return read


def stop_after(finished: int):
    """Return what sends Ctrl-C to this process when so many runs have finished."""

    def after_change(progress: Progress) -> None:
        if progress.finished >= finished and not progress.stopped_by:
            os.kill(os.getpid(), signal.SIGINT)

    return after_change


def test_every_trial_has_one_outcome(run, outcomes, trial) -> None:
    pool = ScriptedPool(done)
    end = run([trial(number=n) for n in range(5)], pool)
    assert end.is_complete
    assert end.left_s == 0.0
    assert outcomes() == {n: done(trial(number=n), 1) for n in range(5)}
    assert sorted(pool.begun) == [(n, 1) for n in range(5)]
    assert pool.is_closed


@pytest.mark.usefixtures("misbehaving")
def test_failed_runs_are_counted_with_their_reasons(run, outcomes, trial) -> None:
    behaviours = ["answer", "raises", "kills_itself", "hangs", "segfaults", "answer"]
    trials = [
        trial(one, number=n, time_s=1.0 if one == "hangs" else 60.0)
        for n, one in enumerate(behaviours)
    ]
    end = run(trials, LocalPool(2))
    assert end.is_complete
    assert end.counts == {
        Status.DONE: 2,
        Status.CRASHED: 2,
        Status.KILLED: 1,
        Status.TIMED_OUT: 1,
    }
    assert "the arm is too short" in outcomes()[1].reason


def test_progress_tells_what_runs_and_what_is_left(run, trial) -> None:
    seen: list[Progress] = []
    run([trial(number=n) for n in range(4)], ScriptedPool(done), seen.append)
    assert [one.number for one in seen[0].running] == [0, 1]
    assert seen[0].left_s is None
    assert seen[1].finished == 1
    assert seen[1].left_s == pytest.approx(1.5, abs=0.1)  # three runs of 1 s, two at a time
    assert seen[-1].is_complete


def test_a_lost_worker_costs_a_try_and_the_third_the_trial(run, outcomes, trial) -> None:
    def script(one: Trial, tries: int) -> Outcome | Lost:
        is_lost = one.number == 1 or tries == 1
        return Lost(one.number, "the worker is gone") if is_lost else done(one, tries)

    end = run([trial(number=0), trial(number=1)], ScriptedPool(script))
    assert end.is_complete
    found = outcomes()
    assert found[0].status is Status.DONE
    assert found[0].tries == 2
    assert found[1].status is Status.CRASHED
    assert found[1].tries == 3
    assert "lost 3 times" in found[1].reason


def test_a_person_stops_it_and_it_goes_on_later(run, outcomes, trial) -> None:
    trials = [trial(number=n) for n in range(6)]
    first = ScriptedPool(done)
    end = run(trials, first, stop_after(2))
    assert end.stopped_by == "SIGINT"
    assert not end.is_complete
    finished = outcomes()
    second = ScriptedPool(done)
    end = run(trials, second, is_resumed=True)
    assert end.is_complete
    assert end.resumed == len(finished)
    again = {number for number, _ in second.begun}
    assert again == set(range(6)) - set(finished)
    tries = Counter(number for number, _ in first.begun + second.begun)
    assert all(tries[number] == one.tries for number, one in outcomes().items())


def test_a_finished_campaign_runs_nothing_again(run, outcomes, trial) -> None:
    run([trial()], ScriptedPool(done))
    before = outcomes()
    pool = ScriptedPool(done)
    assert run([trial()], pool, is_resumed=True).is_complete
    assert pool.begun == []
    assert outcomes() == before


def test_results_that_are_there_are_not_continued_unasked(run, outcomes, trial) -> None:
    run([trial()], ScriptedPool(done))
    with pytest.raises(ConfigError, match=r"--resume goes on.*Nothing was changed"):
        run([trial()], ScriptedPool(done))
    assert set(outcomes()) == {0}


def test_a_folder_of_another_campaign_is_refused(run, outcomes, trial) -> None:
    run([trial(), trial(number=1)], ScriptedPool(done))
    with pytest.raises(ConfigError, match=r"has 2 runs, this one has 1.*--out"):
        run([trial()], ScriptedPool(done), is_resumed=True, digest="other")
    other = [trial(), replace(trial(number=1), seed=9)]
    with pytest.raises(ConfigError, match="run 1 has other seed: 2, not 9"):
        run(other, ScriptedPool(done), is_resumed=True, digest="other")
    assert set(outcomes()) == {0, 1}


def test_a_folder_that_is_in_use_is_refused_and_left_alone(run, outcomes, trial) -> None:
    def meanwhile(progress: Progress) -> None:
        if progress.finished == 1:
            with pytest.raises(ConfigError, match=f"process {os.getpid()} on"):
                run([trial(number=n) for n in range(3)], ScriptedPool(done), is_resumed=True)

    assert run([trial(number=n) for n in range(3)], ScriptedPool(done), meanwhile).is_complete
    assert set(outcomes()) == {0, 1, 2}


def test_outcomes_of_a_status_are_run_again_on_request(run, outcomes, trial) -> None:
    def killed(one: Trial, tries: int) -> Outcome:
        return replace(done(one, tries), status=Status.KILLED if one.number else Status.DONE)

    trials = [trial(number=n) for n in range(3)]
    run(trials, ScriptedPool(killed))
    pool = ScriptedPool(done)
    run(trials, pool, is_resumed=True, again=(Status.KILLED,))
    assert sorted(pool.begun) == [(1, 2), (2, 2)]
    assert {one.status for one in outcomes().values()} == {Status.DONE}


@pytest.mark.usefixtures("misbehaving")
def test_refused_arguments_end_the_campaign_and_keep_what_is_finished(run, outcomes, trial) -> None:
    trials = [trial(), trial("is_refused", number=1), trial(number=2, for_s=20.0)]
    with pytest.raises(ConfigError, match="Did you mean 'sampled_cnn'"):
        run(trials, LocalPool(1))
    assert set(outcomes()) == {0}
    with pytest.raises(ConfigError, match="Did you mean"):
        run(trials, LocalPool(1), is_resumed=True)


def test_a_refusal_that_others_of_the_same_arguments_do_not_meet_is_one_failure(
    run, outcomes, trial
) -> None:
    class Refusing(ScriptedPool):
        def wait(self, timeout_s: float) -> Sequence[Outcome | Lost]:
            if self._open and self._open[-1][0].number == 1:
                self._open.pop()
                raise RefusedError(1, "no room for 12 stones")
            return super().wait(timeout_s)

    assert run([trial(number=n) for n in range(3)], Refusing(done, slots=1)).is_complete
    assert outcomes()[1].status is Status.CRASHED
    assert outcomes()[1].reason == "refused: no room for 12 stones"


def test_a_full_disk_ends_it_and_later_it_goes_on(run, outcomes, trial) -> None:
    class Full(ScriptedPool):
        def wait(self, timeout_s: float) -> Sequence[Outcome | Lost]:
            if len(self.begun) > 3:
                raise DiskFullError("no space is left for out")
            return super().wait(timeout_s)

    trials = [trial(number=n) for n in range(6)]
    with pytest.raises(DiskFullError):
        run(trials, Full(done))
    finished = set(outcomes())
    assert finished
    pool = ScriptedPool(done)
    assert run(trials, pool, is_resumed=True).is_complete
    assert {number for number, _ in pool.begun} == set(range(6)) - finished


def test_a_disk_without_room_for_a_runs_folder_ends_it_too(run, trial) -> None:
    class Full(ScriptedPool):
        def begin(self, trial: Trial, folder: Path, tries: int) -> None:
            raise OSError(errno.ENOSPC, "No space left on device")

    with pytest.raises(DiskFullError, match=r"no space is left for .*out"):
        run([trial()], Full(done))
    assert run([trial()], ScriptedPool(done), is_resumed=True).is_complete


def test_runs_without_their_ledger_are_not_written_over(run, trial, tmp_path: Path) -> None:
    run([trial()], ScriptedPool(done))
    CampaignFolder(tmp_path / "out").results.unlink()
    with pytest.raises(ConfigError, match="ledger of their results is gone"):
        run([trial()], ScriptedPool(done), is_resumed=True)


def test_a_complete_answer_of_a_killed_campaign_is_adopted(run, outcomes, trial, tmp_path) -> None:
    folder = CampaignFolder(tmp_path / "out")
    trials = [trial(number=n) for n in range(3)]
    folder.run(0, 1).mkdir(parents=True)
    ledger = Ledger(folder.results)  # as a campaign leaves it that is killed with two runs
    ledger.begin(trials, "digest")
    ledger.add_session(Session("2026-01-01T00:00:00+00:00", "host:1", "", "0.2", "abc"))
    assert (ledger.claim(0), ledger.claim(1)) == (1, 1)
    answer = RunAnswer(fingerprint(trials[0]), {"n": 0}, 2.0, 1.5, 1 << 30, "host:17")
    write_answer(folder.run(0, 1), answer)
    ledger.close()
    pool = ScriptedPool(done)
    end = run(trials, pool, is_resumed=True)
    assert end.is_complete
    assert end.resumed == 1
    assert sorted(pool.begun) == [(1, 2), (2, 1)]
    assert outcomes()[0] == Outcome(
        0, Status.DONE, "", {"n": 0}, 2.0, 1.5, 1 << 30, tries=1, worker="host:17"
    )
