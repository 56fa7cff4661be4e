"""The file of mocks: every mistake has its place and its cure, and what it says is done."""

import pytest

from executive.dry_run.chance import Chance
from executive.dry_run.mock_file import read_mocks
from executive.dry_run.places import places_of
from executive.dry_run.rehearsal import rehearse
from executive.mission.preset_answers import PresetAnswers
from executive.tree.problem import MissionFileError

TREE = """
sequence:
  - run: Look
  - check: Calm
  - ask: Left or right?
    choices: [left, right]
    out: {answer: "{side}"}
  - ask: Sure?
    name: sure
  - fallback:
      - run: Turn
        name: first turn
        timeout: 10 s
      - run: Turn
"""


@pytest.fixture
def rehearsed(mission, mocks):
    """Run the tree dry by a file; return the run."""

    def run(text: str, tree: str = TREE):
        return rehearse(mission(tree), [Chance(1, 0.0)], mocks(text)).runs[0]

    return run


def ends(run):
    return [
        (path.rpartition(":")[2], end)
        for path, end in run.result.ends
        if "Turn" in path or "turn" in path
    ]


SURE = "  Calm: success\n  ask: right\n  sure: success\n"


def test_leaves_and_questions_end_as_the_file_says(rehearsed):
    run = rehearsed(
        f"mocks:\n{SURE}  first turn: {{status: failure, reason: stuck, after: 3 s}}\n"
        "  Turn: {after: 2 s}\n"
        "  Look: {outputs: {count: 7, rock: {mass: 1.2 t, centre_m: [1 m, 20 cm, 0]}}}\n"
        "expect:\n  outcome: success\n  within: 5.2 s\n  keys: {count: 7, side: right}\n"
        '  that: ["{rock.mass} == 1200 kg", "{rock.centre_m[1]} == 0.2 m"]\n'
        "  ends: {first turn: failure}\n  visited: [sure]\n"
    )
    assert run.broken == []
    assert ends(run) == [("first turn", "failure"), ("Turn", "success")]
    assert run.result.ended_s == 5.0


def test_a_leaf_that_does_not_end_is_ended_by_its_timeout(rehearsed):
    run = rehearsed(f"mocks:\n{SURE}  first turn: running\n  Turn: success\n")
    assert ends(run) == [("first turn", "halted"), ("Turn", "success")]
    assert run.result.ended_s >= 10.0


def test_outcomes_are_taken_in_order_and_the_last_one_is_given_again(rehearsed):
    tree = "loop: {max: 4}\ndo:\n  do: {run: Turn}\n  optional: true"
    assert ends(rehearsed("mocks: {Turn: [success, failure]}", tree)) == [
        ("Turn", "success"),
        *[("Turn", "failure")] * 3,
    ]


def test_an_answer_of_a_condition_holds_for_a_time(rehearsed):
    tree = "do: {run: Turn}\nwhile: Calm"
    text = "mocks:\n  Turn: {after: 1 h}\n  Calm: [success, {status: failure, after: 40 min}]\n"
    run = rehearsed(text, tree)
    assert (run.result.outcome, run.result.ended_s) == ("failure", 2400.0)


@pytest.mark.parametrize(
    ("text", "place", "told"),
    [
        ("mocks: {Luck: success}", "2:9", "no leaf and no question 'Luck'; there is: Calm, Look"),
        ("mocks: {Look: sucess}", "2:15", "no status 'sucess' here. Did you mean 'success'?"),
        ("mocks: {Calm: running}", "2:15", "a condition and a question answer at once"),
        ("mocks: {Calm: {after: 3 s}}", "2:23", "holds at once; leave its 'after' out"),
        ("mocks: {sure: {after: 3 s}}", "2:23", "no mission time passes while a person is asked"),
        ("mocks: {ask: rihgt}", "2:14", "no choice 'rihgt'. Did you mean 'right'?"),
        ("mocks: {ask: {status: success}}", "2:14", "takes 'answer': left, right"),
        ("mocks: {Look: {after: 3 kg}}", "2:23", "'kg' is not a unit of time"),
        ("mocks: {Look: {outputs: {cuont: 3}}}", "2:26", "Did you mean 'count'?"),
        ("mocks: {Look: {outputs: {count: many}}}", "2:33", "count is a whole number"),
        ("mocks: {Look: {outputs: {rock: {mass: 3 m}}}}", "2:39", "'m' is not a unit of mass"),
        ("mocks: {Look: {outputs: {rock: 3}}}", "2:32", "give some of its fields"),
        ("mocks: {Look: {outputs: {rock: {wait: 1}}}}", "2:33", "Rock has no field 'wait'"),
        ("mocks: {main/0:Look: success, main/4:fallback: success}", "2:31", "no leaf"),
        ("mocks: []", "2:8", "'mocks' is a mapping, not a list"),
        ("mock: {}", "2:1", "has no 'mock'. Did you mean 'mocks'?"),
        ("expect: {outcome: fail}", "2:19", "no node ends so: 'fail'"),
        ("expect: {visited: [Tern]}", "2:20", "no node 'Tern'. Did you mean 'Turn'?"),
        ('expect: {that: ["{count} >"]}', "2:27", "ends where a value is expected"),
    ],
)
def test_mistakes_have_place_and_cure(mission, mocks, text, place, told):
    places = places_of(mission(TREE))
    with pytest.raises(MissionFileError) as refused:
        read_mocks(mocks(text), places)
    assert f"mocks.yaml:{place}: error" in str(refused.value)
    assert told in str(refused.value)


