"""Watches one executive: stops the machine when the loop is silent, and says why a run was cut off.

It is the parent of the executive's process, forked before anything heavy is imported, so that no
library that the executive uses can hold it up.
"""

import contextlib
import os
import signal
import sys
import time
from collections.abc import Callable

from executive.supervision.beacon import Beacon
from executive.supervision.cut_off import CutOff
from executive.supervision.early_stop import end_at_signals
from executive.supervision.link import MachineLink

_LOOK_S = 0.01  # between two looks at the beacon
# After a gap of that length between two looks the whole computer was held up, the loop as well: it
# gets its time anew. The machine counts the silence by itself.
_HELD_UP_S = 0.1
_LOST_S = 10.0  # a loop that stays silent so long after the stop, in no verb, is ended
_GRACE_S = 2.0  # for the executive to end an overdue verb by itself
_STACK_S = 0.2  # for the call stack of a process that hangs to be written
_EXIT_S = 15.0  # for a process to exit after its run is over
_FORWARDED = (signal.SIGTERM, signal.SIGHUP, signal.SIGUSR1)
_BY_A_PROCESS = 0  # si_code of a signal that kill(2) sent; Ctrl-C reaches both processes by itself


class Supervisor:
    """The watch over one child process."""

    def __init__(self, child: int, beacon: Beacon, say: Callable[[str], None]) -> None:
        self._child = child
        self._beacon = beacon
        self._say = say
        self._link = MachineLink()
        self._silent_since_s = 0.0
        self._over_s = 0.0
        self._looked_s = self._awake_since_s = time.monotonic()
        self.reason = ""  # why the machine was stopped

    def run(self) -> int:
        """Watch until the child has ended; return the exit status of the run."""
        waited = {signal.SIGCHLD, signal.SIGINT, *_FORWARDED}
        while True:
            found = signal.sigtimedwait(waited, _LOOK_S)
            if found is not None:
                self._forward(found)
            ended, status = os.waitpid(self._child, os.WNOHANG)
            if ended:
                return self._ended(os.waitstatus_to_exitcode(status))
            self._look()

    def _forward(self, found: signal.struct_siginfo) -> None:
        by_hand = found.si_signo == signal.SIGINT and found.si_code == _BY_A_PROCESS
        if found.si_signo in _FORWARDED or by_hand:
            with contextlib.suppress(ProcessLookupError):
                os.kill(self._child, found.si_signo)

    def _look(self) -> None:
        now_s = time.monotonic()
        if now_s - self._looked_s > _HELD_UP_S:
            self._awake_since_s = now_s
        self._looked_s = now_s
        self._link.keep(self._beacon.text("machine"))
        since_s = self._awake_since_s
        silent_s, age_s = self._beacon.silent_s(since_s), self._beacon.joints_age_s(since_s)
        if silent_s:
            self._stop(f"the executive's loop has been silent for {silent_s:.2f} s")
        elif age_s:
            self._stop(f"the newest joint sample is {age_s:.2f} s old")
        else:
            self._silent_since_s = 0.0
        is_lost = self._silent_since_s and now_s - self._silent_since_s > _LOST_S
        if self._beacon.overdue_s() > _GRACE_S:
            self._end_child("it did not end in time, and could not be interrupted")
        elif is_lost and not self._beacon.is_computing():
            self._end_child(self.reason)
        if self._beacon.status() is not None:
            self._over_s = self._over_s or now_s
            if now_s - self._over_s > _EXIT_S:
                os.kill(self._child, signal.SIGKILL)

    def _stop(self, reason: str) -> None:
        if self._silent_since_s:
            return
        self._silent_since_s, self.reason = time.monotonic(), reason
        told = self._link.stop(f"supervisor: {reason}")
        self._say(
            f"supervisor: {reason}; "
            + (
                "the machine was told to stop"
                if told
                else "no machine in another process is connected that could be told to stop"
            )
        )

    def _end_child(self, reason: str) -> None:
        """Let the child write its call stack, and kill it."""
        self.reason = reason
        with contextlib.suppress(ProcessLookupError):
            os.kill(self._child, signal.SIGUSR2)
            time.sleep(_STACK_S)  # noqa: TID251 - this process only waits
            os.kill(self._child, signal.SIGKILL)
        self._beacon.forget()

    def _ended(self, code: int) -> int:
        status = self._beacon.status()
        if status is not None:
            return status
        self._link.keep(self._beacon.text("machine"))
        cut_off = CutOff(self._beacon, code, self.reason)
        self._link.stop(f"supervisor: {cut_off.reason}")
        self._link.close()
        self._say(f"fault: {cut_off.reason}")
        cut_off.write_report()
        return 3


def supervised(run: Callable[[], int], say: Callable[[str], None]) -> int:
    """Run something in a child process under a supervisor; return its exit status."""
    page = Beacon()
    waited = {signal.SIGCHLD, signal.SIGINT, *_FORWARDED}
    signal.pthread_sigmask(signal.SIG_BLOCK, waited)
    sys.stdout.flush()
    sys.stderr.flush()
    child = os.fork()
    if child:
        return Supervisor(child, page, say).run()
    end_at_signals(page.finish)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, waited)
    from executive.supervision.child import live

    live(page, run)
    return 0  # never: `live` exits
