"""Late ticks are counted and told, and too many in a row are an error."""

from dataclasses import asdict

import pytest

from executive.machine.machine import load_machine
from executive.mission.late_ticks import LateTicks, LateTicksError

MACHINE = load_machine("m545")


def test_late_ticks_are_counted_in_a_row():
    late = LateTicks(0.05, 3, MACHINE)
    assert late.add(0.0) is None
    event = late.add(0.02)
    assert (event.late_s, event.in_a_row) == (0.02, 1)
    assert late.add(0.4).in_a_row == 2
    late.check()
    assert late.add(0.0) is None
    assert late.add(0.01).in_a_row == 1
    assert asdict(late.as_report()) == {"count": 3, "worst_s": 0.4, "limit": 3}


def test_too_many_in_a_row_are_an_error_that_names_the_cure():
    late = LateTicks(0.05, 3, MACHINE)
    for _ in range(3):
        late.add(0.2)
    with pytest.raises(LateTicksError, match=r"3 ticks in a row .* loop.late_ticks"):
        late.check()


def test_the_default_is_the_longest_stop_of_the_machine_in_ticks():
    assert LateTicks(0.05, None, MACHINE).limit == 40  # 2 s
    assert LateTicks(0.1, None, MACHINE).limit == 20
