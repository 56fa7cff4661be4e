"""One damaged file, read: what came of it, and what it cost."""

import contextlib
import io
import logging
import time
import traceback
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from executive.errors import ExecutiveError
from tests.hostile.damage import damaged
from tests.hostile.formats import Format, Sample

MOST_S, S_PER_BYTE = 2.0, 2e-6
MOST_BYTES, BYTES_PER_BYTE = 200_000_000, 2


@dataclass(frozen=True, slots=True)
class Answer:
    """What came of a file.

    Attributes:
        outcome: `read`, `refused`, `unnamed` (an error without the name of the file) or
            `traceback`.
        text: The error.
        size: Size of the file [byte].
        processor_s: Processor time, that of a confined reading included [s].
        added_bytes: Memory beyond that of before [byte].
    """

    outcome: str
    text: str
    size: int
    processor_s: float
    added_bytes: int

    def misses(self) -> list[str]:
        """Return which bounds it misses."""
        missed = [self.outcome] if self.outcome in ("traceback", "unnamed") else []
        if self.processor_s > MOST_S + S_PER_BYTE * self.size:
            missed.append("hang")
        if self.added_bytes > MOST_BYTES + BYTES_PER_BYTE * self.size:
            missed.append("memory")
        return missed


class _Confined(logging.Handler):
    """Adds up what confined readings used."""

    processor_s, added_bytes = 0.0, 0

    def emit(self, record: logging.LogRecord) -> None:
        if record.levelno == logging.DEBUG and isinstance(record.args, tuple):
            self.processor_s += record.args[1]
            self.added_bytes = max(self.added_bytes, record.args[2])


def damaged_content(kind: Format, content: bytes, seed: Sequence[int]) -> bytes:
    """Return the content of the file that belongs to a seed."""
    rng = np.random.default_rng(list(seed))
    changed = damaged(content, rng)
    return kind.mend(changed) if rng.integers(2) else changed


def attempt(kind: Format, sample: Sample, content: bytes) -> Answer:
    """Put content in the place of a good file and read it."""
    sample.file.write_bytes(content)
    confined = _Confined()
    logger = logging.getLogger("executive.confined.client")
    logger.setLevel(logging.DEBUG)
    logger.addHandler(confined)
    before_bytes, before_s = _restarted_peak(), time.process_time()
    outcome, text = "read", ""
    try:
        with warnings.catch_warnings(), contextlib.redirect_stderr(io.StringIO()):
            warnings.simplefilter("ignore")
            kind.read(sample.target)
    except ExecutiveError as error:
        outcome, text = "refused", str(error)
        names = (sample.file.name, sample.target.name)
        if kind.is_named and not any(name in text for name in names):
            outcome = "unnamed"
    except Exception:
        outcome, text = "traceback", traceback.format_exc()
    finally:
        logger.removeHandler(confined)
    spent_s = time.process_time() - before_s + confined.processor_s
    added = max(_status("VmHWM") - before_bytes, confined.added_bytes)
    return Answer(outcome, text, len(content), spent_s, added)


def _restarted_peak() -> int:
    """Begin to measure the largest memory anew; return the memory of now [byte]."""
    Path("/proc/self/clear_refs").write_text("5")
    return _status("VmRSS")


def _status(name: str) -> int:
    for line in Path("/proc/self/status").read_text(encoding="ascii").splitlines():
        if line.startswith(f"{name}:"):
            return 1024 * int(line.split()[1])
    raise KeyError(name)
