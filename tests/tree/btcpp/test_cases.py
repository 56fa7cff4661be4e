"""The cases after BehaviorTree.CPP's own tests: each as expected, each difference explained."""

import re
from pathlib import Path
from typing import Any

RULES = Path(__file__).parents[3] / "docs" / "node_rules.md"
LEAST_AS_WRITTEN = 150


def test_every_case_plays_as_expected(modules: Any) -> None:
    cases = modules["cases"]
    wrong = {case.case: told for case in cases.all_cases() if (told := cases.failure(case))}
    assert wrong == {}


def test_a_case_that_is_not_as_expected_is_told(modules: Any) -> None:
    cases = modules["cases"]
    wrong = cases.Case("here", "Made.Up", main={"sequence": ["~a", "~b:1f"]}, play=["S a+ a=s"])
    assert cases.failure(wrong) == "step 1: 'R a+ a=s b+' instead of 'S a+ a=s'"


def test_every_other_form_has_its_reason_and_every_difference_is_in_the_table(modules: Any) -> None:
    cases, rules = modules["cases"], RULES.read_text(encoding="utf-8")
    for case in cases.all_cases():
        assert case.form in cases.FORMS, case.case
        assert bool(case.reason) is (case.form != "as written"), case.case
        if case.form == "differs":
            is_listed = re.search(rf"^{case.reason}\. \*\*", rules, re.MULTILINE)
            is_in_table = re.search(rf"^\| `{re.escape(case.reason)}`", rules, re.MULTILINE)
            assert is_listed or is_in_table, case.case


def test_no_case_is_given_twice_and_enough_are_as_written(modules: Any) -> None:
    every = modules["cases"].all_cases()
    assert len({case.case for case in every}) == len(every)
    assert sum(case.form == "as written" for case in every) >= LEAST_AS_WRITTEN
