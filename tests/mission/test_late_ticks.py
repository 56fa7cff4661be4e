"""Late ticks are counted and told with their cause, and too many in a row are an error."""

from dataclasses import asdict

import pytest

from executive.events.mission import TickLate
from executive.machine.machine import load_machine
from executive.mission.event_lines import line_of
from executive.mission.late_ticks import LateTicks, LateTicksError
from executive.mission.tick_times import Share

MACHINE = load_machine("m545")
MAPPING = Share("mapping.add_scan_pair", "", 0.06, 0.05)
PLANNING = Share("leaf", "main/3:PlanPick", 0.4, 0.01)
JOURNAL = Share("journal", "", 0.002, 0.001)


def test_late_ticks_are_counted_in_a_row_and_by_cause():
    late = LateTicks(0.05, 3, MACHINE)
    assert late.add(0.0, [MAPPING]) is None
    event = late.add(0.012, [JOURNAL, MAPPING])
    assert event.payload() == {
        "late_s": 0.012,
        "in_a_row": 1,
        "step": "mapping.add_scan_pair",
        "in_node": "",
        "took_s": 0.06,
        "computed_s": 0.05,
    }
    event = late.add(0.35, [PLANNING, JOURNAL])
    assert (event.in_a_row, event.cause) == (2, "leaf in main/3:PlanPick")
    late.check()
    assert late.add(0.0, [MAPPING]) is None
    assert late.add(0.01, [MAPPING]).in_a_row == 1
    assert asdict(late.as_report()) == {
        "count": 3,
        "worst_s": 0.35,
        "limit": 3,
        "worst_cause": "leaf in main/3:PlanPick",
        "causes": {"mapping.add_scan_pair": 2, "leaf in main/3:PlanPick": 1},
    }


def test_a_loop_that_woke_up_late_is_told_as_that():
    late = LateTicks(0.05, 3, MACHINE)
    event = late.add(0.02, [MAPPING])
    assert event.cause == "mapping.add_scan_pair"  # 0.06 s of 0.07
    event = late.add(0.2, [MAPPING])
    assert (event.cause, event.took_s) == ("wake", 0.19)


def test_too_many_in_a_row_are_an_error_that_names_cause_and_cure():
    late = LateTicks(0.05, 3, MACHINE)
    late.add(0.35, [PLANNING])
    for _ in range(2):
        late.add(0.01, [MAPPING])
    cause = "for leaf in main/3:PlanPick; 2 of 3 for mapping.add_scan_pair"
    with pytest.raises(LateTicksError, match=rf"3 ticks in a row .* {cause}.* loop.late_ticks"):
        late.check()


def test_the_line_for_a_person_says_what_took_the_time_and_how_much_was_computed():
    event = LateTicks(0.05, 3, MACHINE).add(0.35, [PLANNING])
    assert line_of(event) == (
        "warning: a tick was 350 ms late (1 in a row): leaf in main/3:PlanPick took 400 ms, "
        "10 ms of it computed"
    )
    assert line_of(TickLate(0.02, 1)) == "warning: a tick was 20 ms late (1 in a row)"


def test_the_default_is_the_longest_stop_of_the_machine_in_ticks():
    assert LateTicks(0.05, None, MACHINE).limit == 40  # 2 s
    assert LateTicks(0.1, None, MACHINE).limit == 20
