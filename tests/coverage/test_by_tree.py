"""Several calls of one tree count together."""

from executive.coverage.branch import limbs_of
from executive.coverage.by_tree import by_tree
from executive.coverage.coverage import Coverage, CoveredRun
from executive.coverage.text import coverage_text
from executive.dry_run.dry_run import DryOptions, DryRun
from executive.dry_run.places import places_of

TREE = """
sequence:
  - call: outer
  - {call: inner, optional: true, name: again}
"""
TREES = """
  outer:
    sequence: [{wait: 1}, {call: inner}]
  inner:
    sequence: [{check: Holds, if: "1 > 2"}, {wait: 1, timeout: 5}]
"""


def covered(mission):
    made = mission(TREE, TREES)
    coverage = Coverage("small", limbs_of(places_of(made).root))
    result = DryRun(made, DryOptions()).run()
    coverage.add(CoveredRun("one", True, result.outcome, "", 1.0), result.tally)
    return coverage


def test_each_tree_stands_once_and_its_counts_add_up(mission):
    places = covered(mission)
    trees = by_tree(places)
    assert [limb.path for limb in trees.limbs] == [
        "main",
        "main/0:outer",
        "main/1:again",
        "outer/0:sequence",
        "outer/0:sequence/0:wait",
        "outer/0:sequence/1:inner",
        "inner/0:sequence",
        "inner/0:sequence/0:Holds",
        "inner/0:sequence/1:wait",
    ]
    assert sum(places.tally.taken.values()) == sum(trees.tally.taken.values())
    assert sum(places.tally.ticked.values()) == sum(trees.tally.ticked.values())
    assert "2       0       ·       0  inner/0:sequence" in coverage_text(trees)


def test_a_branch_that_one_call_has_taken_is_taken(mission):
    places = covered(mission)
    trees = by_tree(places)
    assert len(trees.branches) < len(places.branches)
    assert "inner/0:sequence/0:Holds@if: left out" not in map(str, trees.never)
    assert "inner/0:sequence/1:wait@timeout: timed out" in map(str, trees.never)


def test_a_path_of_a_tree_names_its_leaves_at_every_call(mission):
    places = places_of(mission(TREE, TREES))
    assert len(places.nodes_called("inner/0:sequence")) == 1  # the other call has another name
    assert len(places.nodes_called("0:sequence/0:Holds")) == 2
