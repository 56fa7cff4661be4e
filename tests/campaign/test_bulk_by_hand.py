"""Bulk work whose campaign is made up: what is asked for, handed over, and left afterwards."""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from executive.campaign import bulk as bulk_module
from executive.campaign.bulk import Bulk, Result, run_bulk
from executive.campaign.execution.disk_space import DiskFullError
from executive.campaign.execution.folder import CampaignFolder
from executive.campaign.trial import Limits, Outcome, Status

BULK = Bulk("labels", {"physics": "fine"}, (4, 7, 9))


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """Let a campaign end two runs, and then as the pool says: with its error, or well."""
    kept: list[Any] = []

    def run_campaign(campaign: Any, plan: Any, pool: Any, hand_over: Callable[..., None]) -> Any:
        assert not plan.folder.exists()
        kept.append((campaign, plan))
        for number, tries in ((2, 1), (0, 3)):
            run = CampaignFolder(plan.folder).run(number, tries)
            run.mkdir(parents=True)
            (run / "tries").write_text(str(tries))
            ended = (Outcome(number, Status.DONE, answer={}, tries=tries),)
            hand_over(SimpleNamespace(ended=ended))
        if isinstance(pool, Exception):
            raise pool
        return "progress"

    monkeypatch.setattr(bulk_module, "run_campaign", run_campaign)
    return kept


def test_each_run_is_handed_over_with_its_seed_and_the_folder_is_removed(
    asked: list[Any], tmp_path: Path
) -> None:
    scratch, taken = tmp_path / "unfinished", []
    (scratch / "runs" / "0-1").mkdir(parents=True)  # by a process that was killed

    def take(one: Result) -> None:
        taken.append((one.seed, one.outcome.number, (one.folder / "tries").read_text()))

    assert run_bulk(BULK, scratch, SimpleNamespace(), take) == "progress"
    assert taken == [(9, 2, "1"), (4, 0, "3")]
    assert not scratch.exists()
    ((campaign, plan),) = asked
    assert plan.folder == scratch
    assert [(one.number, one.seed, one.work) for one in campaign.trials] == [
        (0, 4, "labels"),
        (1, 7, "labels"),
        (2, 9, "labels"),
    ]
    assert {one.limits for one in campaign.trials} == {Limits(3600.0, 4_294_967_296)}
    assert all(one.arguments == {"physics": "fine"} for one in campaign.trials)


def test_an_error_ends_it_and_what_was_taken_is_kept(asked: list[Any], tmp_path: Path) -> None:
    scratch, taken = tmp_path / "unfinished", []
    with pytest.raises(DiskFullError, match="no space left"):
        run_bulk(BULK, scratch, DiskFullError("no space left"), lambda one: taken.append(one.seed))
    assert taken == [9, 4]
    assert not scratch.exists()
