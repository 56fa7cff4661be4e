"""YAML files of plain values: those that describe machines and those that runs leave.

Mission and campaign files are read by `executive.tree.document`, which keeps the place of each
value.
"""

from pathlib import Path
from typing import Any

import yaml

from executive.errors import ConfigError

_MAX_BYTES = 10_000_000
MAX_DEPTH = 60  # the loader recurses
TOO_DEEP = f"nested more than {MAX_DEPTH} levels deep"


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
        if (at := too_deep_in_line(error)) is not None:
            raise ConfigError(f"{path}:{at}: {TOO_DEEP}") from None
        raise ConfigError(f"{path}: not readable as YAML: {error}") from None
    except ValueError as error:  # a date that does not exist, or a number of thousands of digits
        raise ConfigError(f"{path}: not readable as YAML: {error}; quote the text") from None


def too_deep_in_line(error: yaml.YAMLError) -> int | None:
    """Return the line in which the library itself met too deep a nesting; None for other errors.

    It looks ahead by a thousand characters, and newer versions then refuse a thousand brackets
    before they give the sixtieth.
    """
    if "nesting depth" not in str(error):
        return None
    mark = error.problem_mark if isinstance(error, yaml.MarkedYAMLError) else None
    return mark.line + 1 if mark else 1


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
        if depth > MAX_DEPTH:
            raise ConfigError(f"{path}:{line}: {TOO_DEEP}")
