"""Whether there is space for results: its lack is nobody's failure, but ends the campaign."""

import errno
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from executive.errors import ExecutiveError

_RESERVE_BYTES = 1 << 20  # less free space than this counts as none


class DiskFullError(ExecutiveError):
    """No space is left for results: it costs no run, but the campaign cannot go on."""


def is_space_left(folder: Path) -> bool:
    """Return whether something can still be written to the disk of a folder."""
    return shutil.disk_usage(folder).free >= _RESERVE_BYTES


def is_disk_full(error: BaseException) -> bool:
    """Return whether an error says that no space is left, or that a quota is used up."""
    return isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT)


@contextmanager
def disk_errors(path: Path) -> Iterator[None]:
    """Raise a DiskFullError that names the path instead of the system's error."""
    try:
        yield
    except OSError as error:
        if is_disk_full(error):
            raise DiskFullError(f"no space is left for {path}") from error
        raise
