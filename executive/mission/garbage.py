"""The memory of a run: no collection looks at what lives as long, and pages are given back."""

import ctypes
import gc
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext

# Between two returns of free memory [s]. What a minute of the loop leaves free is some 0.1 MB, and
# a return takes a few milliseconds.
RETURN_PERIOD_S = 60.0


@contextmanager
def left_alone(is_real_time: bool) -> Iterator[None]:
    """Let the collector look only at what is made from now on; on the wall clock return free pages.

    Modules, plugins and the tree are some 800,000 objects, which live as long as the run does. A
    collection that looks at all of them takes 0.2 s, in the middle of a tick; one that looks at
    what the loop has made takes a few milliseconds. In lock-step no tick can be late, so the
    garbage of the start is not looked for first, nor are pages returned.
    """
    if is_real_time:
        spare_what_is_made()
    else:
        gc.freeze()
    try:
        with _pages_returned() if is_real_time else nullcontext():
            yield
    finally:
        gc.unfreeze()


def spare_what_is_made() -> None:
    """Let the collector look only at what is made from now on."""
    gc.collect()
    gc.freeze()
    # Python collects all again when a quarter as many objects are new as the last collection has
    # left: those that are frozen must not count, or 200,000 objects of garbage are kept.
    gc.collect()


@contextmanager
def _pages_returned() -> Iterator[None]:
    """Return free memory again and again, in a thread."""
    ended = threading.Event()

    def work() -> None:
        while not ended.wait(RETURN_PERIOD_S):
            return_free_memory()

    thread = threading.Thread(target=work, name="return of free memory", daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


def return_free_memory() -> None:
    """Collect the garbage, and give free pages inside the heap back to the system.

    Python keeps up to 2,000 freed tuples of each size for later ones of that size, and a tuple that
    is made of an iterator never takes one of them: memory would grow for hours. A full collection
    empties these lists; of its own accord it comes twice an hour, since a loop makes little garbage
    in cycles. The C library gives back only what is free at the end of its heap: arrays and
    matrices of many sizes leave holes in between, and the heap would grow while no more is used.
    """
    gc.collect()
    trim = trimmer()
    if trim is not None:
        trim(0)


def trimmer() -> Callable[[int], int] | None:
    """Return the C library's function that gives free pages back; None where there is none."""
    function: Callable[[int], int] | None = getattr(ctypes.CDLL(None), "malloc_trim", None)
    return function
