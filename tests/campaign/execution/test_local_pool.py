"""Processes of this computer as a pool: what ended beside a refused run is not lost."""

from collections.abc import Callable
from pathlib import Path

import pytest

from executive.campaign.execution.local_pool import LocalPool
from executive.campaign.execution.pool import RefusedError
from executive.campaign.trial import Outcome, Status, Trial
from executive.clock import wall_s


def collect(pool: LocalPool, ended: list[object], until_s: float) -> None:
    """Add what ends to a list, until the pool raises."""
    while wall_s() < until_s:
        ended += pool.wait(1.0)


@pytest.mark.usefixtures("misbehaving")
def test_what_ended_beside_a_refused_run_is_handed_over_and_then_the_refusal(
    trial: Callable[..., Trial], tmp_path: Path
) -> None:
    pool = LocalPool(2)
    try:
        refused, done = trial("is_refused", number=0), trial(number=1)
        for one in (refused, done):
            pool.begin(one, tmp_path / str(one.number), tries=1)
        until_s = wall_s() + 60.0
        while not (tmp_path / "1" / "answer.json").exists() and wall_s() < until_s:
            pool._isolation.wait(0.1)
        pool._isolation.wait(1.0)  # for the ends of both processes
        ended: list[object] = []
        with pytest.raises(RefusedError, match="Did you mean"):
            collect(pool, ended, until_s)
        ended += pool.wait(1.0)
        assert [(one.number, one.status) for one in ended if isinstance(one, Outcome)] == [
            (1, Status.DONE)
        ]
        assert pool._begun == []
    finally:
        pool.close()
