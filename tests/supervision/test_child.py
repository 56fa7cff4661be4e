"""The executive under a supervisor: its status is noted, and it stops when the supervisor dies."""

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = """
import ctypes, os, sys
from executive.supervision.beacon import Beacon
from executive.supervision.child import live

PR_GET_PDEATHSIG = 2

def run():
    number = ctypes.c_int()
    ctypes.CDLL(None).prctl(PR_GET_PDEATHSIG, ctypes.byref(number))
    print("told at the supervisor's death:", number.value)
    print("stack:", os.path.exists(page.text("stack")), page.text("stack"))
    RUN

page = Beacon()
try:
    live(page, run)
finally:
    print("noted:", page.status(), flush=True)
"""


def lived(run):
    words = [sys.executable, "-c", PROGRAM.replace("RUN", run)]
    done = subprocess.run(words, capture_output=True, text=True, timeout=120)
    found = dict(line.split(": ", 1) for line in done.stdout.splitlines())
    return done, found


@pytest.mark.parametrize("status", [0, 1, 3])
def test_the_status_of_the_run_is_noted_and_that_of_the_process(status):
    done, found = lived(f"return {status}")
    assert (done.returncode, found["noted"]) == (status, str(status))


def test_it_is_told_to_stop_when_its_supervisor_dies():
    _, found = lived("return 0")
    assert int(found["told at the supervisor's death"]) == signal.SIGRTMIN


def test_an_abandoned_run_ends_at_once_with_a_report_of_what_it_was_in(tmp_path):
    run = f"""page.name(run_dir={str(tmp_path)!r}, mission="small")
    from executive.supervision.beacon import note_of
    page.enter(note_of({{"component": "behaviour 'Dig'", "name": "Dig", "node": "main/1:Dig"}}))
    from executive.supervision.child import abandon
    abandon("nobody watches")"""
    done, found = lived(run)
    assert done.returncode == 3
    assert "noted" not in found  # nothing is done any more, as after a crash
    assert "fault: behaviour 'Dig' failed: nobody watches" in done.stderr
    report = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))
    assert (report["outcome"], report["fault"]["node"]) == ("fault", "main/1:Dig")


def test_an_error_is_told_and_is_status_one():
    done, found = lived("raise KeyError('lost')")
    assert (done.returncode, found["noted"]) == (1, "1")
    assert "KeyError: 'lost'" in done.stderr


def test_the_file_of_the_call_stack_is_there_as_long_as_the_run():
    _, found = lived("return 0")
    is_there, path = found["stack"].split(" ", 1)
    assert is_there == "True"
    assert not Path(path).exists()


def test_at_exit_all_is_done_but_taking_the_interpreter_apart(tmp_path):
    """That takes a second for the objects of a mission."""
    run = f"""import atexit, threading, time
    class Torn:
        def __del__(self):
            print("torn: apart", flush=True)
    ctypes.torn = Torn()
    ctypes.left_open = open({str(tmp_path / "left_open")!r}, "w")
    ctypes.left_open.write("all of it")
    import gc
    gc.freeze()
    atexit.register(print, "at exit: done")
    threading.Thread(target=lambda: (time.sleep(0.2), print("thread: ended"))).start()
    return 3"""
    done, found = lived(run)
    assert done.returncode == 3
    assert (found["thread"], found["at exit"]) == ("ended", "done")
    assert "torn" not in found
    assert (tmp_path / "left_open").read_text(encoding="utf-8") == "all of it"
