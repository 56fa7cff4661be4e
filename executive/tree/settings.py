"""A table of the file against a settings class: pydantic's findings, each at the key or value that it is about."""

import json
import types
import typing
from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from executive.config import Settings
from executive.errors import did_you_mean
from executive.tree.problem import Mark, Problems
from executive.tree.value import Broken, Listing, Scalar, Table, Value, describe, has_broken, plain

S = TypeVar("S", bound=Settings)
_MAX_BROKEN = "a part of it could not be read"


def check_settings(settings: type[S], table: Table, owner: str, problems: Problems) -> S | None:
    """Return checked settings, or None after every mistake was noted.

    Types are exact (`"3"` is no number, `true` is no number): what is written is validated as JSON in strict mode,
    where a list may become a tuple and a text an enumeration, and nothing else is converted.
    """
    try:
        checked = settings.model_validate_json(json.dumps(plain(table)), strict=True)
    except ValidationError as error:
        told: set[Mark] = set()
        for finding in error.errors(include_url=False):
            _tell(settings, table, owner, finding, told, problems)
        return None
    return None if has_broken(table) else checked


def _tell(
    settings: type[Settings], table: Table, owner: str, finding: Any, told: set[Mark], problems: Problems
) -> None:
    kind, value, path = finding["type"], table, []
    mark, names = table.mark, _field_names(settings, [])
    node: Value = value
    for step in finding["loc"]:
        if isinstance(node, Table) and step in node.entries:
            entry = node.entries[step]
            mark = entry.key_mark if kind == "extra_forbidden" else entry.value.mark
            node = entry.value
            path.append(str(step))
        elif isinstance(node, Listing) and isinstance(step, int) and step < len(node.items):
            node = node.items[step]
            mark = node.mark
            path.append(str(step))
        elif kind == "missing" and step == finding["loc"][-1]:
            path.append(str(step))
    if isinstance(node, Broken) or (mark in told and kind != "missing"):
        return
    told.add(mark)
    names = _field_names(settings, path[:-1])
    problems.error(mark, _sentence(owner, kind, path, names, node, finding["msg"]))


def _sentence(owner: str, kind: str, path: Sequence[str], names: Sequence[str], node: Value, message: str) -> str:
    where = ".".join(path)
    if kind == "extra_forbidden":
        return f"{owner} has no setting '{where}'{did_you_mean(path[-1], names)}"
    if kind == "missing":
        return f"{owner} needs the setting '{where}'"
    message = message.removeprefix("Value error, ").removeprefix("Assertion failed, ")
    message = message[:1].lower() + message[1:]
    got = "" if "got " in message or not isinstance(node, Scalar | Listing) else f", got {describe(node)}"
    return f"{f'{where}: ' if where else ''}{message}{got}"


def _field_names(settings: type[BaseModel], path: Sequence[str]) -> list[str]:
    model: Any = settings
    for step in path:
        if not step.isdigit():
            field = model.model_fields.get(step)
            model = _model_in(field.annotation) if field else None
        if model is None:
            return []
    return list(model.model_fields)


def _model_in(annotation: Any) -> Any:
    if isinstance(annotation, type) and not isinstance(annotation, types.GenericAlias):
        return annotation if issubclass(annotation, BaseModel) else None
    found = (_model_in(argument) for argument in typing.get_args(annotation))
    return next((model for model in found if model is not None), None)


def settings_dump(settings: Settings) -> Mapping[str, Any]:
    """Return all settings explicitly, as JSON's types; what `check_settings` reads back."""
    return settings.model_dump(mode="json")
