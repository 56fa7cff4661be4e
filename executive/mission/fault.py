"""Where an error came from: the plugin or leaf, the verb, and the line of the author's code."""

import traceback
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from types import FrameType, TracebackType
from typing import Any

from executive.events.mission import Fault
from executive.interfaces.plugin import Plugin
from executive.leaf.action import Leaf
from executive.mission.assembly import selected_plugins

# Attribute of an exception that was raised in a worker process: the fault as it was found there,
# because an exception loses its frames on the way.
REMOTE = "executive_fault"


def fault_of(
    error: BaseException, plugins: Mapping[str, Any], node: str = "", leaf: str = ""
) -> Fault:
    """Return what failed.

    The plugin is the innermost one among the traceback's frames, for a plugin may call another; the
    place is the innermost frame of the package that the plugin or leaf belongs to, so that it names
    the author's line and not one of a library.

    Args:
        error: What was raised, with its traceback.
        plugins: The mission's plugins by capability.
        node: Path of the node that waited for the call; empty outside of the tree.
        leaf: Name of that node's behaviour.
    """
    remote: Fault | None = getattr(error, REMOTE, None)
    if remote is not None:
        return replace(remote, node=node)
    frames = list(_frames(error.__traceback__))
    owner = _owner(frames, plugins)
    if owner is not None:
        capability, name, plugin, verb = owner
        component, package = f"{capability} plugin '{name}'", type(plugin).__module__
    else:
        found = next((f.f_locals.get("self") for f, _ in frames if _is_leaf(f)), None)
        capability, name, verb = "", leaf, ""
        component = f"behaviour '{leaf}'" if leaf else "the mission"
        package = type(found).__module__ if found is not None else ""
    return Fault(
        component=component,
        capability=capability,
        name=name,
        verb=verb,
        node=node,
        error=f"{type(error).__name__}: {error}",
        place=place_of(frames, package),
        traceback="".join(traceback.format_exception(error)),
    )


def place_of(frames: list[tuple[FrameType, int]], module: str) -> str:
    """Return `file:line` of the innermost frame of a module's package, else of any."""
    package = module.partition(".")[0]
    own = [one for one in frames if _package(one[0]) == package] if package else []
    if not (own or frames):
        return ""
    frame, line = (own or frames)[-1]
    return f"{shown(frame.f_code.co_filename)}:{line}"


def _frames(trace: TracebackType | None) -> Iterator[tuple[FrameType, int]]:
    yield from traceback.walk_tb(trace)


def _owner(
    frames: list[tuple[FrameType, int]], plugins: Mapping[str, Any]
) -> tuple[str, str, Plugin, str] | None:
    """Return capability, name, plugin and verb of the innermost plugin among the frames."""
    known = {id(plugin): (c, name, plugin) for c, name, plugin in selected_plugins(plugins)}
    found: tuple[str, str, Plugin, str] | None = None
    for frame, _ in frames:
        own = known.get(id(frame.f_locals.get("self")))
        if own is not None and (found is None or found[2] is not own[2]):
            found = (*own, frame.f_code.co_name)
    return found


def _is_leaf(frame: FrameType) -> bool:
    return isinstance(frame.f_locals.get("self"), Leaf)


def _package(frame: FrameType) -> str:
    return str(frame.f_globals.get("__name__", "")).partition(".")[0]


def shown(file: str) -> str:
    """Return a file's path, relative to the current folder where it is within it."""
    path = Path(file)
    return str(path.relative_to(Path.cwd())) if path.is_relative_to(Path.cwd()) else file
