"""What the process of one run does: take its place, do the work, leave the answer, exit."""

import faulthandler
import os
import pickle
import resource
import signal
import socket
import sys
from pathlib import Path
from tempfile import TemporaryFile
from typing import NoReturn

from executive.campaign.execution.chosen_work import work_of
from executive.campaign.execution.disk_space import is_disk_full, is_space_left
from executive.campaign.execution.processes.fork_protocol import Begin, Ended, LastWord
from executive.campaign.execution.processes.process_ties import die_with, python_command
from executive.campaign.execution.run_answer import RunAnswer, fingerprint, write_answer
from executive.clock import wall_s
from executive.errors import ConfigError
from executive.interfaces.work import Piece

OUTPUT = "output.txt"  # what the run and its libraries printed
_LONGEST_REASON = 2000


def exec_run(asked: Begin, last_word: int) -> NoReturn:
    """Do a run in this process, which was forked for it, but import everything anew.

    A parent with several threads leaves its locks in whatever state they are to a forked process.
    """
    with TemporaryFile() as file:
        pickle.dump(asked, file)
        file.seek(0)
        os.dup2(file.fileno(), sys.stdin.fileno())
    os.set_inheritable(last_word, True)
    module = "executive.campaign.execution.processes.isolated_run"
    os.execv(sys.executable, python_command(module, str(last_word)))


def main(last_word: str) -> NoReturn:
    """Do the run that is on standard input."""
    run_and_exit(pickle.load(sys.stdin.buffer), int(last_word))


def run_and_exit(asked: Begin, last_word: int) -> NoReturn:
    """Do a run in this process, which was forked for it, and exit.

    Args:
        asked: The run.
        last_word: Descriptor that a pickled LastWord is written to.
    """
    word = LastWord(Ended.RAISED, "the run ended before it began")
    try:
        _take_place(asked.folder)
        word = _worked(asked)
        sys.stdout.flush()
        sys.stderr.flush()
    except BaseException as error:  # nothing may reach the server's loop in this copy of it
        word = _refusal(error, asked.folder)
    finally:
        os.write(last_word, pickle.dumps(word))
        os._exit(0 if word.ended is Ended.ANSWERED else 1)


def _take_place(folder: Path) -> None:
    """Become a session of its own that prints into the run's folder and dies with the server."""
    parent = os.getppid()
    os.setsid()
    die_with(parent)
    for number in (signal.SIGCHLD, signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_DFL)
    output = os.open(folder / OUTPUT, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644)
    os.dup2(output, sys.stdout.fileno())
    os.dup2(output, sys.stderr.fileno())
    os.close(output)
    faulthandler.enable()


def _worked(asked: Begin) -> LastWord:
    started_s = wall_s()
    try:
        work, arguments = work_of(asked.trial)
        answer = work.run(Piece(arguments, asked.trial.seed, asked.folder, asked.inputs))
        own = resource.getrusage(resource.RUSAGE_SELF)
        children = resource.getrusage(resource.RUSAGE_CHILDREN)
        write_answer(
            asked.folder,
            RunAnswer(
                trial=fingerprint(asked.trial),
                answer=answer,
                wall_s=wall_s() - started_s,
                cpu_s=own.ru_utime + own.ru_stime + children.ru_utime + children.ru_stime,
                peak_memory_bytes=own.ru_maxrss * 1024,
                worker=f"{socket.gethostname()}:{os.getpid()}",
            ),
        )
    except BaseException as error:  # whatever the work raises, SystemExit included
        return _refusal(error, asked.folder)
    return LastWord(Ended.ANSWERED)


def _refusal(error: BaseException, folder: Path) -> LastWord:
    sys.excepthook(type(error), error, error.__traceback__)  # with its traceback, into the output
    if is_disk_full(error) or not is_space_left(folder):  # many libraries hide the reason
        return LastWord(Ended.DISK_FULL, f"no space is left for {folder}")
    if isinstance(error, ConfigError):
        return LastWord(Ended.REFUSED, str(error)[:_LONGEST_REASON])
    said = f"{type(error).__name__}: {error}"[:_LONGEST_REASON]
    return LastWord(Ended.RAISED, f"{said} ({_place(error)})")


def _place(error: BaseException) -> str:
    """Return `file:line` where it was raised."""
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    return f"{trace.tb_frame.f_code.co_filename}:{trace.tb_lineno}" if trace else "no place"
