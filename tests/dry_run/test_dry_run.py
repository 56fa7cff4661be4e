"""Dry runs: idle ticks are passed over, leaves end as told or drawn, and no plugin is called."""

import json

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from executive.coverage.branch import limbs_of
from executive.dry_run import dry_run
from executive.dry_run.chance import Chance
from executive.dry_run.dry_run import DryOptions, DryRun
from executive.dry_run.places import places_of
from executive.journal import Journal


def run(mission, seed=1, failures=0.1, **options):
    """Run dry; return the result and the entries of the journal."""
    journal, entries = Journal(), []
    journal.follow(entries.append)
    result = DryRun(mission, DryOptions(Chance(seed, failures), **options), journal).run()
    return result, [(e.tick, e.time_s, e.node, e.kind, e.event.payload()) for e in entries]


def test_an_hour_takes_no_more_ticks_than_something_happens(mission):
    ticks = []
    made = mission("sequence:\n  - wait: 1 h\n  - parallel: [{wait: 20 min}, {run: Turn}]")
    dry = DryRun(made, DryOptions(Chance(1, 0.0)))
    compute = dry._end_after
    dry._end_after = lambda tick: (ticks.append(tick), compute(tick))[1]
    result = dry.run()
    assert (result.outcome, result.ended_s) == ("success", 4800.0)
    assert len(ticks) <= 10


def test_equal_seeds_give_equal_runs_and_others_do_not(mission):
    made = mission("loop: {max: 5}\ndo:\n  sequence: [{run: Look}, {check: Calm}]")
    assert run(made, 3)[1] == run(made, 3)[1]
    assert run(made, 3)[1] != run(made, 4)[1]


def test_a_key_that_is_written_too_late_fails_as_in_a_real_run(mission):
    made = mission(
        "sequence:\n  - do: {run: Look}\n    optional: true\n  - run: Turn\n"
        '    in: {rock: "{rock}"}\n  - check: "{count} >= 0"'
    )
    result, _ = run(made, failures=1.0)
    assert result.outcome == "failure"


def test_a_leaf_below_a_timeout_can_hang_and_then_the_timeout_passes(mission):
    made = mission("run: Turn\ntimeout: 100 s")
    reasons = {run(made, seed, failures=1.0)[0].reason for seed in range(20)}
    assert reasons == {"not done within 100 s", "Turn fails, as the seed has it"}


def test_a_tree_that_never_ends_ends_at_the_time_limit_and_says_what_ran(mission):
    made = mission("loop: forever\ndo: {wait: 10 min}", head="loop: {time_limit: 1 h}\n")
    result, _ = run(made)
    assert (result.outcome, result.ended_s) == ("failure", 3600.0)
    assert "the time limit of 3600 s has passed" in result.reason


def test_a_loop_without_time_is_ended_and_told(mission, monkeypatch):
    monkeypatch.setattr(dry_run, "_MOST_ENTRIES", 3000)
    result, _ = run(mission("loop: forever\ndo: {set: {a: 1}}"))
    assert "a loop that takes no time" in result.reason


def test_a_question_with_choices_is_answered_by_the_seed_with_each_of_them(mission):
    made = mission(
        "sequence:\n  - ask: Which way?\n    choices: [left, ahead, right]\n"
        '    out: {answer: "{way}"}'
    )
    answers = []
    for seed in range(30):
        result, _ = run(made, seed, failures=0.0)
        assert result.outcome == "success"
        answers.append(result.store.get("way"))
    assert {*answers} == {"left", "ahead", "right"}
    again = [run(made, seed, failures=0.0)[0].store.get("way") for seed in range(30)]
    assert again == answers


def test_a_question_of_yes_or_no_fails_where_the_seed_answers_no(mission):
    made = mission("ask: Go on?")
    outcomes = [run(made, seed, failures=0.0)[0].outcome for seed in range(20)]
    assert {*outcomes} == {"success", "failure"}


def test_what_is_made_up_and_what_is_read_of_it_is_told(mission):
    made = mission(
        'sequence:\n  - run: Look\n  - check: "{rock.mass} >= 0 kg and {rock.centre_m[2]} < 9 m"'
    )
    result, _ = run(made, failures=0.0)
    assert result.outcome == "success"
    assert {"rock", "count", "rock.mass_kg", "rock.centre_m"} == {*result.made_up}
    assert 100.0 <= result.made_up["rock.mass_kg"] <= 2000.0
    assert repr(result.made_up["rock"]) == "Rock (made up)"


leaf = st.sampled_from(
    [{"run": "Turn"}, {"run": "Look"}, {"check": "Calm"}, {"check": "Seen"}, {"wait": 3.3}]
)
condition = st.sampled_from(["Calm", {"not": "Calm"}, {"any": ["Calm", {"not": "Seen"}]}])


def composites(node):
    nodes = st.lists(node, min_size=1, max_size=3)
    kinds = ["sequence", "fallback", "reactive_sequence", "reactive_fallback", "parallel"]
    wait = {"attempts": 3, "pause": 1.7}
    return st.one_of(
        st.builds(lambda n, kind: {kind: n}, nodes, st.sampled_from(kinds)),
        st.builds(lambda n, c: {"if": c, "then": n, "else": {"wait": 7}}, node, condition),
        st.builds(lambda n, c: {"while": c, "do": n, "else": {"wait": 7}}, node, condition),
        st.builds(lambda n, c: {"loop": {"until": c, "max": 30}, "do": n}, node, condition),
        st.builds(lambda n: {"loop": {"max": 1100}, "do": {"do": n, "optional": True}}, leaf),
        st.builds(lambda n: {"do": n, "timeout": 6}, node),
        st.builds(lambda n, c: {"do": n, "while": c}, node, condition),
        st.builds(lambda n: {"do": n, "retry": wait}, node),
        st.builds(
            lambda n: {"sequence": [{"set": {"k": 0}}, {"reactive_sequence": [count(), n]}]}, node
        ),
    )


def count():
    return {"sequence": [{"set": {"k": "{k} + 1"}}, {"check": "{k} < 100"}]}


trees = st.recursive(leaf, composites, max_leaves=6)


@settings(
    max_examples=25,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(tree=trees, seed=st.integers(0, 99))
def test_passing_over_idle_ticks_changes_nothing(mission, tree, seed):
    made = mission(json.dumps(tree), head="loop: {time_limit: 30 s}\n")
    result, fast = run(made, seed)
    _, each = run(made, seed, computes_each_tick=True)
    assert fast == each
    possible = {str(b) for limb in limbs_of(places_of(made).root) for b in limb.branches}
    assert {f"{path}: {end}" for path, end in result.ends if end != "halted"} <= possible
    taken = {str(one) for one in result.tally.taken if one.what != "halted"}
    assert taken <= possible
