"""What every verb does in the same way: say something to people, answer machines, refuse input.

People's text goes to standard error and answers go to standard output, so that `--json` can be
piped. A refusal is a ConfigError, which the command line turns into a message and exit status 2.
"""

import contextlib
import json
import os
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from executive.errors import ConfigError, did_you_mean


def say(text: str, end: str = "\n") -> None:
    """Print a text for people, on standard error."""
    with contextlib.suppress(OSError):  # a closed pipe: nobody reads, and the work goes on
        print(text, end=end, file=sys.stderr, flush=True)


def answer(value: Any) -> None:
    """Print plain values as JSON, on standard output."""
    print(json.dumps(value, indent=2, ensure_ascii=False), flush=True)


def terminal_width() -> int | None:
    """Return the columns of the terminal on standard output; None for a pipe or a file."""
    return shutil.get_terminal_size().columns if sys.stdout.isatty() else None


def one_of(option: str, value: str, allowed: Sequence[str]) -> str:
    """Return a value if it is allowed.

    Raises:
        ConfigError: If it is not; it names the option and the nearest allowed value.
    """
    if value in allowed:
        return value
    hint = did_you_mean(value, allowed)
    if hint.startswith(";"):  # nothing is near: list what there is
        raise ConfigError(f"{option}: '{value}' is not one of {', '.join(allowed)}")
    raise ConfigError(f"{option}: '{value}' is unknown{hint}")


def check_output(
    option: str, path: Path | None, *suffixes: str, read: Sequence[Path | None] = ()
) -> None:
    """Refuse an output file that cannot be written, before anything is computed.

    Args:
        option: What it was given to, for messages.
        path: The file; None if none is wanted.
        suffixes: How its name may end.
        read: Files that the command reads: an output never takes the place of one.

    Raises:
        ConfigError: If its name ends otherwise, or `check_writable` refuses it.
    """
    if path is None:
        return
    if path.suffix.lower() not in suffixes or not path.parent.is_dir():
        kinds = " or ".join(suffixes)
        raise ConfigError(f"{option}: {path}: name a {kinds} file in a folder that exists")
    check_writable(option, path, read)


def check_writable(option: str, path: Path, read: Sequence[Path | None] = ()) -> None:
    """Refuse an output file of any name that cannot be written, or that the command reads.

    Raises:
        ConfigError: If its folder does not exist, it is a folder, a file that is read, or must not
            be written.
    """
    if not path.parent.is_dir():
        raise ConfigError(f"{option}: {path}: name a file in a folder that exists")
    if path.is_dir():
        raise ConfigError(f"{option}: {path} is a folder; name a file")
    if path.exists() and any(one and one.exists() and path.samefile(one) for one in read):
        raise ConfigError(f"{option}: {path} is a file that is read; name another file")
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise ConfigError(f"{option}: {path} cannot be written: permission denied")
