"""Whether there is space for results: its lack is nobody's failure, but ends the campaign."""

import shutil
from pathlib import Path

from executive.errors import ExecutiveError

_RESERVE_BYTES = 1 << 20  # less free space than this counts as none


class DiskFullError(ExecutiveError):
    """No space is left for results: it costs no run, but the campaign cannot go on."""


def is_space_left(folder: Path) -> bool:
    """Return whether something can still be written to the disk of a folder."""
    return shutil.disk_usage(folder).free >= _RESERVE_BYTES
