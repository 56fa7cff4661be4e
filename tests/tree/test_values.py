"""Keys and expressions as values: in settings, conditions, ports and `set`, from file to tick."""

import re
from dataclasses import dataclass
from typing import Any

import pytest
from pydantic import Field

from executive.config import Kilograms, Radians, Settings
from executive.interfaces.plugin import Plugin
from executive.leaf.action import Action, Condition, Steps
from executive.leaf.outcome import Outcome, succeeded
from executive.tree.catalogue import TableCatalogue
from executive.tree.problem import MissionFileError
from executive.tree.resolved import resolved_yaml
from executive.tree.schema import mission_schema


@dataclass(frozen=True)
class Rock:
    """A rock.

    Attributes:
        id: Its number.
        mass_kg: Its mass.
        reach_m: Its size.
        density: Its density [kg/m3].
        label: What is written on it, if anything.
    """

    id: int
    mass_kg: float
    reach_m: float
    density: float
    label: str | None = None


@dataclass(frozen=True)
class Rocks:
    """What is seen.

    Attributes:
        rocks: All of them.
        largest: The heaviest.
    """

    rocks: list[Rock]
    largest: Rock


class See(Condition):
    """See two rocks."""

    def check(self) -> Outcome[Rocks]:
        small, large = Rock(1, 300.0, 0.4, 2600.0), Rock(2, 900.0, 0.6, 2700.0, "B")
        return succeeded(Rocks([small, large], large))


class TurnSettings(Settings):
    angle: Radians = Field(gt=-7, le=7, description="Where to.")
    times: int = Field(1, ge=1, le=5, description="How often.")
    label: str = Field("", description="What to say.")
    speeds: tuple[float, ...] = Field((), description="One a turn.")


@dataclass(frozen=True)
class Turned:
    """What a turn gives.

    Attributes:
        told: The settings.
        mass: A mass [kg].
    """

    told: str
    mass: float


class Turn(Action[TurnSettings]):
    """Turn."""

    def run(self, payload: Kilograms | None = None) -> Steps[Turned]:
        """Turn.

        Args:
            payload: What is held [kg].
        """
        yield None
        one = self.settings
        return succeeded(
            Turned(f"{one.angle:.3f} {one.times} {one.label} {one.speeds}", payload or 0.0)
        )


HEADER = (
    "api: 1\nmission: test\nplugins: {robot: mujoco, estimation: gnss_imu, mapping: voxel_map}\n"
)
LEAVES: dict[str, type] = {"See": See, "Turn": Turn}


@pytest.fixture
def told(load: Any) -> Any:
    """Return the mistakes of a mission whose `main` is a sequence.

    Where the text has the mark §, a mistake at that letter begins with §.
    """

    def problems(main: str, trees: str = "") -> list[str]:
        body = "".join(f"      {line}\n" for line in main.strip("\n").splitlines())
        text = f"trees:\n  main:\n    sequence:\n{body}{trees}"
        before = (HEADER + text).partition("§")[0]
        marked = before.count("\n") + 1, len(before) - before.rfind("\n")
        try:
            load(text.replace("§", ""), leaves=LEAVES)
        except MissionFileError as error:
            return [
                ("§ " if (p.mark.line, p.mark.column) == marked else "") + p.message
                for p in error.problems
            ]
        return []

    return problems


@pytest.fixture
def run(play: Any) -> Any:
    """Run a sequence to its end, and return the play."""

    def played(main: str, trees: str = "") -> Any:
        body = "".join(f"  {line}\n" for line in main.strip("\n").splitlines())
        one = play(f"sequence:\n{body}", leaves=LEAVES, trees=trees)
        one.finish()
        return one

    return played


# --- settings


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


# --- conditions


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


# --- set and ports


def test_set_computes_and_a_loop_counts(run: Any) -> None:
    one = run(
        '- set: {n: 0}\n- loop: {until: "{n} >= 3", max: 9}\n  do: {set: {n: "{n} + 1"}}\n'
        "- set: {told: \"text('n is ', {n}, ', half is ', {n} / 2)\", far: 2 km}"
    )
    store = one.runtime.store
    assert (store.get("n"), store.get("told"), store.get("far")) == (3, "n is 3, half is 1.5", 2000)


def test_a_port_takes_an_expression(run: Any, told: Any) -> None:
    turn = '- check: See\n- run: Turn\n  with: {angle: 0}\n  in: {payload: "%s"}'
    assert run(turn % "{largest.mass_kg} / 2").runtime.store.get("mass") == 450
    assert told(turn.replace('"%s"', '§"%s"') % "text('a', {largest.id})") == [
        "§ input 'payload' of Turn is mass, and 'text('a', {largest.id})' holds str"
    ]


