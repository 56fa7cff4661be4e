"""The other end of the control socket: one request, one reply."""

import fcntl
import os
from pathlib import Path

from executive.control.place import connect
from executive.control.request import Reply, Request
from executive.errors import ConfigError, DataError
from executive.interfaces.report_file import REPORT, read_ending


def ask(folder: Path, request: Request, timeout_s: float) -> Reply:
    """Ask something of the run in a folder.

    Args:
        folder: The run's folder.
        request: What is asked.
        timeout_s: How long the reply is waited for [s]: in lock-step a tick may compute for long.

    Raises:
        ConfigError: If no run listens there, with what has become of it; or none answers in time.
        DataError: If the reply cannot be read.
    """
    try:
        connection = connect(folder, timeout_s)
    except OSError as error:
        raise ConfigError(_silent(folder, error)) from error
    with connection:
        try:
            connection.sendall(request.line())
            line = b""
            while not line.endswith(b"\n"):
                found = connection.recv(65536)
                if not found:
                    raise ConfigError(f"{folder}: the run ended before it answered")
                line += found
        except TimeoutError as error:
            raise ConfigError(
                f"{folder}: the run did not answer within {timeout_s:g} s; it may compute a long "
                "verb in its tick: wait longer (--timeout), or stop it by SIGTERM"
            ) from error
        except OSError as error:
            raise ConfigError(f"{folder}: the run ended before it answered") from error
    return Reply.read(line)


def _silent(folder: Path, error: OSError) -> str:
    """Say why nobody listens in a folder, and what to do."""
    if not folder.is_dir():
        return f"{folder} is no folder of a run"
    if isinstance(error, PermissionError):
        return f"{folder}: the run belongs to another user; only that user and root may control it"
    if not (folder / "journal.jsonl").exists():
        return f"{folder} holds no run"
    if _is_locked(folder):
        return f"{folder}: the run is starting or ending, and takes no requests then; ask again"
    outcome = _outcome(folder)
    if outcome:
        return f"{folder}: the run has ended ({outcome}); there is nothing to control"
    return f"{folder}: the run was cut off; `executive resume` lets it go on"


def _is_locked(folder: Path) -> bool:
    """Return whether a process writes into the folder."""
    try:
        opened = os.open(folder / "lock", os.O_RDONLY | os.O_CLOEXEC)
    except OSError:
        return False
    try:
        fcntl.flock(opened, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except OSError:
        return True
    finally:
        os.close(opened)
    return False


def _outcome(folder: Path) -> str:
    try:
        return read_ending(folder / REPORT).outcome
    except DataError:
        return ""
