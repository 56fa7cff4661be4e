"""The values that the leaves of one mission share, by key."""

from collections.abc import Mapping

from executive.errors import ConfigError, did_you_mean


class Store:
    """A mission's own keys: two missions in one process do not see each other."""

    def __init__(self, values: Mapping[str, object] | None = None) -> None:
        self._values: dict[str, object] = dict(values or {})

    def __contains__(self, key: str) -> bool:
        return key in self._values

    def get(self, key: str) -> object:
        """Return a value.

        Raises:
            ConfigError: If the key was never written; the message names the nearest key.
        """
        if key not in self._values:
            raise ConfigError(
                f"key '{key}' is read before it is written{did_you_mean(key, self._values)}"
            )
        return self._values[key]

    def set(self, key: str, value: object) -> None:
        """Write a value."""
        self._values[key] = value

    def keys(self) -> tuple[str, ...]:
        """Return all keys, in the order of their first writing."""
        return tuple(self._values)
