"""A mission notices sick sensors, holds or stops by its rules, and goes on when they are well."""

import pytest

from tests.faults.conftest import MISSION

NOTICES = ("observation_refused", "condition_broken")
AT = "node: ScanSwing, after: 3 s"
# Three periods, and the tick in which the observation is read.
WITHIN_S = {"encoders": 0.1, "imu_cabin": 0.1, "imu_base": 0.1, "gnss_left": 0.25}


def noticed_s(done):
    """Return how long after the fault it was noticed [s]."""
    since_s = done.first("fault_injected")
    times = [at for kind in NOTICES if (at := done.first(kind, since_s)) is not None]
    return min(times) - since_s


def test_a_mission_without_faults_notices_nothing(run):
    done = run()
    assert done.report["outcome"] == "success"
    kinds = {entry.kind for entry in done.entries}
    assert not kinds & {*NOTICES, "mission_held", "fault_injected", "scans_not_fused"}
    assert "faults" not in done.report
    assert "refused_observations" not in done.report


@pytest.mark.parametrize(
    ("sensor", "how"),
    [
        ("encoders", "silent"),
        ("encoders", "wrong"),
        ("imu_cabin", "stuck"),
        ("imu_cabin", "garbage"),
        ("gnss_left", "nan"),
        ("gnss_left", "delayed"),
    ],
)
def test_a_sick_sensor_is_noticed_and_never_ends_in_success_while_it_is_sick(run, sensor, how):
    done = run(f"{{sensor: {sensor}, how: {how}, {AT}}}")
    assert noticed_s(done) <= WITHIN_S[sensor] + 1e-9
    assert done.report["outcome"] == "fault"
    assert done.status == 3
    assert done.report["faults"][0]["target"] == sensor
    assert done.report["faults"][0]["acted"] > 0


@pytest.mark.parametrize("sensor", ["imu_cabin", "gnss"])
def test_it_holds_while_a_sensor_is_lost_and_goes_on_when_it_returns(run, sensor):
    done = run(f"{{sensor: {sensor}, how: silent, {AT}, lasts: 10 s}}")
    assert done.report["outcome"] == "success"
    order = ["fault_injected", "mission_held", "fault_removed", "mission_went_on"]
    assert [entry.kind for entry in done.entries if entry.kind in order] == order
    assert done.first("mission_held") - done.first("fault_injected") <= 1.3  # the rule's `after`
    (hold,) = done.of("mission_went_on")
    assert 8.5 < hold.held_s < 20.0  # mission time stands still meanwhile
    assert hold.moved_m < 0.1
    assert hold.turned_rad < 0.05


def test_stuck_encoders_bring_a_safe_stop(run):
    done = run(f"{{sensor: encoders, how: stuck, {AT}, lasts: 5 s}}")
    assert done.status == 3
    assert "encoders: no good sample" in done.report["reason"]
    assert done.first("faulted") - done.first("fault_injected") <= 0.1


@pytest.mark.parametrize("how", ["float", "multipath", "wrong_fix", "clock_jump", "duplicate"])
def test_bad_fixes_are_refused_with_a_reason_and_counted(run, how):
    done = run(f"{{sensor: gnss, how: {how}, {AT}, lasts: 0.8 s}}")
    assert done.report["outcome"] == "success"  # the estimate stays good for so long
    assert noticed_s(done) <= WITHIN_S["gnss_left"]
    refused = done.report["refused_observations"]
    assert all(reason.startswith("gnss_") for reason in refused)
    assert sum(refused.values()) >= 20


@pytest.mark.parametrize("how", ["sluggish, share: 0.3", "no_pressure"])
def test_an_arm_that_does_not_follow_is_stopped(run, how):
    # The arm without physics changes its speed at once, which its IMU does not feel: the estimate
    # is in doubt before the arm is off its path, and the mission would be held for that.
    watch = ("watch.estimate.after=5 s", "watch.gnss.after=5 s")
    done = run(f"{{actuator: J_TURN, how: {how}, {AT}}}", *watch)
    assert done.status == 3
    assert "J_TURN" in done.report["reason"]
    assert "off its path" in done.report["reason"]
    # The swing begins slowly: a still drive is on its path until the cabin should have moved.
    (shows,) = done.of("fault_shows")
    assert shows.withheld > 0.1  # the declared tracking error
    shows_s = done.first("fault_shows")
    assert done.first("fault_injected") + 0.2 < shows_s  # the declared lag, at the least
    assert -0.05 <= done.first("condition_broken", shows_s - 0.06) - shows_s <= 0.1


WEAK = f"{{actuator: J_TURN, how: sluggish, share: 0.3, {AT}, lasts: 1.5 s}}"
# The estimate is in doubt as well, see above.
FAILS = ("watch.tracking={do: fail, wait: 5 s}", "watch.estimate.after=5 s", "watch.gnss.after=5 s")


def test_a_motion_that_leaves_its_path_fails_and_the_tree_decides(run):
    again = MISSION.replace("- run: ScanSwing\n", "- run: ScanSwing\n        retry: 2\n")
    done = run(WEAK, *FAILS, text=again)
    assert done.report["outcome"] == "success"
    (failed,) = [
        one
        for one in done.of("node_ended")
        if one.status == "failure" and "off its path" in one.reason
    ]
    assert failed.reason.startswith("watched condition 'tracking': J_TURN is 0.1")
    assert not done.of("faulted")
    # Without another attempt the mission fails for the same reason.
    done = run(WEAK, *FAILS)
    assert done.report["outcome"] == "failure"
    assert "watched condition 'tracking': J_TURN" in done.report["reason"]
    assert done.status == 1


def test_where_no_motion_can_fail_the_mission_stops_when_the_wait_is_over(run):
    still = MISSION.split("      - run: ScanSwing")[0] + "      - wait: 10 s\n"
    done = run("", "watch.geofence={do: fail, radius: 2 m, wait: 3 s}", text=still)
    assert done.status == 3
    assert "outside 2.00 m, 3 s after its rule has acted" in done.report["reason"]
    stopped_s = done.first("faulted") - done.first("condition_broken")
    assert stopped_s == pytest.approx(3.0, abs=0.06)


def test_a_fault_of_a_plugin_raises_in_its_verb(run):
    done = run("{plugin: motion, verb: swing, how: raise, at: 0}")
    assert done.status == 3
    assert "motion plugin 'hermite' failed in 'swing'" in done.report["reason"]
    assert "on purpose" in done.report["reason"]


def test_a_verb_that_answers_with_another_type_is_refused(run):
    done = run("{plugin: motion, verb: swing, how: wrong_type, at: 0}")
    assert done.status == 3
    assert "motion" in done.report["reason"]


def test_a_late_verb_is_charged_in_lock_step(run):
    usual, late = (
        run(),
        run("{plugin: motion, verb: swing, how: late, delay: 3 s, at: 0, calls: 1}"),
    )
    assert late.report["outcome"] == "success"
    assert late.report["ended_s"] == pytest.approx(usual.report["ended_s"] + 3.0, abs=0.2)


def test_the_same_seed_gives_the_same_journal_with_faults(run):
    fault = "{sensor: gnss, how: intermittent, share: 0.7, chance: 0.2, lasts: 1 s}"
    first, second = run(fault), run(fault)
    told = [(e.time_s, e.kind, e.event.payload()) for e in first.entries]
    assert told == [(e.time_s, e.kind, e.event.payload()) for e in second.entries]


def test_the_gripper_outside_the_fence_stops_the_mission(run):
    done = run("", "watch.geofence={do: stop, radius: 2 m}")
    assert done.status == 3
    assert "outside 2.00 m" in done.report["reason"]
