"""Progress of a campaign says what it waits for."""

import pytest

from executive.campaign.execution.progress import Progress, RunningTrial
from executive.campaign.trial import Limits, Trial
from executive.commands.campaigns.progress import PlainLines

TRIALS = [Trial(0, "mission", {}, 1, {}, Limits(1.0, 1))]


def test_a_cluster_without_workers_is_told_once(capsys: pytest.CaptureFixture[str]) -> None:
    nothing = Progress(total=1, counts={}, running=(), left_s=None)
    running = Progress(total=1, counts={}, running=(RunningTrial(0, 0.1),), left_s=None)
    lines = PlainLines(TRIALS)
    for progress in (nothing, nothing, running, running, nothing):
        lines(progress)
    assert capsys.readouterr().err == "waiting for a worker\n" * 2
