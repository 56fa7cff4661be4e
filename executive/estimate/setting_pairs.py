"""Settings written as `KEY=VALUE` pairs, and their validation."""

from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

import yaml
from pydantic import ValidationError

from executive.config import Settings
from executive.errors import ConfigError

S = TypeVar("S", bound=Settings)


def nested(pairs: Sequence[str]) -> dict[str, Any]:
    """Read `a.b=1` pairs as `{"a": {"b": 1}}`; values are YAML.

    Raises:
        ConfigError: If a pair has no key or no value, or the value is not YAML.
    """
    tree: dict[str, Any] = {}
    for pair in pairs:
        key, equals, text = pair.partition("=")
        if not equals or not key:
            raise ConfigError(f"'{pair}' is not KEY=VALUE")
        try:
            value = yaml.safe_load(text)
        except yaml.YAMLError:
            raise ConfigError(f"'{pair}': the value is not valid YAML") from None
        for part in reversed(key.split(".")):
            value = {part: value}
        tree = merged(tree, value)
    return tree


def merged(below: Mapping[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    """Return both mappings as one; where both have a value, the one of `above` is taken."""
    both = dict(below)
    for key, value in above.items():
        old = both.get(key)
        if isinstance(old, Mapping) and isinstance(value, Mapping):
            value = merged(old, value)
        both[key] = value
    return both


def validated(model: type[S], values: Mapping[str, Any], option: str) -> S:
    """Return the settings with these values.

    Raises:
        ConfigError: If a value is wrong; the message names the option and the setting.
    """
    try:
        return model.model_validate(values)
    except ValidationError as error:
        lines = [f"{option} {'.'.join(map(str, e['loc']))}: {e['msg']}" for e in error.errors()]
        raise ConfigError("\n".join(lines)) from None
