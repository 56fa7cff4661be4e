"""`pick_and_place` holds while a sensor is lost, and goes on when it returns, or ends in a stop.

The lidars are lost in a swing, the IMUs on the way to the stone, and the GNSS while it is carried.
"""

import pytest

pytestmark = pytest.mark.mission

SEED = 7501
LASTS_S = 5.0
IN_SWING = "{{sensor: lidar, how: silent, node: ScanSwing, after: 4 s{}}}"
ON_THE_WAY = "{{sensor: imu, how: silent, node: ExecuteTrajectory, nth: 1, after: 3 s{}}}"
IN_CARRY = "{{sensor: gnss, how: silent, node: ExecuteTrajectory, nth: 2, after: 3 s{}}}"
# What breaks a rule soonest, and latest: the oldest good sample may be one period and a tick older,
# and fixes may be missing for the rule's second.
SOONEST_S, LATEST_S = 0.0, 1.3


@pytest.fixture(scope="module")
def lose(tmp_path_factory, command_line, read_run):
    def run(*faults, settings=()):
        folder = tmp_path_factory.mktemp("lost") / "run"
        words = (
            "robot.site.stones.count=1",
            "grasping.plugin=sampled_antipodal",  # a second a grasp instead of ten
            f"faults=[{', '.join(faults)}]",
            *settings,
        )
        line = [word for setting in words for word in ("--set", setting)]
        seed = ("--seed", str(SEED))
        answer = command_line("run", "pick_and_place", *seed, *line, "--run-dir", str(folder))
        return read_run(folder, answer.status)

    return run


@pytest.fixture(scope="module")
def returned(lose):
    return lose(
        *(fault.format(f", lasts: {LASTS_S:g} s") for fault in (IN_SWING, ON_THE_WAY, IN_CARRY))
    )


@pytest.fixture(scope="module")
def never_returned(lose):
    return lose(IN_CARRY.format(""), settings=("watch.gnss.wait=10 s", "watch.estimate.wait=10 s"))


def test_it_holds_and_goes_on_to_success_when_each_sensor_returns(returned):
    assert (returned.report["outcome"], returned.exit_status) == ("success", 0)
    one = ["fault_injected", "mission_held", "fault_removed", "mission_went_on"]
    assert [line["kind"] for line in returned.events(*one)] == one * 3
    assert [fault["target"] for fault in returned.report["faults"]] == ["lidar", "imu", "gnss"]


def test_it_holds_soon_and_until_the_sensor_is_well(returned):
    injected, held, went_on = (
        returned.events(kind) for kind in ("fault_injected", "mission_held", "mission_went_on")
    )
    for begin, hold, end in zip(injected, held, went_on, strict=True):
        late_s = hold["time_s"] - begin["time_s"]
        assert SOONEST_S <= late_s <= LATEST_S
        # Mission time stands still; the rule wants all to be well for a while before it goes on.
        assert LASTS_S - LATEST_S < end["payload"]["held_s"] < LASTS_S + 10.0


def test_the_stone_is_where_the_report_says(returned, check_truth):
    assert returned.report["counts"]["placed"] == 1
    check_truth(returned, placed=1)


def test_a_sensor_that_never_returns_ends_in_a_safe_stop_and_no_success(never_returned):
    assert (never_returned.report["outcome"], never_returned.exit_status) == ("fault", 3)
    assert "gnss" in never_returned.report["reason"]
    assert never_returned.events("mission_held")
    assert not never_returned.events("mission_went_on")


def test_nothing_is_placed_and_the_stone_stays_in_the_jaws(never_returned):
    assert never_returned.report["counts"]["placed"] == 0
    assert not never_returned.events("stone_released")
    (grasp,) = never_returned.report["truth"]["grasps"]
    assert (grasp["lifted"], grasp["dropped"]) == (True, False)
