"""A leaf's word, read from its class."""

import inspect
from collections.abc import Mapping
from typing import Any

from pydantic.fields import FieldInfo

from executive.leaf.action import Action, Leaf
from executive.leaf.port import Port
from executive.tree.port_types import type_name
from executive.tree.words.example import leaf_example
from executive.tree.words.field_words import (
    bounds_words,
    default_words,
    dimension_words,
    type_words,
)
from executive.tree.words.word import PortWord, SettingWord, Word


def leaf_word(name: str, leaf: type[Leaf[Any]], package: str) -> Word:
    """Describe a leaf as it is installed under a name."""
    is_action = issubclass(leaf, Action)
    key = "run" if is_action else "check"
    return Word(
        name=name,
        kind="action" if is_action else "check",
        summary=first_paragraph(leaf),
        form=(f"{key}: {name}",),
        example=leaf_example(key, name, leaf),
        inputs=_ports(leaf.inputs),
        outputs=_ports(leaf.outputs),
        settings=tuple(_setting(field, info) for field, info in leaf.Settings.model_fields.items()),
        needs=tuple(need.capability for need in leaf.needs),
        claims=tuple(str(part) for part in leaf.parts()),
        package=package,
    )


def first_paragraph(thing: object) -> str:
    """Return the first paragraph of a docstring in one line; without one, an empty text."""
    return " ".join((inspect.getdoc(thing) or "").partition("\n\n")[0].split())


def _ports(ports: Mapping[str, Port]) -> tuple[PortWord, ...]:
    return tuple(
        PortWord(name, type_name(one.type), one.optional, one.doc) for name, one in ports.items()
    )


def _setting(name: str, info: FieldInfo) -> SettingWord:
    dimension, unit = dimension_words(info)
    return SettingWord(
        name=name,
        type=dimension or type_words(info.annotation).replace("`", ""),
        unit=unit,
        default=default_words(info),
        bounds=bounds_words(info),
        meaning=info.description or "",
    )
