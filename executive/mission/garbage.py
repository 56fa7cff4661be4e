"""The garbage collector of Python, kept from delaying a tick."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def left_alone(is_real_time: bool) -> Iterator[None]:
    """Let the collector look only at what is made from now on.

    Modules, plugins and the tree are some 800,000 objects, which live as long as the run does. A
    collection that looks at all of them takes 0.2 s, in the middle of a tick; one that looks at
    what the loop has made takes a few milliseconds. In lock-step no tick can be late, and nothing
    is changed.
    """
    if not is_real_time:
        yield
        return
    gc.collect()
    gc.freeze()
    try:
        yield
    finally:
        gc.unfreeze()
