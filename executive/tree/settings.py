"""Checks a table of the file against a settings class, and reports each finding at its key."""

import json
import types
import typing
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar, cast

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from executive.config import Settings, dimension_of, expected
from executive.errors import ConfigError, did_you_mean
from executive.tree.problem import Mark, Problems
from executive.tree.value import Broken, Listing, Scalar, Table, Value, describe, has_broken, plain

S = TypeVar("S", bound=Settings)
_BOUNDS = ("greater_than", "greater_than_equal", "less_than", "less_than_equal")


def check_settings(
    settings: type[S],
    table: Table,
    owner: str,
    problems: Problems,
    computed: Collection[str] = (),
) -> S | None:
    """Return checked settings, or None after every mistake was noted.

    Types are exact (`"3"` is no number, `true` is no number): what is written is validated as JSON
    in strict mode, where a list may become a tuple and a text an enumeration, and nothing else is
    converted. Settings that are computed only during the run may be missing; what concerns the
    settings together is then checked with them.
    """
    try:
        checked = settings.model_validate_json(json.dumps(plain(table)), strict=True)
    except ValidationError as error:
        told: set[Mark] = set()
        findings = _first_to_mend(error.errors(include_url=False))
        known = [one for one in findings if not _waits(one, computed)]
        if not known and not has_broken(table):
            partial: Any = settings.model_construct(**plain(table))
            return cast(S, partial)
        for finding in known:
            place = placed(table, finding["loc"], finding["type"])
            is_new = (
                place.mark not in told or finding["type"] == "missing"
            )  # a union reports each of its members
            if is_new and not isinstance(place.value, Broken):
                told.add(place.mark)
                problems.error(place.mark, _sentence(settings, owner, finding, place))
        return None
    return None if has_broken(table) else checked


def computed_settings(
    settings: type[S], values: Mapping[str, Any], owner: str, places: Mapping[str, Mark]
) -> S:
    """Return settings, some of which were computed when their leaf started.

    Raises:
        ConfigError: If the class refuses a value; the message names the value, the bound and the
            place of the setting.
    """
    try:
        return settings.model_validate_json(json.dumps(values, default=_refused), strict=True)
    except ValidationError as error:
        told = [_told_at_start(one, values, places) for one in error.errors(include_url=False)]
        raise ConfigError(
            f"{owner} refuses its settings: {'; '.join(dict.fromkeys(told))}"
        ) from None


def _first_to_mend(findings: Sequence[Any]) -> list[Any]:
    """Leave out that a list is too short where items are wrong: only good ones were counted."""
    places = [one["loc"] for one in findings]

    def is_due_to_items(one: Any) -> bool:
        own = one["loc"]
        return any(len(place) > len(own) and place[: len(own)] == own for place in places)

    return [one for one in findings if one["type"] != "too_short" or not is_due_to_items(one)]


def _waits(finding: Any, computed: Collection[str]) -> bool:
    """Whether a finding may be gone when the other settings are computed."""
    place = finding["loc"]
    return bool(computed) and (not place or (finding["type"] == "missing" and place[0] in computed))


def _told_at_start(finding: Any, values: Mapping[str, Any], places: Mapping[str, Mark]) -> str:
    steps = finding["loc"]
    name = str(steps[0]) if steps else ""
    message = str(finding["msg"]).removeprefix("Value error, ")
    got = f", got {values[name]!r}" if name in values and "got " not in message else ""
    place = f" ({places[name]})" if name in places else ""
    where = f"'{'.'.join(map(str, steps))}': " if steps else ""
    return f"{where}{message[:1].lower()}{message[1:]}{got}{place}"


def _refused(value: Any) -> Any:
    raise ConfigError(
        f"a setting is a number, a text, true or false, or a list of them, not a "
        f"{type(value).__name__}"
    )


def settings_dump(settings: Settings) -> Mapping[str, Any]:
    """Return all settings explicitly, as JSON's types; what `check_settings` reads back."""
    return settings.model_dump(mode="json", warnings=False)  # partial ones are as the file has them


@dataclass(frozen=True, slots=True)
class PlaceOf:
    """Where a finding is: its mark, the value there, and the keys that lead to it."""

    mark: Mark
    value: Value
    path: tuple[str, ...]


def placed(table: Table, steps: Sequence[int | str], kind: str) -> PlaceOf:
    """Return the place in the file that a finding of pydantic is about."""
    place = PlaceOf(table.mark, table, ())
    for step in steps:
        value, path = place.value, (*place.path, str(step))
        if isinstance(value, Table) and step in value.entries:
            entry = value.entries[str(step)]
            place = PlaceOf(
                entry.key_mark if kind == "extra_forbidden" else entry.value.mark, entry.value, path
            )
        elif isinstance(value, Listing) and isinstance(step, int) and step < len(value.items):
            place = PlaceOf(value.items[step].mark, value.items[step], path)
    if kind == "missing":
        return PlaceOf(place.mark, place.value, (*place.path, str(steps[-1])))
    return place


def _sentence(settings: type[Settings], owner: str, finding: Any, place: PlaceOf) -> str:
    where = ".".join(place.path)
    if finding["type"] == "extra_forbidden":
        return (
            f"{owner} has no setting "
            f"'{where}'{did_you_mean(place.path[-1], _fields(settings, place.path[:-1]))}"
        )
    if finding["type"] == "missing":
        return f"{owner} needs the setting '{where}'"
    message = str(finding["msg"]).removeprefix("Value error, ")
    message = message[:1].lower() + message[1:]
    is_told = "got " in message or not isinstance(place.value, Scalar | Listing)
    got = "" if is_told else f", got {describe(place.value)}"
    unit = _unit_meant(settings, finding["type"], place)
    return f"{f'{where}: ' if where else ''}{message}{got}{unit}"


def _unit_meant(settings: type[Settings], kind: str, place: PlaceOf) -> str:
    """Say in which units a quantity is given, if one out of its bounds was given as a number."""
    value = place.value.value if isinstance(place.value, Scalar) else None
    if kind not in _BOUNDS or isinstance(value, str | bool) or not value:  # 0 is 0 in any unit
        return ""
    steps = [step for step in place.path if not step.isdigit()]
    field = _field(settings, steps) if steps else None
    dimension = dimension_of(field) if field else ""
    return f"; expected {expected(dimension)}" if dimension else ""


def _field(settings: type[BaseModel], path: Sequence[str]) -> FieldInfo | None:
    """Return the field at a path, if it is one of settings within settings."""
    model = _model_at(settings, path[:-1])
    return None if model is None else model.model_fields.get(path[-1])


def _fields(settings: type[BaseModel], path: Sequence[str]) -> list[str]:
    """Return the names of the fields of the settings at a path."""
    model = _model_at(settings, path)
    return [] if model is None else list(model.model_fields)


def _model_at(settings: type[BaseModel], path: Sequence[str]) -> type[BaseModel] | None:
    """Return the settings class at a path."""
    model: Any = settings
    for step in path:
        field = None if step.isdigit() else model.model_fields.get(step)
        model = _model_in(field.annotation) if field else model
        if model is None:
            return None
    return cast(type[BaseModel], model)


def _model_in(annotation: Any) -> Any:
    """Return the settings class in an annotation such as `X`, `X | None` or `tuple[X, ...]`."""
    if isinstance(annotation, type) and not isinstance(annotation, types.GenericAlias):
        return annotation if issubclass(annotation, BaseModel) else None
    found = (_model_in(argument) for argument in typing.get_args(annotation))
    return next((model for model in found if model is not None), None)
