"""Outcomes that a file gives a leaf are taken in order; answers of a condition hold for a time."""

import pytest

from executive.dry_run.script import MockedOutcome, MockedStatus, Outcomes, Script

YES, NO = MockedOutcome(), MockedOutcome(MockedStatus.FAILURE)
EPSILON_S = 1e-9


def later(status, after_s):
    return MockedOutcome(status, after_s)


def test_an_outcome_is_a_success_at_once_unless_more_is_said():
    assert MockedOutcome(MockedStatus.SUCCESS, None, "", False, {}, "") == YES


def test_outcomes_are_taken_in_order_and_the_last_one_again_and_again():
    outcomes = Outcomes((NO, YES))
    assert [outcomes.take() for _ in range(4)] == [NO, YES, YES, YES]


def test_an_answer_holds_until_the_next_one_is_due():
    then = later(MockedStatus.FAILURE, 3.0)
    outcomes = Outcomes((YES, then))
    assert outcomes.answer(10.0, EPSILON_S) == (YES, 13.0)
    assert outcomes.answer(12.9, EPSILON_S) == (YES, 13.0)
    assert outcomes.answer(13.0, EPSILON_S) == (then, None)
    assert outcomes.answer(99.0, EPSILON_S) == (then, None)


def test_an_answer_that_is_due_within_the_rounding_of_the_clock_is_given():
    then = later(MockedStatus.FAILURE, 3.0)
    outcomes = Outcomes((YES, then))
    outcomes.answer(0.0, EPSILON_S)
    assert outcomes.answer(3.0 - 0.5 * EPSILON_S, EPSILON_S) == (then, None)


def test_answers_that_are_over_are_passed_over_from_when_each_was_due():
    second, third = later(MockedStatus.FAILURE, 3.0), later(MockedStatus.SUCCESS, 2.0)
    outcomes = Outcomes((YES, second, third, later(MockedStatus.FAILURE, 10.0)))
    outcomes.answer(0.0, EPSILON_S)
    assert outcomes.answer(6.0, EPSILON_S) == (third, 15.0)


def test_an_answer_without_a_time_holds_for_one_asking():
    outcomes = Outcomes((YES, NO, later(MockedStatus.SUCCESS, 4.0)))
    assert outcomes.answer(1.0, EPSILON_S) == (YES, 1.0)
    assert outcomes.answer(2.0, EPSILON_S) == (NO, 6.0)
    assert outcomes.answer(5.9, EPSILON_S)[0] == NO
    assert outcomes.answer(6.0, EPSILON_S)[0].after_s == 4.0


def test_leaves_that_one_entry_names_share_its_outcomes():
    script = Script({"main/0": ("Look", (NO, YES)), "main/1": ("Look", (NO, YES)),
                     "main/2": ("Turn", (NO, YES))})  # fmt: skip
    outcomes = script.begin()
    assert [outcomes[path].take() for path in ("main/0", "main/1", "main/2")] == [NO, YES, NO]
    again = script.begin()
    assert again["main/0"].take() == NO
    assert Script().begin() == {}


@pytest.mark.parametrize("status", ["success", "failure", "running"])
def test_a_file_writes_how_a_leaf_ends(status):
    assert MockedStatus(status).name == status.upper()
