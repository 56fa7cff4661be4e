"""The executive's side of being supervised."""

import atexit
import contextlib
import ctypes
import faulthandler
import gc
import io
import os
import signal
import sys
import tempfile
import traceback
from collections.abc import Callable
from typing import NoReturn

from executive.supervision.beacon import Beacon, beacon, inherit
from executive.supervision.cut_off import CutOff
from executive.supervision.early_stop import STOPPING

# Sent when the supervisor dies. Without a handler, as while the program loads, it ends the process.
ORPHANED = signal.SIGRTMIN
_SIGNAL_AT_DEATH_OF_PARENT = 1  # PR_SET_PDEATHSIG of prctl(2)
_STATUS = 3  # of a run that an error ended
_STANDARD_ERROR = 2
_WRITERS = (io.TextIOWrapper, io.BufferedWriter, io.BufferedRandom)


def live(page: Beacon, run: Callable[[], int]) -> None:
    """Run something, note its exit status for the supervisor, and exit.

    A call stack is written when the process crashes, or when the supervisor asks for it. When the
    supervisor dies, the machine is told to stop and the run is left as after a crash: `abandon`.
    """
    inherit(page)
    atexit.register(_leave, page)  # before all others, so that it is called after them
    stack = tempfile.NamedTemporaryFile(  # noqa: SIM115 - open as long as the process
        mode="w", prefix="executive-", suffix=".stack", delete=False
    )
    page.name(stack=stack.name)
    faulthandler.enable(stack)
    faulthandler.register(signal.SIGUSR2, stack, all_threads=False)
    ctypes.CDLL(None).prctl(_SIGNAL_AT_DEATH_OF_PARENT, ORPHANED)
    try:
        status = run()
    except BaseException:  # the traceback goes to the terminal, as without a supervisor
        traceback.print_exc()
        status = 1
    for number in STOPPING:  # the run is over: its status stands
        signal.signal(number, signal.SIG_IGN)
    page.finish(status)
    os.unlink(stack.name)
    sys.exit(status)


def _leave(page: Beacon) -> None:
    """End the process of a run that is over, without taking the interpreter apart.

    That takes a second for the objects of a mission, which the system frees at once. Threads have
    ended, and what libraries and plugins do at exit is done; files that one of them left open are
    written out, as the interpreter would.
    """
    status = page.status()
    if status is None:
        return
    gc.unfreeze()  # what a run keeps out of the collections
    for one in gc.get_objects():
        if type(one) in _WRITERS and not one.closed:
            with contextlib.suppress(OSError, ValueError):
                one.flush()
    os._exit(status)


def abandon(reason: str) -> NoReturn:
    """End this process as a crash would, so that its run can be resumed, and report why.

    The journal gets no end, and leaves are not halted: what they would write had not happened when
    the run was cut off.
    """
    cut_off = CutOff(beacon(), _STATUS, reason)
    cut_off.write_report()
    with contextlib.suppress(OSError):  # a terminal that is closed
        os.write(_STANDARD_ERROR, f"fault: {cut_off.reason}\n".encode())
    os._exit(_STATUS)
