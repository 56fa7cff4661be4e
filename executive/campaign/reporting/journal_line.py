"""One entry of a journal as a line for a person."""

from collections.abc import Mapping
from typing import Any

from executive.campaign.reporting.wording import shortened

_WIDTH = 118  # fits a page without a break
_LONGEST_VALUE = 60  # longer ones are matrices, which say nothing in a line


def journal_line(time_s: float, kind: str, node: str, payload: Mapping[str, Any]) -> str:
    """Return time, kind, the node's last name, and the short values of an entry.

    Args:
        time_s: The mission's time [s].
        kind: Kind of the event.
        node: Path of the node.
        payload: Fields of the event.
    """
    told = {key: _told(value) for key, value in payload.items()}
    words = [f"{k}={v}" for k, v in told.items() if v and len(v) <= _LONGEST_VALUE]
    named = [leaf_name(node)] if node else []
    return shortened(f"{time_s:8.2f} s  {kind:16} {' '.join([*named, *words])}".rstrip(), _WIDTH)


def _told(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def leaf_name(node: str) -> str:
    """Return the name of a node without its place: `main/1:ScanSwing` → `ScanSwing`."""
    last = node.rpartition("/")[2]
    return last.partition(":")[2] or last
