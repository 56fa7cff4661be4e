"""A limit on the memory that a process may add to what it has."""

import resource
from pathlib import Path

_STATUS = Path("/proc/self/status")


class MemoryLimit:
    """Lets allocations fail, as a MemoryError, that exceed the present data size by more.

    The limit is that of the kernel on private writable memory (RLIMIT_DATA). It holds for all
    threads of the process until it is released.
    """

    def __init__(self, added_bytes: int) -> None:
        self._before = resource.getrlimit(resource.RLIMIT_DATA)
        wanted = _data_bytes() + added_bytes
        highest = [one for one in self._before if one != resource.RLIM_INFINITY]
        resource.setrlimit(resource.RLIMIT_DATA, (min([wanted, *highest]), self._before[1]))

    def release(self) -> None:
        """Restore the limit that was there before; a second time it does nothing."""
        resource.setrlimit(resource.RLIMIT_DATA, self._before)


def _data_bytes() -> int:
    for line in _STATUS.read_text(encoding="ascii").splitlines():
        if line.startswith("VmData:"):
            return int(line.split()[1]) * 1024
    return 0
