"""One core for a library whose result hangs on how many it finds."""

import os
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def one_core() -> Iterator[None]:
    """Let the calling thread see one core of those that it may use, until the block ends.

    A pool of threads that is made in here is made for one core, and stays so: sums come in one
    order.
    """
    allowed = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(allowed)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, allowed)
