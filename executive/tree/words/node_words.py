"""What each kind of node and each modifier does, with an example: the one source of the command
`executive words` and of the tables in the documentation.
"""

from dataclasses import dataclass

from executive.tree.kind_keys import KINDS, MODIFIERS
from executive.tree.words.word import Word


@dataclass(frozen=True, slots=True)
class _NodeText:
    form: tuple[str, ...]  # one a key
    meaning: str
    example: str


_KINDS: dict[str, _NodeText] = {
    "sequence": _NodeText(
        ("sequence: [nodes]",),
        "one after the other, until one fails",
        "sequence:\n  - run: OpenGripper\n  - run: ScanSwing",
    ),
    "fallback": _NodeText(
        ("fallback: [nodes]",),
        "one after the other, until one succeeds",
        "fallback:\n  - run: ScanSwing\n  - ask: The scan failed. Go on without it?",
    ),
    "reactive_sequence": _NodeText(
        ("reactive_sequence: [nodes]",),
        "the same as a sequence, but all nodes before the running one are asked again at each "
        "tick; when one fails or runs, the later one that runs is cancelled. A node that asks no "
        "condition, such as an action, is not begun again after it has succeeded",
        "reactive_sequence:\n  - check: DetectSlip\n  - run: ExecuteTrajectory",
    ),
    "reactive_fallback": _NodeText(
        ("reactive_fallback: [nodes]",),
        "the same for a fallback: when an earlier node succeeds or runs, it takes over from the "
        "running one. An earlier node whose action took time and failed is not begun again; with "
        "an `if`, it is begun again once the `if` was false and is true again",
        "reactive_fallback:\n  - check: NoStoneLeft\n  - run: ScanSwing",
    ),
    "persistent_sequence": _NodeText(
        ("persistent_sequence: [nodes]",),
        "a sequence that, begun again after a failure or a halt, goes on at the node that failed "
        "or was halted",
        "persistent_sequence:\n  - run: SurveySite\n  - run: RegisterDroneMap",
    ),
    "parallel": _NodeText(
        ("parallel: [nodes]", "succeed: all", "fail: one", "wait_for_all: true"),
        "all at once, until `all`, `one` or a given number have succeeded, or `fail` of them have "
        "failed; with `wait_for_all` only when all have ended. `fail` alone lets fewer failures "
        "pass",
        "parallel:\n  - run: ScanSwing\n  - wait: 5 s\nsucceed: all",
    ),
    "not": _NodeText(
        ("not: node",),
        "turns success into failure and failure into success",
        "not:\n  check: NoStoneLeft",
    ),
    "force_failure": _NodeText(
        ("force_failure: node",),
        "fails whatever the node returns",
        "force_failure:\n  run: OpenGripper",
    ),
    "then": _NodeText(
        ("then: node", "if: condition", "else: node"),
        "asks the condition once, when it begins, and ticks one of the two to its end",
        'if: "{stone.reach_m} > 60 cm"\nthen: {run: ScanSwing}\nelse: {wait: 1 s}',
    ),
    "switch": _NodeText(
        ('switch: "{key}"', "cases: {value: node}", "else: node"),
        "ticks the node whose case is the key's value; asked at each tick",
        'switch: "{answer}"\ncases:\n  scan: {run: ScanSwing}\n  open: {run: OpenGripper}\n'
        "else: {wait: 1 s}",
    ),
    "loop": _NodeText(
        ("loop: {until: condition, max: 20}", "do: node"),
        "checks `until` before each round and after the last; without `until` it ends after `max` "
        "rounds. `loop: forever` ends only with a failing round or a halt",
        "loop: {until: NoStoneLeft, max: 20}\ndo: {run: ScanSwing}",
    ),
    "for_each": _NodeText(
        ('for_each: {item: key, in: "{list}"}', "do: node"),
        "once for each item; no items are a success",
        "for_each: {item: pause, in: [1, 2]}\ndo: {run: ScanSwing}",
    ),
    "consume": _NodeText(
        ('consume: {item: key, from: "{list}"}', "do: node"),
        "takes the first item off the list for each round, until the list is empty; also what is "
        "appended meanwhile",
        'consume: {item: stone, from: "{waiting}"}\ndo: {check: SetAside}',
    ),
    "run": _NodeText(
        ("run: Action",),
        "a leaf that takes time; `with:` its settings, `in:` and `out:` its ports",
        "run: ScanSwing\nwith: {angle: 120 deg, duration: 20 s}",
    ),
    "check": _NodeText(
        ("check: Condition",),
        "a leaf that answers at once, or an expression on keys",
        'check: "{stone.reach_m} > 40 cm"',
    ),
    "wait": _NodeText(("wait: 5 s",), "lets the mission's time pass", "wait: 5 s"),
    "set": _NodeText(
        ("set: {key: value}",),
        "writes literals, or what is computed from other keys",
        'set: {rounds: "{rounds} + 1"}',
    ),
    "ask": _NodeText(
        ("ask: question", "default: true"),
        "asks the operator: yes is a success, no a failure; with `choices: [left, right]` the "
        "choice goes into the key `answer`. The time that a person takes counts against no limit",
        "ask: Which side comes first?\nchoices: [left, right]\ndefault: left",
    ),
    "call": _NodeText(
        ("call: tree",),
        "another tree, with a store of its own",
        'call: relocate_one\nin: {stone: "{stone}", free_slots: "{free_slots}"}',
    ),
    "do": _NodeText(
        ("do: node",),
        "the node itself, so that it can be given modifiers of its own; with `while: condition` "
        "and `else: node` it asks the condition at each tick and changes between the two",
        "optional: true\ndo:\n  retry: 3\n  do: {run: RegisterDroneMap}",
    ),
}
_MODIFIERS: dict[str, _NodeText] = {
    "if": _NodeText(
        ("if: condition",),
        "checked when the node begins; if it is false, the node is left out: its parent goes on to "
        "the next node, and counts it neither as success nor as failure",
        "run: ScanSwing\nif: {not: NoStoneLeft}",
    ),
    "once": _NodeText(
        ("once: true",),
        "the node runs to its end once in a mission, and is left out afterwards",
        "run: SurveySite\nonce: true",
    ),
    "while": _NodeText(
        ("while: condition",),
        "checked before each tick; if it is false, the node is cancelled and fails",
        "run: ExecuteTrajectory\nwhile: DetectSlip",
    ),
    "timeout": _NodeText(
        ("timeout: 30 s",),
        "after this mission time the node is cancelled and fails",
        "run: Localise\ntimeout: 30 s",
    ),
    "retry": _NodeText(
        ("retry: 3",),
        "begins the node again when it fails, three attempts in all; "
        "`retry: {attempts: 3, pause: 2 s}` waits between them",
        "run: RegisterDroneMap\nretry: {attempts: 3, pause: 2 s}",
    ),
    "on_failure": _NodeText(
        ("on_failure: node",),
        "a recovery, run after each failed attempt; the failure stands. Beside `retry` it prepares "
        "the next attempt, and is left out after a failure that is final; what has to run after "
        "that one, too, is the `on_failure` of a node within",
        "run: ExecuteTrajectory\non_failure: {run: OpenGripper}",
    ),
    "optional": _NodeText(
        ("optional: true",),
        "failure counts as success; together with `retry` or `on_failure` it needs a `do` around "
        "them",
        "run: ScanSwing\noptional: true",
    ),
    "on_halt": _NodeText(
        ("on_halt: node",),
        "ticked once when the node is cancelled: `set`, `check` and what is made of them",
        "run: ScanSwing\non_halt: {set: {was_scanned: false}}",
    ),
    "name": _NodeText(
        ("name: text",),
        "what pictures, progress and the journal call the node",
        "run: ScanSwing\nname: look around",
    ),
}


def node_words() -> tuple[Word, ...]:
    """Return the kinds of nodes, and then the modifiers, the outermost first."""
    kinds = (
        Word(name, "node", one.meaning, one.form, one.example, keys=KINDS[name])
        for name, one in _KINDS.items()
    )
    modifiers = (
        Word(name, "modifier", one.meaning, one.form, one.example)
        for name, one in ((name, _MODIFIERS[name]) for name in MODIFIERS)
    )
    return (*kinds, *modifiers)
