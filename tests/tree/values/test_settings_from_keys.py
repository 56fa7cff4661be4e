"""Settings of leaves that take keys and expressions."""

import re
from typing import Any

import pytest


def test_a_setting_takes_a_key_and_a_quantity_keeps_its_unit(run: Any) -> None:
    one = run('- set: {heading: 90 deg}\n- run: Turn\n  with: {angle: "{heading}"}')
    assert one.status == "SUCCESS", one.reason
    assert one.runtime.store.get("told") == "1.571 1  ()"


def test_a_subtree_has_parameters(run: Any) -> None:
    trees = (
        "  turn:\n    in: {to: angle, times: int}\n    out: {told: str}\n    sequence:\n"
        '      - run: Turn\n        with: {angle: "{to} * 2", times: "{times} + 1"}\n'
    )
    one = run("- call: turn\n  in: {to: 45 deg, times: 2}", trees)
    assert one.status == "SUCCESS", one.reason
    assert one.runtime.store.get("told") == "1.571 3  ()"


def test_a_text_is_filled_in_and_a_list_is_computed(run: Any) -> None:
    one = run(
        '- check: See\n- run: Turn\n  with: {angle: 0, label: "to {largest.id} of {{2}}", '
        'speeds: "each(r in {rocks}: {r.mass_kg} / 100)"}'
    )
    assert one.runtime.store.get("told") == "0.000 1 to 2 of {2} (3.0, 9.0)"


def test_a_computed_setting_is_held_against_its_bound_when_the_leaf_starts(run: Any) -> None:
    one = run('- set: {n: 9}\n- run: Turn\n  with: {angle: 1, times: "{n} - 2"}')
    assert one.status == "FAILURE"
    assert one.reason.startswith(
        "Turn refuses its settings: 'times': input should be less than or equal to 5, got 7 ("
    )
    assert one.reason.endswith("mission.yaml:9:33)")


def test_settings_are_computed_anew_at_each_start(run: Any) -> None:
    turn = 'run: Turn\n    with: {angle: 0, times: "{n}"}'
    each = "- for_each: {item: n, in: [1, 2]}\n  do:\n    " + turn
    assert run(each).runtime.store.get("told") == "0.000 2  ()"


@pytest.mark.parametrize(
    ("given", "mistake"),
    [
        (
            'angle: §"{nothing}"',
            "setting 'angle' of Turn reads key 'nothing' before it is written; there is: "
            "heading, largest, rocks, weight",
        ),
        (
            'angle: §"{weight}"',
            "setting 'angle' of Turn is an angle, and key 'weight' is a mass",
        ),
        (
            'angle: 1, times: §"{weight}"',
            "setting 'times' of Turn is a whole number, and key 'weight' is a mass",
        ),
        (
            'angle: 1, speeds: §"{heading}"',
            "setting 'speeds' of Turn is a list, and key 'heading' is an angle",
        ),
        (
            'angle: "{heading} §+ {weight}"',
            "setting 'angle' of Turn: cannot add an angle and a mass; both sides need units of "
            "one dimension",
        ),
        (
            'angle: 1, label: "stone {largest.§ide}"',
            "setting 'label' of Turn: Rock has no field 'ide'. Did you mean 'id'?",
        ),
        (
            'angle: 1, label: "stone §{largest"',
            "'label': this brace is not closed; a brace as text is written '{{'",
        ),
        ('§angel: "{heading}"', "Turn has no setting 'angel'. Did you mean 'angle'?"),
    ],
)
def test_mistakes_in_settings_are_told_before_the_start(
    told: Any, given: str, mistake: str
) -> None:
    before = "- set: {heading: 10 deg, weight: 1 t}\n- check: See\n- run: Turn\n"
    assert f"§ {mistake}" in told(f"{before}  with: {{{given}}}")


def test_a_value_of_the_file_that_is_out_of_bounds_is_told_before_the_start(told: Any) -> None:
    bound = "setting 'times' of Turn: input should be less than or equal to 5, and key 'n' is 9"
    turn = '- run: Turn\n  with: {angle: 0, times: §"{n}"}'
    assert told(f"- set: {{n: 9}}\n{turn}") == [f"§ {bound}"]
    assert told(f"- set: {{n: 4}}\n{turn}") == []
    assert told(f"- set: {{n: 9}}\n- set: {{n: 4}}\n  if: See\n{turn}") == []
    assert (
        told(f'- set: {{n: 0}}\n- loop: {{max: 9}}\n  do: {{set: {{n: "{{n}} + 1"}}}}\n{turn}')
        == []
    )


def test_a_value_that_a_call_gives_is_held_against_the_bound(told: Any) -> None:
    trees = (
        '  turn:\n    in: {to: angle}\n    sequence:\n      - {run: Turn, with: {angle: "{to}"}}\n'
    )
    assert told("- call: turn\n  in: {to: 90 deg}", trees) == []
    (refusal,) = told("- call: turn\n  in: {to: 500 deg}", trees)
    assert refusal.startswith(
        "setting 'angle' of Turn: input should be less than or equal to 7, and key 'to' is 8.7"
    )
    # The tree may be in a shipped file, and the value is in the mission's: both are named.
    assert re.search(r": 'call: turn' at \S+\.yaml:\d+:\d+ gives it$", refusal)
