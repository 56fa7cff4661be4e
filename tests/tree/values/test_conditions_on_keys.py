"""Conditions that are expressions: what they compute, and where mistakes are told."""

from typing import Any

import pytest


@pytest.mark.parametrize(
    ("condition", "is_true"),
    [
        ("{largest.mass_kg} > 0.8 t", True),
        ("{largest.mass_kg} > 0.8 t and not {largest.reach_m} < 50 cm", True),
        ("len({rocks}) == 2 and {rocks[0].id} != {rocks[1].id}", True),
        ("any(r in {rocks}: {r.mass_kg} < 400 kg)", True),
        ("all(r in {rocks}: {r.mass_kg} < 400 kg)", False),
        ("sum(each(r in {rocks}: {r.mass_kg})) >= 1.2 t", True),
        ("{largest.mass_kg} / {largest.density} > 0.3", True),
        ("has({largest.label}) and {largest.label} == 'B'", True),
        ("has({rocks[0].label})", False),
        ("default({rocks[0].label}, 'none') == 'none'", True),
        ("count(r in {rocks}: {r.id} in [1, 7]) == 1", True),
        ("len(only(r in {rocks}: has({r.label}))) == 1", True),
    ],
)
def test_a_condition_on_keys_is_computed(run: Any, condition: str, is_true: bool) -> None:
    one = run(f'- check: See\n- wait: 0.1 s\n  while: "{condition}"')
    assert (one.status == "SUCCESS") is is_true, one.reason


def test_the_reason_names_the_values(run: Any) -> None:
    one = run('- check: See\n- wait: 1 s\n  while: "{largest.mass_kg} < 0.5 t"')
    assert one.reason == (
        "no longer allowed: {largest.mass_kg} < 0.5 t is false ({largest.mass_kg} = 900)"
    )


def test_what_cannot_be_computed_fails_with_its_reason(run: Any) -> None:
    one = run('- check: See\n- wait: 1 s\n  if: {not: "{rocks[5].id} > 1"}')
    assert one.status == "FAILURE"
    assert "cannot be computed: there is no item 5 in a list of 2" in one.reason


@pytest.mark.parametrize(
    ("condition", "mistake"),
    [
        ("{§lagest.id} > 1", " reads key 'lagest' before it is written. Did you mean 'largest'?"),
        ("{largest.§mas_kg} > 1 t", ": Rock has no field 'mas_kg'. Did you mean 'mass_kg'?"),
        (
            "{largest.mass_kg} §> 1 m",
            ": cannot compare a mass and a length; both sides need units of one dimension",
        ),
        (
            "{largest.mass_kg} / 2 m §> {largest.density} * 3 s",
            ": cannot compare a number in m^-1·kg and a number in m^-3·kg·s; both sides need "
            "units of one dimension",
        ),
        (
            "{largest.§mass_kg}",
            ": it needs true or false, and {largest.mass_kg} is a mass",
        ),
        ("{largest.mass_kg} §> 'a'", ": '>' cannot compare a mass and a text"),
        (
            "§len({rocks}, 1) > 1",
            ": 'len' takes 1 argument, got 2: len({list}) is the number of its items",
        ),
        ("§len({largest}) > 1", ": 'len' needs a list or a text, not Rock"),
        (
            "{largest.§label} == 'B'",
            ": {largest.label} may be missing; ask 'has({largest.label}) and …' before, or write "
            "'default({largest.label}, …)'",
        ),
        (
            "{largest.§id} and true",
            ": 'and' needs true or false, and {largest.id} is a number",
        ),
        (
            "§distance({largest}, [0, 1]) > 1 m",
            ": 'distance' needs two points such as {stone.centroid_map}, not Rock",
        ),
        ("sum(each(r in {rocks}: {r.mass_kg})) §> 1 s", ": cannot compare a mass and a time; both "
         "sides need units of one dimension"),
        ("§any(r in {largest}: {r.id} > 1)", ": 'any' goes through a list, not Rock"),
        ("{rocks[0].§reech_m} > 1", ": Rock has no field 'reech_m'. Did you mean 'reach_m'?"),
    ],
)  # fmt: skip
def test_mistakes_in_conditions_are_told_at_their_letter(
    told: Any, condition: str, mistake: str
) -> None:
    assert told(f'- check: See\n- wait: 1 s\n  if: "{condition}"') == [f"§ the condition{mistake}"]


def test_a_mistake_of_syntax_has_its_place_too(told: Any) -> None:
    assert told('- check: See\n- wait: 1 s\n  if: "{largest.mass_kg} >§"') == [
        "§ 'if': the expression ends where a value is expected"
    ]


def test_every_mistake_of_several_expressions_is_told_at_once(told: Any) -> None:
    found = told(
        '- check: See\n- wait: 1 s\n  if: "{largest.x} > 1"\n  while: "{nothing} > 1"\n'
        '- set: {a: "1 m + {largest.mass_kg}"}'
    )
    assert len(found) == 3


@pytest.mark.parametrize(
    "text",
    [
        ">-\n    {largest.id} > 1\n    and {largest.§x} > 2",
        "|\n    {largest.id} > 1\n      and {largest.§x} > 2",
        '"{largest.id} > 1\n     and {largest.§x} > 2"',
        r'"\"a\" == \u0027b\u0027 and {largest.§x} > 2"',
        "'''a'' == ''b'' and {largest.§x} > 2'",
    ],
)
def test_a_place_in_a_text_with_line_breaks_or_escapes_is_found(told: Any, text: str) -> None:
    assert told(f"- check: See\n- wait: 1 s\n  if: {text}") == [
        "§ the condition: Rock has no field 'x'; there is: density, id, label, mass_kg, reach_m"
    ]
