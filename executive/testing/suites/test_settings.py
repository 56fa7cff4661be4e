"""The settings of every plugin: described, bounded, frozen, and nothing unknown taken."""

import json
import pickle
from collections.abc import Iterator

import pytest
from pydantic import ValidationError
from pydantic.fields import FieldInfo

from executive.config import Settings
from executive.testing.subject import Subject

BOUNDS = ("gt", "ge", "lt", "le")


def fields_of(settings: type[Settings], path: str = "") -> Iterator[tuple[str, FieldInfo]]:
    """Yield every field with its path, those of nested settings included."""
    for name, field in settings.model_fields.items():
        yield f"{path}{name}", field
        if isinstance(field.annotation, type) and issubclass(field.annotation, Settings):
            yield from fields_of(field.annotation, f"{path}{name}.")


def test_its_settings_are_a_settings_class(subject: Subject) -> None:
    settings = subject.plugin_class.Settings
    assert issubclass(settings, Settings), "Settings must derive from executive.config.Settings"


def test_its_settings_have_defaults_or_were_given(subject: Subject) -> None:
    assert isinstance(subject.settings, subject.plugin_class.Settings)


def test_its_settings_are_frozen(subject: Subject) -> None:
    settings = subject.settings
    for name in type(settings).model_fields:
        with pytest.raises(ValidationError):
            setattr(settings, name, getattr(settings, name))


def test_its_settings_refuse_an_unknown_field(subject: Subject) -> None:
    written = json.loads(subject.settings.model_dump_json())
    with pytest.raises(ValidationError):
        subject.plugin_class.Settings.model_validate({**written, "no_such_setting": 1})


def test_each_setting_is_described(subject: Subject) -> None:
    missing = [
        path
        for path, field in fields_of(subject.plugin_class.Settings)
        if not (field.description or "").strip()
    ]
    assert not missing, f"no description: {', '.join(missing)}"


def test_each_number_has_a_bound(subject: Subject) -> None:
    free = [
        path
        for path, field in fields_of(subject.plugin_class.Settings)
        if is_number(field.annotation) and not is_bounded(field)
    ]
    assert not free, f"no bound (gt, ge, lt or le): {', '.join(free)}"


def test_its_settings_have_a_json_schema(subject: Subject) -> None:
    schema = subject.plugin_class.Settings.model_json_schema()
    json.dumps(schema)
    assert schema["type"] == "object"
    assert schema.get("additionalProperties") is False


def test_its_settings_survive_a_mission_file_and_a_pickle(subject: Subject) -> None:
    settings = subject.settings
    assert pickle.loads(pickle.dumps(settings)) == settings
    again = type(settings).model_validate_json(settings.model_dump_json(), strict=True)
    assert again == settings


def is_number(annotation: object) -> bool:
    """Return whether a field holds one number, or may hold none."""
    return annotation in (int, float, int | None, float | None)


def is_bounded(field: FieldInfo) -> bool:
    """Return whether a field has a lower or an upper bound."""
    return any(getattr(one, bound, None) is not None for one in field.metadata for bound in BOUNDS)
