"""Reads the node `ask`: its question, its choices, its default, the key of the answer."""

from executive.tree.key_source import Ref
from executive.tree.leaf_reader import read_outputs
from executive.tree.node_kinds import Ask
from executive.tree.reading import Reading
from executive.tree.value import Table, Value, describe

_ANSWER = "answer"


def read_ask(table: Table, reading: Reading) -> Ask | None:
    """Return a question, or None after every mistake was noted."""
    value = table.entries["ask"].value
    question = reading.template(value, "'ask'")
    choices_value, default_value, out = table.get("choices"), table.get("default"), table.get("out")
    if choices_value is None:
        if out is not None:
            reading.fail(out, "'out' of ask takes the choice, and there are no 'choices'; yes is "
                         "success and no is failure")  # fmt: skip
        truth = None if default_value is None else reading.truth(default_value, "'default'")
        return Ask(question, truth) if question else None
    choices = _choices(choices_value, reading)
    default = _default(default_value, choices, reading)
    keys = read_outputs(reading, out, (_ANSWER,), "ask")
    key = keys.get(_ANSWER, Ref(_ANSWER, value.mark, is_listed=False))
    return Ask(question, default, choices, key) if question and choices else None


def _choices(value: Value, reading: Reading) -> tuple[str, ...]:
    listing = reading.listing(value, "'choices'")
    words = [reading.text(item, "a choice") for item in listing.items] if listing else []
    choices = tuple(word for word in words if word is not None)
    if len({choice.lower() for choice in choices}) < len(choices):
        reading.fail(value, "two of the 'choices' are the same")
    elif listing and len(listing.items) == 1:
        reading.fail(value, "'choices' needs at least two texts")
    return choices


def _default(value: Value | None, choices: tuple[str, ...], reading: Reading) -> str | None:
    if value is None:
        return None
    text = reading.text(value, "'default'")
    if text is not None and choices and text not in choices:
        reading.fail(value, f"'default' is one of {', '.join(choices)}, not {describe(value)}")
    return text