def test_an_optional_input_is_asked_for_before_it_is_read(run: Any, told: Any) -> None:
    trees = (
        "  show:\n    in: {rock: 'Rock?'}\n    out: {told: str}\n    fallback:\n"
        '      - {set: {told: "text({rock.id})"}, if: "has({rock})"}\n'
        "      - set: {told: nothing}\n"
    )
    given = '- check: See\n- call: show\n  in: {rock: "{largest}"}'
    assert told(given, trees) == []
    assert run(given, trees).runtime.store.get("told") == "2"
    assert told("- call: show", trees) == []
    assert run("- call: show", trees).runtime.store.get("told") == "nothing"


def test_a_resolved_mission_with_expressions_loads_as_the_same(load: Any, tmp_path: Any) -> None:
    text = (
        "trees:\n  main:\n    sequence:\n      - set: {heading: 10 deg}\n      - check: See\n"
        '      - run: Turn\n        with: {angle: "{heading}*2", label: "a {heading} b"}\n'
        '        in: {payload: "{largest.mass_kg}"}\n        if: "len({rocks})>1"\n'
    )
    mission = load(text, leaves=LEAVES)
    written = resolved_yaml(mission)
    assert (
        "'{heading} * 2'" in written or '"{heading} * 2"' in written or "{heading} * 2" in written
    )
    again = load(written, leaves=LEAVES, header="")
    assert resolved_yaml(again) == written


# --- nodes


def test_a_check_takes_an_expression(run: Any) -> None:
    small, large = "'{largest.mass_kg} < 1 t'", "'{largest.mass_kg} > 1 t'"
    assert run(f"- check: See\n- check: {small}").status == "SUCCESS"
    refused = run(f"- check: See\n- check: {large}")
    assert refused.status == "FAILURE"
    assert refused.reason == "{largest.mass_kg} > 1 t is false ({largest.mass_kg} = 900)"
    broken = run("- check: See\n- check: '{rocks[7].id} > 1'")
    assert (broken.status, broken.runtime.errors) == ("FAILURE", [])


def test_an_expression_may_stand_before_the_last_child_of_a_reactive_sequence(run: Any) -> None:
    one = run(
        "- set: {n: 1}\n- reactive_sequence:\n    - check: '{n} < 3'\n    - wait: 0.3 s\n"
        "- reactive_fallback:\n    - check: '{n} > 3'\n    - wait: 0.3 s"
    )
    assert one.status == "SUCCESS", one.reason


def test_a_check_with_an_expression_takes_no_settings(told: Any) -> None:
    assert told("- check: See\n- check: '{largest.id} > 1'\n  §with: {a: 1}") == [
        "§ 'with' belongs to a leaf, not an expression"
    ]


def test_a_name_is_filled_in_when_the_node_begins_and_its_path_stays(run: Any, told: Any) -> None:
    one = run(
        "- check: See\n- for_each: {item: r, in: '{rocks}'}\n"
        "  do: {wait: 0.1 s, name: 'stone {r.id}'}"
    )
    node = next(node for node in one.root.iterate() if "stone" in node.path)
    assert node.name == "stone 2"
    assert node.path == "main/1:for_each/0:stone {r.id}"
    assert told("- wait: 1 s\n  name: 'stone {§r.id}'") == [
        "§ 'name' reads key 'r' before it is written; nothing is written before it"
    ]


def test_the_schema_takes_expressions_where_the_language_does() -> None:
    jsonschema = pytest.importorskip("jsonschema")
    catalogue = TableCatalogue(LEAVES, {"robot": {"fake": Plugin}})
    validator = jsonschema.Draft202012Validator(mission_schema(catalogue))
    head = {"api": 1, "mission": "m"}

    def is_valid(node: dict[str, Any]) -> bool:
        return validator.is_valid({**head, "trees": {"main": {"sequence": [node]}}})

    assert is_valid({"run": "Turn", "with": {"angle": "{heading} * 2", "label": "a {b}"}})
    assert is_valid({"run": "Turn", "with": {"angle": 1}, "in": {"payload": "{a.b} / 2"}})
    assert is_valid({"check": "{a} > 1 m", "if": "len({b}) > 2"})
    assert is_valid({"ask": "Which?", "choices": ["a", "b"], "out": {"answer": "{side}"}})
    assert not is_valid({"run": "Turn", "with": {"angle": [1]}})
    assert not is_valid({"ask": "Which?", "choices": ["a"]})


# --- bounds that are known before the start


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
