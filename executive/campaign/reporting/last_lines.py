"""The end of a run's journal, or of its log, as lines for a person; damage does not stop it."""

import json
from pathlib import Path

from executive.campaign.reporting.journal_line import journal_line
from executive.campaign.reporting.wording import shortened
from executive.interfaces.report_file import REPORT

_BYTES = 32_768  # read from the end of a file
_WIDTH = 160


def last_lines(folder: Path, count: int = 8) -> list[str]:
    """Return the last lines of the journal, and those of what the run printed before it broke off.

    Args:
        folder: The run's folder.
        count: The largest number of lines of each.
    """
    lines = [_of_journal(line) for line in _end(folder / "journal.jsonl")[-count:]]
    if not (folder / REPORT).is_file():
        printed = [*_end(folder / "log.txt"), *_end(folder / "output.txt")]
        lines += [shortened(line, _WIDTH) for line in printed[-count:]]
    return lines


def _end(path: Path) -> list[str]:
    """Return the last whole lines of a file; none if it cannot be read."""
    try:
        with path.open("rb") as file:
            file.seek(0, 2)
            size = file.tell()
            file.seek(max(0, size - _BYTES))
            text = file.read().decode("utf-8", errors="replace")
    except OSError:
        return []
    lines = text.splitlines()
    if size > _BYTES:
        lines = lines[1:]  # the first one is cut
    return [line for line in lines if line.strip()]


def _of_journal(line: str) -> str:
    try:
        found = json.loads(line)
        return journal_line(found["time_s"], found["kind"], found["node"], found["payload"])
    except (ValueError, KeyError, TypeError, AttributeError):
        return shortened(line, _WIDTH) + "  (not a whole line)"
