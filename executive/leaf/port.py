"""The ports of a leaf, read from the signature of its `run` or `check`.

Inputs are the parameters; outputs are the fields of the result class that the return annotation
names. What a port means is read from the docstrings: `Args:` of the method, `Attributes:` of the
result class.
"""

import inspect
import re
import types
import typing
from collections.abc import Callable, Generator, Mapping
from dataclasses import MISSING, dataclass, fields, is_dataclass
from typing import Any

from executive.errors import ConfigError
from executive.leaf.outcome import Outcome

_ENTRY = re.compile(r"(\s*)(\w+)(?: \([^)]*\))?:\s*(.*)")


@dataclass(frozen=True, slots=True)
class Port:
    """An input or output of a leaf.

    Attributes:
        type: Class of the value, or `list[X]` for a list of them; `object` takes anything.
        doc: Meaning, frame and unit in one line.
        optional: An input that may be left unconnected, for which the leaf gets None; an output
            that may stay unwritten.
    """

    type: object
    doc: str
    optional: bool = False


def inputs_of(method: Callable[..., object]) -> dict[str, Port]:
    """Return the input ports of a `run` or `check`, by name.

    Raises:
        ConfigError: If a parameter has no type, or a default other than None.
    """
    hints, docs = typing.get_type_hints(method), section(method.__doc__, "Args")
    ports = {}
    for name, parameter in list(inspect.signature(method).parameters.items())[1:]:
        where = f"{method.__qualname__}: input '{name}'"
        if parameter.kind not in (parameter.POSITIONAL_OR_KEYWORD, parameter.KEYWORD_ONLY):
            raise ConfigError(f"{where} is a star argument; name each input port")
        if name not in hints:
            raise ConfigError(f"{where} has no type")
        if parameter.default not in (parameter.empty, None):
            raise ConfigError(f"{where} has the default {parameter.default!r}; only None may be")
        is_optional = parameter.default is None
        kind = _without_none(hints[name]) if is_optional else hints[name]
        ports[name] = Port(kind, docs.get(name, ""), is_optional)
    return ports


def outputs_of(method: Callable[..., object]) -> dict[str, Port]:
    """Return the output ports that a `run` or `check` declares by its return annotation.

    `Steps[PickPlanned]` and `Outcome[PickPlanned]` declare the fields of the dataclass
    `PickPlanned`. In a union the first class is what a success brings, and the others are what a
    failure may bring; a field of type `X | None` with the default None may stay unwritten.

    Raises:
        ConfigError: If the annotation is missing or of another form.
    """
    result = _result_of(method)
    ports: dict[str, Port] = {}
    for number, kind in enumerate(_members(result)):
        if kind is type(None):
            continue
        if not is_dataclass(kind) or not isinstance(kind, type):
            raise ConfigError(f"{method.__qualname__} returns {kind!r}, which is no dataclass")
        hints, docs = typing.get_type_hints(kind), section(kind.__doc__, "Attributes")
        for one in fields(kind):
            has_default = one.default is not MISSING
            wanted = _without_none(hints[one.name]) if has_default else hints[one.name]
            is_optional = has_default or number > 0
            ports.setdefault(one.name, Port(wanted, docs.get(one.name, ""), is_optional))
    return ports


def written_by(outcome: Outcome[object]) -> Mapping[str, object]:
    """Return the values of the outputs that an outcome brings; None counts as unwritten."""
    result = outcome.outputs
    if result is None or not is_dataclass(result):
        return {}
    values = {one.name: getattr(result, one.name) for one in fields(result)}
    return {name: value for name, value in values.items() if value is not None}


def section(doc: str | None, title: str) -> dict[str, str]:
    """Return the entries of a docstring's section, such as `Args`, each joined to one line."""
    lines = inspect.cleandoc(doc or "").splitlines()
    try:
        start = lines.index(f"{title}:") + 1
    except ValueError:
        return {}
    entries: dict[str, str] = {}
    indent, name = "", ""
    for line in lines[start:]:
        if line and not line.startswith(" "):
            break
        match = _ENTRY.match(line)
        if match and (not indent or match.group(1) == indent):
            indent, name = match.group(1), match.group(2)
            entries[name] = match.group(3)
        elif name and line.strip():
            entries[name] += f" {line.strip()}"
    return entries


def _result_of(method: Callable[..., object]) -> Any:
    hint = typing.get_type_hints(method).get("return")
    if typing.get_origin(hint) is Generator:
        hint = typing.get_args(hint)[2]
    if typing.get_origin(hint) is not Outcome:
        raise ConfigError(
            f"{method.__qualname__} declares no result; annotate it '-> Steps[Result]' for an "
            "action or '-> Outcome[Result]' for a condition, with None where it has no outputs"
        )
    return typing.get_args(hint)[0]


def _members(kind: Any) -> tuple[Any, ...]:
    if typing.get_origin(kind) in (typing.Union, types.UnionType):
        return typing.get_args(kind)
    return (kind,)


def _without_none(kind: Any) -> Any:
    kept = [one for one in _members(kind) if one is not type(None)]
    return typing.Union[tuple(kept)]  # noqa: UP007 - made from a list
