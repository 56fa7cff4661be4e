"""How a process serves runs: each is a fork of it, which leads a group of processes of its own."""

import json
import os
from contextlib import suppress
from typing import Any

PIPES = "MUTANTS_PIPES"  # names the numbers of the pipes that ask and answer
REFUSED = 99  # status of a run that a server cannot do; no status of pytest


def asked_of_a_fork() -> dict[str, Any] | None:
    """Fork for each run that is asked for, one after the other.

    A first line says that this process is ready. A line asks for a run. Two lines answer: the id
    of its process, and its exit status once it has ended.

    Returns:
        In a fork: what it is asked for. In this process: None, once nothing more will be asked.
    """
    asks, answers = map(int, os.environ.pop(PIPES).split())
    for pipe in (asks, answers):
        os.set_inheritable(pipe, False)
    with os.fdopen(asks, "rb", buffering=0) as asked, os.fdopen(answers, "w") as answer:
        print("ready", file=answer, flush=True)
        while line := asked.readline():
            pid = os.fork()
            if pid == 0:
                os.setpgid(0, 0)
                wanted: dict[str, Any] = json.loads(line)
                return wanted
            with suppress(OSError):  # it may have done so itself
                os.setpgid(pid, pid)
            print(pid, file=answer, flush=True)
            _, ended = os.waitpid(pid, 0)
            print(os.waitstatus_to_exitcode(ended), file=answer, flush=True)
    return None
