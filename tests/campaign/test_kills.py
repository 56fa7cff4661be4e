"""Kills by signal 9 at random moments: no run is lost, doubled or wrongly counted.

`tests/benchmarks/campaign_engine.py` does the same a hundred times.
"""

import importlib
from pathlib import Path

import numpy as np
import pytest

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"


@pytest.fixture
def engine(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    return importlib.import_module("trials.campaign_engine")


def test_eight_kills_cost_nothing_but_the_runs_that_were_killed(engine, tmp_path: Path) -> None:
    tally = engine.killed_at_random(tmp_path, 8, np.random.default_rng(3), runs=30)
    assert tally.kills.total() == 8
    assert set(tally.kills) == {"campaign", "server", "run"}
    assert (tally.lost, tally.doubled, tally.wrong) == ([], [], [])
    assert tally.statuses.total() == 30
    assert tally.statuses[engine.Status.KILLED] <= tally.kills["run"]
