"""The shipped `relocate` moves every stone round after round without mapping the site anew."""

from pathlib import Path

import executive_trees
import pytest

pytestmark = pytest.mark.mission

STONES, ROUNDS = 3, 2


@pytest.fixture(scope="module")
def finished(run_mission):
    """Run the shipped file as it stands, with two rounds instead of four."""
    shipped = (Path(executive_trees.__file__).parent / "relocate.yaml").read_text()
    short = shipped.replace("loop: {max: 4}", f"loop: {{max: {ROUNDS}}}")
    assert short != shipped
    return run_mission(f"robot.site.stones.count={STONES}", mission=short)


def test_it_ends_with_success(finished):
    assert (finished.report["outcome"], finished.exit_status) == ("success", 0)


def test_every_stone_is_placed_once_a_round(finished):
    counts = finished.report["counts"]
    assert (counts["picks"], counts["placed"]) == (ROUNDS * STONES, ROUNDS * STONES)
    picked = [pick["object"] for pick in finished.report["picks"]]
    first, second = picked[:STONES], picked[STONES:]
    assert sorted(first) == sorted(second) == sorted(set(picked))


def test_a_round_begins_with_all_stones_that_stand(finished):
    before, again = (event["payload"]["stones"] for event in finished.events("round_begun"))
    assert before == []
    assert sorted(again) == sorted({pick["object"] for pick in finished.report["picks"]})


def test_the_site_is_surveyed_once_and_the_stones_keep_their_names(finished):
    assert len(finished.events("site_surveyed")) == 1
    assert finished.report["counts"]["registrations_accepted"] == 1
    first, *later = (event["payload"]["stones"] for event in finished.events("site_segmented"))
    assert len(later) == ROUNDS
    assert all(sorted(stones) == sorted(first) for stones in later)


def test_every_round_finds_slots_away_from_where_the_stones_stand(finished):
    slots = [event["payload"]["slots"] for event in finished.events("slots_found")]
    assert len(slots) == ROUNDS
    released = [event["payload"] for event in finished.events("stone_released")]
    before = [event["slot_position"][:2] for event in released[:STONES]]
    for x, y in (event["slot_position"][:2] for event in released[STONES:]):
        # Stones are about a metre wide: less than that apart, one would stand where another does.
        assert min((x - a) ** 2 + (y - b) ** 2 for a, b in before) > 1.0


def test_all_stones_stand_on_the_slots_of_the_last_round(finished, check_truth):
    check_truth(finished, placed=STONES)
