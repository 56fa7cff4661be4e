"""What coverage tells: a line for each node, what was never taken, and the share of it."""

import pytest

from executive.coverage.branch import Branch, limbs_of
from executive.coverage.coverage import Coverage, CoveredRun, Tally
from executive.coverage.run_folders import coverage_of
from executive.coverage.sketch import NeverTickedError, Sketch
from executive.coverage.text import coverage_answer, coverage_text
from executive.dry_run.dry_run import DryOptions, DryRun
from executive.dry_run.places import places_of
from executive.errors import ConfigError
from executive.events.mission import PauseEnded

TREE = "fallback:\n  - {check: Holds, if: '1 > 2'}\n  - wait: 1\n  - sequence: [{run: Act}]\n"


@pytest.fixture
def covered(mission):
    """Return what runs of the tree have taken, each dry or not."""

    def cover(*are_dry, tree=TREE):
        made = mission(tree)
        coverage = Coverage("small", limbs_of(places_of(made).root))
        for number, is_dry in enumerate(are_dry):
            result = DryRun(made, DryOptions()).run()
            run = CoveredRun(f"run {number}", is_dry, result.outcome, "", 1.0)
            coverage.add(run, result.tally)
        return coverage

    return cover


def test_each_node_that_was_reached_has_a_line_with_its_counts(covered):
    lines = coverage_text(covered(True, True)).splitlines()
    assert lines[:6] == [
        "success failure skipped  halted  node",
        "      2       ·       ·       0  main",
        "      0       0       ·       0    0:Holds  (left out 2)",
        "      2       ·       ·       0    1:wait",
        "",
        "3 of 9 branches taken by 2 dry runs (33 %)",
    ]


def test_what_was_never_taken_is_listed_unless_it_is_not_asked_for(covered):
    text = coverage_text(covered(True))
    head, _, never = text.partition("never taken:\n")
    assert "branches taken by 1 dry run (" in head
    assert "main/2:sequence: never ticked" in never
    assert "Act" not in never  # it is below what was never ticked
    assert "never taken:" not in coverage_text(covered(True), lists_never=False)


@pytest.mark.parametrize(
    ("are_dry", "told"),
    [
        ((True, True), "taken by 2 dry runs ("),
        ((False,), "taken by 1 run ("),
        ((True, False, False), "taken by 3 runs, 1 of them dry ("),
    ],
)
def test_the_kinds_of_runs_are_told(covered, are_dry, told):
    assert told in coverage_text(covered(*are_dry))


def test_of_many_branches_that_were_never_taken_forty_are_listed(covered):
    def never(count):
        tree = "sequence:\n  - check: Holds\n" + "  - wait: 1\n" * count
        coverage = covered(tree=tree)
        coverage.tally.ticked.update({"main": 1})
        return coverage_text(coverage).partition("never taken:\n")[2].splitlines()

    lines = never(60)
    more = len(never(61)) - len(lines)
    assert more == 0
    assert lines[-1].startswith("  and ")
    assert lines[-1].endswith(" more; --json lists all")
    assert len(lines) == 41
    assert len(never(30)) < 41


def test_programs_get_the_same(covered):
    coverage = covered(True, False)
    answer = coverage_answer(coverage)
    assert [(run["run"], run["dry"]) for run in answer["runs"]] == [
        ("run 0", True),
        ("run 1", False),
    ]
    assert answer["branches"] == answer["taken"] + len(answer["never"])
    assert answer["percent"] == pytest.approx(100 * answer["taken"] / answer["branches"], abs=0.01)
    by_path = {node["path"]: node for node in answer["nodes"]}
    assert by_path["main/1:wait"]["ends"]["success"] == 2
    assert by_path["main/0:Holds"]["effects"] == {"left out": 2}
    assert (by_path["main/2:sequence"]["ticked"], by_path["main"]["ticked"]) == (False, True)


def test_counts_of_runs_add_up():
    one, other = Tally(), Tally()
    branch = Branch("main", "success")
    one.taken[branch] = 2
    other.taken[branch] = 3
    other.ticked["main"] = 1
    one.add(other)
    assert (one.taken[branch], one.ticked["main"]) == (5, 1)


def test_without_a_run_there_is_nothing_to_count():
    with pytest.raises(ConfigError, match="no run is named"):
        coverage_of([])


def test_a_tree_that_is_only_looked_at_does_nothing():
    sketch = Sketch()
    for ask in (
        lambda: sketch.context("main/0", {}),
        lambda: sketch.record("main/0", PauseEnded(0.0)),
        lambda: sketch.ask("main/0", "Go?", None),
        lambda: sketch.fail(ValueError(), "main/0", "Act"),
    ):
        with pytest.raises(NeverTickedError, match="main/0: this tree was built to be looked at"):
            ask()
