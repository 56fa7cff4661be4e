"""An example of a leaf as a node: its settings with units, its ports with their keys."""

from collections.abc import Mapping
from typing import Any

from pydantic.fields import FieldInfo

from executive.config import UNITS
from executive.events.event import plain
from executive.leaf.action import Leaf
from executive.tree.resolved import yaml_flow
from executive.tree.words.field_words import dimension_words

_WIDTH = 88  # longer settings are written one a line
_SHOWN_IN = {"angle": "deg", "angular speed": "deg/s"}  # other quantities in their first unit


def leaf_example(key: str, name: str, leaf: type[Leaf[Any]]) -> str:
    """Return a node of the leaf as YAML.

    A setting shows its default, or the first of the field's `examples`; one that has neither is
    left out.
    """
    fields = leaf.Settings.model_fields
    values = {field: value for field, info in fields.items() if (value := _value(info)) is not None}
    inputs = {port: f"{{{port}}}" for port, spec in leaf.inputs.items() if not spec.optional}
    outputs = {port: f"{{{port}}}" for port in leaf.outputs}
    lines = [f"{key}: {name}"]
    for side, given in (("with", values), ("in", inputs), ("out", outputs)):
        lines += _mapping(side, given) if given else []
    return "\n".join(lines)


def _mapping(side: str, given: Mapping[str, Any]) -> list[str]:
    line = f"{side}: {_flow(given)}"
    if len(line) <= _WIDTH:
        return [line]
    return [f"{side}:", *(f"  {key}: {_flow(value)}" for key, value in given.items())]


def _flow(value: Any) -> str:
    """Return YAML in one line, with the quotation marks that the documentation uses."""
    text = yaml_flow(value)
    return text if '"' in text else text.replace("'", '"')


def _value(info: FieldInfo) -> Any:
    if info.examples:
        return info.examples[0]
    if info.is_required():
        return None
    value = info.get_default(call_default_factory=True)
    if value in ((), [], {}):
        return None
    dimension, unit = dimension_words(info)
    if not dimension or not isinstance(value, float):
        return plain(value)
    unit = _SHOWN_IN.get(dimension, unit)
    return f"{value / UNITS[dimension][unit]:.3g} {unit}"
