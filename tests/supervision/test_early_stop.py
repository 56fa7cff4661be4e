"""A signal while the program loads ends it with a message and the status of a stopped run."""

import os
import signal

import pytest

from executive.supervision.early_stop import STOPPING, TOLD, end_at_signals


@pytest.mark.parametrize("number", STOPPING)
def test_a_signal_while_the_program_loads_ends_it_without_a_traceback(number, tmp_path):
    with (tmp_path / "told").open("w+b") as told:
        child = os.fork()
        if child == 0:
            os.dup2(told.fileno(), 2)
            end_at_signals(lambda status: os.write(2, b"status %d\n" % status))
            os.kill(os.getpid(), number)
            signal.pause()
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        told.seek(0)
        assert (status, told.read().decode()) == (1, f"{TOLD}\nstatus 1\n")
