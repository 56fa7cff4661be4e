"""What a process and its parent have to do with each other; on Linux, more than elsewhere."""

import ctypes
import os
import signal
import sys

import psutil

_PR_SET_PDEATHSIG = 1
_PR_SET_CHILD_SUBREAPER = 36


def die_with(parent: int) -> None:
    """Let the system kill this process when its parent ends.

    Args:
        parent: The parent's number before the fork: if it has ended since, the process exits.
    """
    _prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)


def adopt_orphans() -> None:
    """Become the parent of descendants whose own parent ends, so that none is left behind."""
    _prctl(_PR_SET_CHILD_SUBREAPER, 1)


def python_command(module: str, argument: str) -> list[str]:
    """Return the command of `main(argument)` of a module, in a new Python with the same path.

    `python -m` would search the current folder first, and take any `queue.py` there for Python's.
    """
    code = f"import sys; sys.path[:] = {sys.path!r}; from {module} import main; main(sys.argv[1])"
    return [sys.executable, "-c", code, argument]


def number_of_threads() -> int:
    """Return the number of threads of this process, those of libraries included."""
    return int(psutil.Process().num_threads())


def _prctl(option: int, value: int) -> None:
    if sys.platform == "linux":
        ctypes.CDLL(None, use_errno=True).prctl(option, value, 0, 0, 0)
