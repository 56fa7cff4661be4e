"""A fault is told in one line: component, verb, error and place, as far as they are known."""

import pytest

from executive.events.mission import Fault


@pytest.mark.parametrize(
    ("verb", "place", "told"),
    [
        ("segment", "a.py:3", "behaviour 'Scan' failed in 'segment': no points (a.py:3)"),
        ("segment", "", "behaviour 'Scan' failed in 'segment': no points"),
        ("", "a.py:3", "behaviour 'Scan' failed: no points (a.py:3)"),
        ("", "", "behaviour 'Scan' failed: no points"),
    ],
)
def test_what_is_known_of_a_fault_is_told_in_one_line(verb, place, told):
    fault = Fault("behaviour 'Scan'", "", "Scan", verb, "main", "no points", place, "")
    assert fault.summary == told
