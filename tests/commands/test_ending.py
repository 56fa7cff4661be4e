"""What is told at the end of a campaign of its runs."""

import pytest

from executive.campaign.reporting.summary import Runs
from executive.commands.campaigns.ending import _runs, _shortened


@pytest.mark.parametrize(
    ("without_answer", "not_successful", "told"),
    [
        (0, 0, "7 of 10 runs ended"),
        (0, 2, "7 of 10 runs ended; 2 without success, 0 without an answer "),
        (1, 0, "8 of 10 runs ended; 0 without success, 1 without an answer "),
        (1, 2, "8 of 10 runs ended; 2 without success, 1 without an answer "),
    ],
)
def test_runs_without_success_or_answer_are_told_where_there_are_any(
    without_answer, not_successful, told
):
    words = _runs(Runs(10, 7, without_answer, not_successful))
    assert words.startswith(told)
    assert ("both count as failed" in words) == bool(without_answer or not_successful)


def test_of_more_than_forty_lines_the_rest_is_left_to_the_report():
    lines = [str(i) for i in range(42)]
    assert _shortened(lines[:40]) == lines[:40]
    assert _shortened(lines[:41]) == [*lines[:40], "  … and 1 more, in the report"]
    assert _shortened(lines) == [*lines[:40], "  … and 2 more, in the report"]
