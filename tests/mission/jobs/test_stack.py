"""The frames of a thread that hangs tell where it does."""

import sys
import threading
from types import SimpleNamespace

import pytest

from executive.mission.jobs.stack import folder_of, frames_of_thread, place_in_dump


def test_the_frames_of_a_thread_come_outermost_first_and_those_of_an_ended_one_are_none() -> None:
    begun, end = threading.Event(), threading.Event()

    def hangs() -> None:
        begun.set()
        end.wait()

    thread = threading.Thread(target=hangs)
    thread.start()
    assert begun.wait(20)
    names = [frame.f_code.co_name for frame, _ in frames_of_thread(thread.ident)]
    end.set()
    thread.join(20)
    assert names[0] == "_bootstrap"
    assert "hangs" in names[1:]
    assert frames_of_thread(thread.ident) == []


DUMP = """Fatal Python error: Segmentation fault

Current thread 0x00007f (most recent call first):
  File "/opt/numpy/linalg.py", line 12 in solve
  File "{own}/motion/planner.py", line 34 in move
  File "{own}/motion/other.py", line 56 in begin
"""


class Plugin:
    """One of a package that is made up."""


@pytest.fixture
def package(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    found = SimpleNamespace(__path__=["/opt/walls_of_mine"], __file__="/opt/walls_of_mine/init.py")
    monkeypatch.setitem(sys.modules, "walls_of_mine", found)
    monkeypatch.setattr(Plugin, "__module__", "walls_of_mine.motion.planner")
    return found


def test_the_place_in_a_dump_is_the_innermost_line_of_the_plugin_s_package(package) -> None:
    dump = DUMP.format(own="/opt/walls_of_mine")
    assert place_in_dump(dump, Plugin()) == "/opt/walls_of_mine/motion/planner.py:34"
    others = DUMP.format(own="/opt/others")
    assert place_in_dump(others, Plugin()) == "/opt/numpy/linalg.py:12"
    assert place_in_dump("", Plugin()) == ""


def test_a_module_in_no_package_is_its_own_folder(package) -> None:
    assert folder_of(Plugin()) == "/opt/walls_of_mine"
    del package.__path__
    assert folder_of(Plugin()) == "/opt/walls_of_mine/init.py"
    package.__file__ = None
    assert folder_of(Plugin()) == ""
    assert place_in_dump(DUMP.format(own="/opt/others"), Plugin()) == "/opt/numpy/linalg.py:12"
