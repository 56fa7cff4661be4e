"""The process from which the processes of runs are forked: imports happen once, here.

It has one thread, so that a fork copies no lock that another thread holds. It serves one campaign
and ends with it: when the connection closes, every run is killed.
"""

import gc
import os
import pickle
import signal
import sys
import traceback
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait

import psutil

from executive.campaign.execution.chosen_work import work_of
from executive.campaign.execution.processes.fork_protocol import Begin, Begun, Exited, LastWord
from executive.campaign.execution.processes.isolated_run import exec_run, run_and_exit
from executive.campaign.execution.processes.process_ties import adopt_orphans, number_of_threads

_LONGEST_WORD_BYTES = 65536  # capacity of a pipe; a last word is far shorter


@dataclass(frozen=True, slots=True)
class _Child:
    run: int
    last_word: int  # descriptor that its last word is read from


class ForkServer:
    """Forks a process for each run that it is asked for, and reports how it ended."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._children: dict[int, _Child] = {}
        self._prepared: set[str] = set()

    def serve(self) -> None:
        """Serve until the campaign closes the connection or ends; then kill what still runs."""
        wake, signalled = os.pipe()
        os.set_blocking(wake, False)
        os.set_blocking(signalled, False)
        signal.signal(signal.SIGCHLD, lambda *_: None)
        signal.set_wakeup_fd(signalled, warn_on_full_buffer=False)
        try:
            while True:
                ready = wait([self._connection, wake])
                if wake in ready:
                    os.read(wake, 4096)
                    self._report_ended()
                if self._connection in ready:
                    self._begin(self._connection.recv())
        except (EOFError, ConnectionError):  # the campaign is gone
            pass
        except OSError:  # no process or memory is left for a fork; the campaign shows this text
            traceback.print_exc()
        finally:
            for descendant in psutil.Process().children(recursive=True):  # orphans of runs too
                with suppress(psutil.Error):
                    descendant.kill()

    def _begin(self, asked: Begin) -> None:
        self._prepare(asked)
        reading, writing = os.pipe()
        sys.stdout.flush()
        sys.stderr.flush()
        has_threads = number_of_threads() > 1
        pid = os.fork()
        if pid == 0:
            signal.set_wakeup_fd(-1)
            self._connection.close()
            for child in self._children.values():
                os.close(child.last_word)
            os.close(reading)
            if has_threads:
                exec_run(asked, writing)
            run_and_exit(asked, writing)
        os.close(writing)
        os.set_blocking(reading, False)
        self._children[pid] = _Child(asked.run, reading)
        self._connection.send(Begun(asked.run, pid))

    def _prepare(self, asked: Begin) -> None:
        key = f"{asked.trial.work} {sorted(asked.trial.arguments.items())!r}"
        if key in self._prepared:
            return
        self._prepared.add(key)
        with suppress(Exception):  # whatever it is, the run meets it again and reports it
            work, arguments = work_of(asked.trial)
            work.prepare(arguments, asked.inputs)
        gc.collect()
        gc.freeze()  # the collector of a child then leaves the shared pages alone

    def _report_ended(self) -> None:
        """Report every child that has ended; the rest of its group is killed first."""
        while (ended := _ended()) is not None:
            child = self._children.pop(ended, None)
            if child is not None:
                _kill_group(ended)  # before the number is released: it cannot be another's yet
            _, status, usage = os.wait4(ended, 0)
            if child is None:  # an orphan that a run has left to this process
                continue
            self._connection.send(
                Exited(
                    child.run,
                    os.waitstatus_to_exitcode(status),
                    usage.ru_utime + usage.ru_stime,
                    usage.ru_maxrss * 1024,
                    _last_word(child.last_word),
                )
            )


def _ended() -> int | None:
    try:
        found = os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOHANG | os.WNOWAIT)
    except ChildProcessError:
        return None
    return found.si_pid if found else None


def _kill_group(pid: int) -> None:
    with suppress(OSError):
        os.killpg(pid, signal.SIGKILL)


def _last_word(descriptor: int) -> LastWord | None:
    try:
        said = os.read(descriptor, _LONGEST_WORD_BYTES)
        word = pickle.loads(said) if said else None
    except (OSError, pickle.UnpicklingError, EOFError):
        return None
    finally:
        os.close(descriptor)
    return word if isinstance(word, LastWord) else None


def main(descriptor: str) -> None:
    """Serve the campaign at the other end of a connection."""
    adopt_orphans()
    ForkServer(Connection(int(descriptor))).serve()
    os._exit(0)
