"""The JSON schema of nodes: each kind with its keys, and the modifiers."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from executive.tree.instances import USE

Schema = dict[str, Any]
EXPRESSION: Schema = {
    "type": "string",
    "pattern": r"\{",
    "description": "An expression on keys: {stone.mass} > 0.8 t",
}
REFERENCE: Schema = {"type": "string", "pattern": r"^\{[A-Za-z_][A-Za-z0-9_]*\}$"}
DURATION: Schema = {
    "type": ["number", "string"],
    "description": "A duration: seconds, or with a unit: 30 s, 2 min.",
}
COUNT: Schema = {"type": "integer", "minimum": 1}
NODE: Schema = {"$ref": "#/$defs/node"}
OTHERWISE: Schema = {"anyOf": [NODE, {"const": "skip"}]}
CONDITION: Schema = {"$ref": "#/$defs/condition"}
NODES: Schema = {"type": "array", "items": NODE, "minItems": 1}
PLUGIN_NAMES: Schema = {
    "type": ["string", "object"],
    "description": "The name of a plugin, where the mission has several of a capability.",
    "additionalProperties": {"type": "string"},
}
WORD: Schema = {"type": "string", "pattern": "^[A-Za-z_][A-Za-z0-9_]*$"}


def any_of(kinds: Iterable[Schema]) -> Schema:
    """Return a node of any of the kinds, with the modifiers."""
    return {"type": "object", "anyOf": [_with_modifiers(kind) for kind in kinds]}


def as_tree(kind: Schema) -> Schema:
    """Return a kind as the root of a tree, where `in` and `out` are the tree's ports."""
    types = {
        "type": "object",
        "additionalProperties": {"type": "string", "description": "Stone, list[Stone], Stone?"},
    }
    return {**kind, "properties": {**kind["properties"], "in": types, "out": types}}


def node_kinds() -> Iterator[Schema]:
    """Yield the schema of each kind that is no leaf."""
    yield from _of_children()
    yield from _choices()
    yield from _repeating()
    yield from _small()


def _of_children() -> Iterator[Schema]:
    for kind in (
        "sequence",
        "fallback",
        "reactive_sequence",
        "reactive_fallback",
        "persistent_sequence",
    ):
        yield {"properties": {kind: NODES}, "required": [kind]}
    number = {"anyOf": [{"enum": ["all", "one"]}, COUNT]}
    thresholds = {"succeed": number, "fail": number, "wait_for_all": {"type": "boolean"}}
    yield {"properties": {"parallel": NODES, **thresholds}, "required": ["parallel"]}
    for kind in ("not", "force_failure"):
        yield {"properties": {kind: NODE}, "required": [kind]}


def _choices() -> Iterator[Schema]:
    yield {
        "properties": {"if": CONDITION, "then": NODE, "else": OTHERWISE},
        "required": ["if", "then"],
    }
    yield {
        "properties": {"while": CONDITION, "do": NODE, "else": OTHERWISE},
        "required": ["while", "do", "else"],
    }
    cases = {"type": "object", "additionalProperties": NODE, "minProperties": 1}
    yield {
        "properties": {"switch": REFERENCE, "cases": cases, "else": OTHERWISE},
        "required": ["switch", "cases"],
    }


def _repeating() -> Iterator[Schema]:
    loop = {"until": CONDITION, "max": COUNT}
    yield {
        "properties": {
            "loop": {"anyOf": [{"const": "forever"}, {**closed(loop), "minProperties": 1}]},
            "do": NODE,
        },
        "required": ["loop", "do"],
    }
    each = {"item": WORD, "in": {"anyOf": [EXPRESSION, {"type": "array"}]}}
    yield {
        "properties": {"for_each": closed(each, *each), "do": NODE},
        "required": ["for_each", "do"],
    }
    taken = {"item": WORD, "from": REFERENCE}
    yield {
        "properties": {"consume": closed(taken, *taken), "do": NODE},
        "required": ["consume", "do"],
    }


def _small() -> Iterator[Schema]:
    yield {"properties": {"do": NODE}, "required": ["do"]}
    expression = {"anyOf": [EXPRESSION, {"type": "boolean"}]}
    yield {"properties": {"check": expression}, "required": ["check"]}
    yield {"properties": {"wait": DURATION}, "required": ["wait"]}
    yield {"properties": {"set": {"type": "object", "minProperties": 1}}, "required": ["set"]}
    yield {
        "properties": {
            "ask": {"type": "string", "description": "The question; keys in braces are filled in."},
            "choices": {"type": "array", "items": {"type": "string"}, "minItems": 2},
            "default": {"type": ["boolean", "string"]},
            "out": wires({"answer": "The key that takes the choice."}),
        },
        "required": ["ask"],
    }
    out = {"type": "object", "additionalProperties": REFERENCE}
    yield {
        "properties": {
            "call": {"type": "string"},
            "in": {"type": "object"},
            "out": out,
            USE: PLUGIN_NAMES,
        },
        "required": ["call"],
    }


def _with_modifiers(kind: Schema) -> Schema:
    attempts: Schema = {"type": "integer", "minimum": 1, "description": "Attempts in all."}
    modifiers: Schema = {
        "if": CONDITION,
        "once": {"type": "boolean"},
        "while": CONDITION,
        "timeout": DURATION,
        "retry": {
            "anyOf": [attempts, closed({"attempts": attempts, "pause": DURATION}, "attempts")]
        },
        "on_failure": NODE,
        "optional": {"type": "boolean"},
        "on_halt": NODE,
        "name": {"type": "string"},
    }
    return closed({**kind["properties"], **modifiers}, *kind["required"])


def closed(properties: Mapping[str, Any], *required: str) -> Schema:
    """Return a mapping that takes no other keys."""
    schema: Schema = {
        "type": "object",
        "properties": dict(properties),
        "additionalProperties": False,
    }
    return {**schema, "required": list(required)} if required else schema


def wires(docs: Mapping[str, str], form: Schema = REFERENCE) -> Schema:
    """Return the ports of a leaf, each with its description."""
    return closed({port: {**form, "description": doc} for port, doc in docs.items()})
