"""One entry of a journal as a line for a person."""

from collections.abc import Mapping
from typing import Any

from executive.campaign.reporting.wording import shortened

_WIDTH = 160
_LONGEST_VALUE = 60  # longer ones are matrices, which say nothing in a line


def journal_line(time_s: float, kind: str, node: str, payload: Mapping[str, Any]) -> str:
    """Return time, kind, the node's last name, and the short values of an entry.

    Args:
        time_s: The mission's time [s].
        kind: Kind of the event.
        node: Path of the node.
        payload: Fields of the event.
    """
    told = {key: str(value) for key, value in payload.items()}
    words = [f"{k}={v}" for k, v in told.items() if v and len(v) <= _LONGEST_VALUE]
    line = f"{time_s:9.2f} s  {kind:18} {leaf_name(node):20} {' '.join(words)}"
    return shortened(line.rstrip(), _WIDTH)


def leaf_name(node: str) -> str:
    """Return the name of a node without its place: `main/1:ScanSwing` → `ScanSwing`."""
    last = node.rpartition("/")[2]
    return last.partition(":")[2] or last
