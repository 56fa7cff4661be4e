"""How much memory and processor time the reading of a file may take, by the file's size."""

from dataclasses import dataclass
from pathlib import Path

# What a reader needs besides the file: the points that are kept, and what sorts them.
_LEAST_BYTES = 200_000_000
_BYTES_PER_BYTE = 2
# A damaged file is noticed within this time.
_LEAST_S = 2.0
# LAZ is unpacked at 18 MB/s on one core of 2.5 GHz; 36 times slower is still a working computer.
_BYTES_PER_S = 0.5e6
# On the wall a reader may wait for a slow disk or a busy processor.
_WALL_LEAST_S, _WALL_FACTOR = 60.0, 20.0


@dataclass(frozen=True, slots=True)
class Allowance:
    """Limits of the process that reads one file.

    Attributes:
        file_bytes: Size of the file.
        memory_bytes: Memory that reading may add to what the process has before.
        processor_s: Processor time [s].
        wall_s: Time until the process is given up [s].
    """

    file_bytes: int
    memory_bytes: int
    processor_s: float
    wall_s: float

    @classmethod
    def of(cls, path: Path) -> "Allowance":
        """Return the limits for a file.

        Raises:
            OSError: If there is no such file.
        """
        size = path.stat().st_size
        processor_s = _LEAST_S + size / _BYTES_PER_S
        return cls(
            size,
            _LEAST_BYTES + _BYTES_PER_BYTE * size,
            processor_s,
            _WALL_LEAST_S + _WALL_FACTOR * processor_s,
        )
