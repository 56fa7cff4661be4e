"""The executive's side of being supervised."""

import ctypes
import faulthandler
import os
import signal
import sys
import tempfile
import traceback
from collections.abc import Callable

from executive.supervision.beacon import Beacon, inherit
from executive.supervision.early_stop import STOPPING

_SIGNAL_AT_DEATH_OF_PARENT = 1  # PR_SET_PDEATHSIG of prctl(2)


def live(page: Beacon, run: Callable[[], int]) -> None:
    """Run something, note its exit status for the supervisor, and exit.

    A call stack is written when the process crashes, or when the supervisor asks for it. When the
    supervisor dies, the mission stops along its path, as after Ctrl-C.
    """
    inherit(page)
    stack = tempfile.NamedTemporaryFile(  # noqa: SIM115 - open as long as the process
        mode="w", prefix="executive-", suffix=".stack", delete=False
    )
    page.name(stack=stack.name)
    faulthandler.enable(stack)
    faulthandler.register(signal.SIGUSR2, stack, all_threads=False)
    ctypes.CDLL(None).prctl(_SIGNAL_AT_DEATH_OF_PARENT, signal.SIGTERM)
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
