"""How the nodes of a tree can end, and what their modifiers can do."""

import json

import pytest

from executive.coverage.branch import limbs_of
from executive.coverage.coverage import Coverage, CoveredRun
from executive.coverage.text import coverage_answer, coverage_text
from executive.dry_run.chance import Chance
from executive.dry_run.dry_run import DryOptions, DryRun
from executive.dry_run.places import places_of

WAIT, ACT, CHECK = {"wait": 1}, {"run": "Act"}, {"check": "Holds"}
EACH = {"for_each": {"item": "x", "in": "{q}"}, "do": WAIT}
S, F, LEFT_OUT = "success", "failure", "skipped"


@pytest.mark.parametrize(
    ("tree", "ends"),
    [
        (ACT, {S, F}),
        (WAIT, {S}),
        ({"set": {"a": 1}}, {S}),
        ({"ask": "Go on?"}, {S, F}),
        ({"ask": "Where?", "choices": ["a", "b"]}, {S}),
        ({"sequence": [WAIT, WAIT]}, {S}),
        ({"sequence": [WAIT, ACT]}, {S, F}),
        ({"fallback": [ACT, WAIT]}, {S}),
        ({"fallback": [ACT, CHECK]}, {S, F}),
        ({"reactive_fallback": [CHECK, WAIT]}, {S}),
        ({"sequence": [{**WAIT, "if": "Holds"}]}, {S, LEFT_OUT}),
        ({"sequence": [{**WAIT, "if": "Holds"}, WAIT]}, {S}),
        ({"not": WAIT}, {F}),
        ({"force_failure": ACT}, {F}),
        ({"if": "Holds", "then": WAIT}, {S, LEFT_OUT}),
        ({"if": "Holds", "then": WAIT, "else": ACT}, {S, F}),
        ({"loop": {"max": 3}, "do": WAIT}, {S}),
        ({"loop": {"max": 3, "until": "Holds"}, "do": WAIT}, {S, F}),
        ({"loop": "forever", "do": ACT}, {F}),
        ({"parallel": [ACT, WAIT], "succeed": 1}, {S}),
        ({"parallel": [ACT, WAIT]}, {S, F}),
        (
            {
                "sequence": [
                    {"set": {"q": [1]}},
                    {"for_each": {"item": "x", "in": "{q}"}, "do": WAIT},
                ]
            },
            {S},
        ),
        ({"sequence": [{"do": {"run": "Act"}, "optional": True}]}, {S}),
        ({"sequence": [{**WAIT, "timeout": 3}]}, {S, F}),
        ({"sequence": [{**CHECK, "timeout": 3, "optional": True}]}, {S}),
    ],
)
def test_the_root_can_end_so_and_not_otherwise(branches, tree, ends):
    found = {one.removeprefix("main: ") for one in branches(json.dumps(tree)) if "main: " in one}
    assert found == ends


def test_a_modifier_is_a_branch_where_it_can_do_something(branches):
    found = branches(
        """
sequence:
  - optional: true
    do: {run: Act, timeout: 3, retry: 2, if: Holds}
  - {do: {wait: 1, retry: 2}, optional: true, while: Holds}
  - {check: Holds, timeout: 3}
"""
    )
    effects = {one for one in found if "@" in one}
    assert effects == {
        "main/0:do/0:Act@timeout: timed out",
        "main/0:do/0:Act@retry: retried",
        "main/0:do/0:Act@if: left out",
        "main/0:do@optional: excused",
        "main/1:do@while: forbidden",
    }


TREE = """
fallback:
  - sequence: [{check: Holds}, {run: Act}]
  - {run: Act, timeout: 20, name: second}
"""


def test_runs_add_up_until_every_branch_is_taken(mission):
    made = mission(TREE)
    coverage, shares = Coverage("small", limbs_of(places_of(made).root)), []
    for seed in range(40):
        result = DryRun(made, DryOptions(Chance(seed, 0.5))).run()
        run = CoveredRun(f"seed {seed}", True, result.outcome, result.reason, result.ended_s)
        coverage.add(run, result.tally)
        shares.append(coverage.percent)
    assert shares == sorted(shares)
    assert 0 < shares[0] < shares[-1] == 100.0
    assert coverage.never == []
    assert "11 of 11 branches taken by 40 dry runs (100 %)" in coverage_text(coverage)


def test_what_no_run_has_taken_is_listed_once(mission):
    made = mission("fallback:\n  - wait: 1\n  - sequence: [{run: Act}, {run: Act}]")
    coverage = Coverage("small", limbs_of(places_of(made).root))
    result = DryRun(made, DryOptions()).run()
    coverage.add(CoveredRun("one", True, result.outcome, "", 1.0), result.tally)
    text = coverage_text(coverage)
    assert "main/1:sequence: never ticked" in text
    assert "main/1:sequence/0:Act" not in text  # it lies below
    never = coverage_answer(coverage)["never"]
    assert {"path": "main/1:sequence/0:Act", "what": "failure"} in never
    assert coverage_answer(coverage)["percent"] == 25.0
