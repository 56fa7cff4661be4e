"""A dry run, whose robot measures without noise, is not held for samples that repeat at rest."""

from tests.faults.conftest import MISSION

DRY = MISSION.replace(", noise: true", "") + "      - wait: 5 s\n"


def test_a_robot_without_noise_that_has_moved_may_rest(run):
    done = run(text=DRY)
    assert done.report["outcome"] == "success"
    assert not done.of("condition_broken")
