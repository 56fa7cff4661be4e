"""Where in a plugin's code a computation is: from frames, or from what faulthandler wrote."""

import re
import sys
import traceback
from types import FrameType

from executive.interfaces.plugin import Plugin
from executive.mission.fault import place_of, shown

_LINE = re.compile(r'^  File "(?P<file>.+)", line (?P<line>\d+) in (?P<verb>\S+)', re.M)

Frames = list[tuple[FrameType, int]]  # outermost first, each with its line


def frames_of(error: BaseException) -> Frames:
    """Return the frames that an exception came through."""
    return list(traceback.walk_tb(error.__traceback__))


def frames_of_thread(number: int) -> Frames:
    """Return the frames of a running thread; none if it has ended."""
    frame = sys._current_frames().get(number)
    return [] if frame is None else list(traceback.walk_stack(frame))[::-1]


def place_among(frames: Frames, plugin: Plugin) -> tuple[str, str]:
    """Return `file:line` of the innermost frame of a plugin's package, and the stack as text."""
    stack = traceback.StackSummary.extract(iter(frames))
    return place_of(frames, type(plugin).__module__), "".join(stack.format())


def place_in_dump(text: str, plugin: Plugin) -> str:
    """Return `file:line` of a plugin's package in a dump of faulthandler; empty if it has none.

    The dump names the innermost call first. Without a line of the package, the innermost counts.
    """
    folder = folder_of(plugin)
    found = [(one["file"], one["line"]) for one in _LINE.finditer(text)]
    own = [one for one in found if folder and one[0].startswith(folder)]
    if not found:
        return ""
    file, line = (own or found)[0]
    return f"{shown(file)}:{line}"


def folder_of(plugin: Plugin) -> str:
    """Return the folder of a plugin's package, or its file if its module is in no package."""
    package = sys.modules.get(type(plugin).__module__.partition(".")[0])
    folders = [str(one) for one in getattr(package, "__path__", ())]
    return folders[0] if folders else str(getattr(package, "__file__", None) or "")