@pytest.mark.parametrize(
    ("expected", "told"),
    [
        ("outcome: failure", "expected failure, and it ended in success"),
        ("within: 1 s", "expected an end within 1 s, and it took 2 s"),
        ("visited: [main/4:fallback/1:Turn]", "was expected to be ticked, and was not"),
        ("not_visited: [Look]", "main/0:Look was"),
        ("ends: {Look: [failure, success]}", "to end failure, success; got success"),
        ("keys: {side: left}", "key 'side' was expected to be 'left', and is 'right'"),
        ("keys: {sides: left}", "key 'sides' was expected, and was never written"),
        ('that: ["{count} > 8"]', "'{count} > 8' was expected to hold, and is False"),
    ],
)
def test_a_broken_expectation_has_its_place(rehearsed, expected, told):
    leaves = "  Look: {outputs: {count: 7}}\n  Turn: {after: 2 s}\n"
    run = rehearsed(f"mocks:\n{SURE}{leaves}expect:\n  {expected}\n")
    (broken,) = run.broken
    assert "mocks.yaml:9:" in broken
    assert told in broken


def test_an_array_without_a_stated_shape_is_not_made_up(rehearsed):
    tree = 'sequence:\n  - run: Look\n  - check: "{rock.corners[0]} > 0"'
    run = rehearsed("mocks: {Look: success}", tree)
    assert run.result.outcome == "failure"
    assert "'rock.corners' cannot be made up" in run.result.reason
    assert rehearsed("mocks: {Look: {outputs: {rock: {corners: [1]}}}}", tree).broken == []


LISTS = """
sequence:
  - run: Look
  - set: {list: [1, 2.5], word: a}
"""


@pytest.mark.parametrize(
    ("expected", "is_met"),
    [
        ("keys: {list: [1, 2.5]}", True),
        ("keys: {list: [1, 2.6]}", False),
        ("keys: {list: [1]}", False),
        ("keys: {list: 1}", False),
        ("keys: {word: a}", True),
        ("keys: {word: b}", False),
        ("keys: {count: 7.0000000001}", True),
        ("keys: {count: 7.1}", False),
        ('that: ["{count} == 7"]', True),
        ('that: ["{rock.centre_m[0]} > 0"]', True),
    ],
)
def test_lists_texts_and_numbers_are_compared_with_a_tolerance(rehearsed, expected, is_met):
    leaves = "  Look: {outputs: {count: 7, rock: {mass: 1 t, centre_m: [1 m, 2 m, 3 m]}}}\n"
    run = rehearsed(f"mocks:\n{leaves}expect:\n  {expected}\n", LISTS)
    assert (run.broken == []) is is_met


def test_what_cannot_be_computed_is_a_broken_expectation(rehearsed):
    that = '["1 / {count} > 2", "{count} == 0"]'
    text = f"mocks: {{Look: {{outputs: {{count: 0}}}}}}\nexpect:\n  that: {that}\n"
    first, *rest = rehearsed(text, LISTS).broken
    assert "cannot be computed" in first
    assert rest == []


@pytest.mark.parametrize(
    ("preset", "answers"),
    [
        (PresetAnswers(answer=False, choices=("right",)), ("right", "failure")),
        (PresetAnswers(answer=True, choices=("up", "left")), ("left", "success")),
    ],
)
def test_answers_of_the_command_line_are_given(mission, preset, answers):
    tree = """
sequence:
  - ask: Left or right?
    choices: [left, right]
    out: {answer: "{side}"}
  - ask: Sure?
"""
    run = rehearse(mission(tree), [Chance(1, 0.0)], preset=preset).runs[0]
    assert (run.result.store.get("side"), run.result.outcome) == answers


@pytest.mark.parametrize("text", ["- a list\n", "just words\n"])
def test_a_file_of_mocks_is_a_mapping(mission, tmp_path, text):
    path = tmp_path / "mocks.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(MissionFileError, match="a file of mocks is a mapping"):
        read_mocks(path, places_of(mission(TREE)))


def test_a_name_of_leaves_of_several_kinds_is_refused(mission, mocks):
    tree = "sequence:\n  - {run: Turn, name: same}\n  - {check: Calm, name: same}\n"
    with pytest.raises(MissionFileError, match="'same' means leaves of several kinds: main/0:same"):
        read_mocks(mocks("mocks: {same: success}"), places_of(mission(tree)))


def test_a_list_of_outcomes_holds_one_at_least(mission, mocks):
    with pytest.raises(MissionFileError, match="'Turn' takes a list of at least one outcome"):
        read_mocks(mocks("mocks: {Turn: []}"), places_of(mission(TREE)))


def test_several_seeds_are_told_apart(mission, mocks):
    file = mocks("mocks: {Calm: success, ask: left, sure: success}\nexpect: {outcome: failure}\n")
    done = rehearse(mission(TREE), [Chance(1, 0.0), Chance(2, 0.0)], file)
    assert [run.name for run in done.runs] == ["seed 1", "seed 2"]
    assert [run.broken[0].rpartition(" (")[2] for run in done.runs] == ["seed 1)", "seed 2)"]
    assert not done.is_as_expected
