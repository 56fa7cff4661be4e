"""YAML files of plain values: those that describe machines and those that runs leave.

Mission and campaign files are read by `executive.tree.document`, which keeps the place of each
value.
"""

from pathlib import Path
from typing import Any

import yaml

from executive.errors import ConfigError

_MAX_BYTES = 10_000_000
_MAX_DEPTH = 60  # the loader recurses


def read_plain_yaml(path: Path) -> Any:
    """Return the document of a file.

    Raises:
        ConfigError: If it cannot be read: it is no UTF-8 text, no YAML, larger than 10 MB, nested
            too deeply, or has aliases, by which a few lines can stand for billions of values.
    """
    try:
        with path.open("rb") as file:
            data = file.read(_MAX_BYTES + 1)
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {error.strerror or error}") from error
    if len(data) > _MAX_BYTES:
        raise ConfigError(f"{path}: more than {_MAX_BYTES:,} bytes; give another file")
    try:
        text = data.decode("utf-8-sig")
        _check_events(path, text)
        return yaml.load(text, Loader=yaml.CSafeLoader)
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise ConfigError(
            f"{path}:{line}: not UTF-8 text (byte 0x{data[error.start]:02x}); save it as UTF-8"
        ) from None
    except yaml.YAMLError as error:
        raise ConfigError(f"{path}: not readable as YAML: {error}") from None
    except ValueError as error:  # a date that does not exist, or a number of thousands of digits
        raise ConfigError(f"{path}: not readable as YAML: {error}; quote the text") from None


def _check_events(path: Path, text: str) -> None:
    depth = 0
    for event in yaml.parse(text, Loader=yaml.CSafeLoader):
        line = event.start_mark.line + 1 if event.start_mark else 1
        if isinstance(event, yaml.AliasEvent):
            raise ConfigError(f"{path}:{line}: aliases (*) are refused; write the value out")
        if isinstance(event, yaml.CollectionStartEvent):
            depth += 1
        elif isinstance(event, yaml.CollectionEndEvent):
            depth -= 1
        if depth > _MAX_DEPTH:
            raise ConfigError(f"{path}:{line}: nested more than {_MAX_DEPTH} levels deep")
