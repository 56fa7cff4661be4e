"""The state machine above the tree allows what makes sense and nothing else."""

import pytest

from executive.mission.phase import Phase, PhaseError, checked_change


def test_a_mission_runs_pauses_and_ends():
    path = [
        Phase.RUNNING,
        Phase.PAUSED,
        Phase.RUNNING,
        Phase.AWAITING_OPERATOR,
        Phase.RUNNING,
        Phase.STOPPING,
        Phase.DONE,
    ]
    now = Phase.IDLE
    for then in path:
        now = checked_change(now, then)
    assert now is Phase.DONE


@pytest.mark.parametrize("last", [Phase.DONE, Phase.FAULTED])
@pytest.mark.parametrize("then", list(Phase))
def test_nothing_follows_the_end(last, then):
    with pytest.raises(PhaseError, match="nothing"):
        checked_change(last, then)


def test_says_what_can_follow():
    with pytest.raises(
        PhaseError, match="stopping cannot become running; it can become done, faulted"
    ):
        checked_change(Phase.STOPPING, Phase.RUNNING)


@pytest.mark.parametrize("phase", [p for p in Phase if p not in (Phase.DONE, Phase.FAULTED)])
def test_every_live_phase_can_fault(phase):
    assert checked_change(phase, Phase.FAULTED) is Phase.FAULTED
