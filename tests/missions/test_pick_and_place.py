"""`executive run pick_and_place` moves all stones onto slots, and what it reports is true."""

import json

import numpy as np
import pytest

pytestmark = pytest.mark.mission

STONES = 3  # the fewest that the drone's map can be registered by
PICK = (
    "grasps_planned",
    "attempt_started",
    "stone_grasped",
    "stone_released",
    "stone_realigned",
)


@pytest.fixture(scope="module")
def finished(tmp_path_factory, command_line, read_run):
    folder = tmp_path_factory.mktemp("pick_and_place") / "run"
    count = ("--set", f"robot.site.stones.count={STONES}")
    answer = command_line("run", "pick_and_place", *count, "--run-dir", str(folder), "--json")
    finished = read_run(folder, answer.status)
    assert json.loads(answer.out) == finished.report
    assert f"{STONES} of {STONES} placed" in answer.err
    return finished


def test_it_ends_with_success(finished):
    assert finished.exit_status == 0
    assert (finished.report["outcome"], finished.report["reason"]) == ("success", "")
    assert finished.journal[-1]["payload"]["outcome"] == "success"


def test_all_stones_are_placed_at_the_first_attempt(finished):
    counts = finished.report["counts"]
    assert (counts["picks"], counts["placed"], counts["first_attempt"]) == (STONES,) * 3
    assert (counts["slips"], counts["drops"], counts["empty"], counts["set_aside"]) == (0, 0, 0, 0)
    assert [pick["placed"] for pick in finished.report["picks"]] == [True] * STONES


def test_the_drones_map_is_registered_and_the_stones_are_known_from_above(finished, command_line):
    assert finished.report["counts"]["registrations_accepted"] == 1
    answer = command_line("objects", str(finished.folder), "--json")
    stones = json.loads(answer.out)["stones"]
    assert [stone["state"] for stone in stones] == ["placed"] * STONES
    assert all(stone["seen_from_above"] for stone in stones)


def test_each_stone_stands_on_a_slot_of_its_own(finished, check_truth):
    assert len({pick["slot"] for pick in finished.report["picks"]}) == STONES
    check_truth(finished, placed=STONES)


def test_the_estimate_was_right_to_centimetres(finished):
    # An RTK fix is good to 1-2 cm; the chassis stands, and only the cabin turns.
    assert finished.report["truth"]["estimate"]["error_m"]["max"] < 0.03


def test_the_grasps_held(finished):
    grasps = finished.report["truth"]["grasps"]
    assert [(grasp["lifted"], grasp["dropped"]) for grasp in grasps] == [(True, False)] * STONES


def test_the_journal_tells_each_pick_in_order(finished):
    stones = [pick["object"] for pick in finished.report["picks"]]
    told = [
        (line["payload"]["stone"], line["kind"])
        for line in finished.events(*PICK)
        if line["payload"].get("accepted", True)
    ]
    assert told == [(stone, step) for stone in stones for step in PICK]


def test_the_largest_stone_that_is_left_comes_next(finished):
    (segmented,) = (event["payload"] for event in finished.events("site_segmented"))
    points = dict(zip(segmented["stones"], segmented["points"], strict=True))
    by_size = sorted(points, key=points.__getitem__, reverse=True)
    assert [pick["object"] for pick in finished.report["picks"]] == by_size


def test_each_stone_is_seen_where_it_was_to_be_placed(finished):
    # A look from the way up may leave a stone in doubt; the scan that follows does not.
    looks = finished.events("stone_realigned")
    seen = [one for one in looks if one["payload"]["accepted"]]
    for realigned, pick in zip(seen, finished.report["picks"], strict=True):
        assert realigned["payload"]["stone"] == pick["object"]
        planned, seen = np.array(pick["planned_pose"]), np.array(pick["estimated_pose"])
        assert np.linalg.norm(seen[:3, 3] - planned[:3, 3]) < 0.30


def test_each_leaf_of_a_pick_says_that_it_succeeded(finished):
    for leaf in ("PlanGrasp", "PlanPick", "CloseGripper", "PlanPlacement", "ReleaseStone"):
        assert finished.endings(leaf) == ["success"] * STONES
