"""How long a process or a thread was ready to compute, but waited for a core."""

from pathlib import Path

_NS = 1e-9


def ready_s(process: int | str = "self", thread: int | None = None) -> float:
    """Return for how long it has waited for a core so far [s]; 0 where the system does not tell.

    Linux counts it for the main thread of a process and for each thread.

    Args:
        process: Its number; this one by default.
        thread: The system's number of a thread of it; the main thread by default.
    """
    task = "" if thread is None else f"/task/{thread}"
    try:
        _, waited_ns, _ = Path(f"/proc/{process}{task}/schedstat").read_text("ascii").split()
    except (OSError, ValueError):
        return 0.0
    return _NS * int(waited_ns)
