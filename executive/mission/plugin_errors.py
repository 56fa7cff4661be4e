"""Errors that escape plugins and leaves: which end the mission, and which are passed over."""

import logging
from collections.abc import Callable, Mapping
from typing import Any

from executive.events.event import Event
from executive.events.mission import Fault, PluginFailed
from executive.mission.fault import fault_of


class PluginErrors:
    """Knows which plugins the mission can do without (`on_error: fail`)."""

    def __init__(
        self,
        plugins: Mapping[str, Any],
        can_fail: frozenset[tuple[str, str]],
        record: Callable[[str, Event], None],
    ) -> None:
        self._plugins = plugins
        self._can_fail = can_fail
        self._record = record

    def fault_of(self, error: Exception, node: str = "", leaf: str = "") -> Fault:
        """Return what failed, and where."""
        return fault_of(error, self._plugins, node, leaf)

    def excuses(self, fault: Fault) -> bool:
        """Return whether the mission goes on; the error is then logged and recorded."""
        if (fault.capability, fault.name) not in self._can_fail:
            return False
        log(fault)
        self._record(fault.node, PluginFailed(fault))
        return True


def log(fault: Fault) -> None:
    """Write a fault with its traceback into the log."""
    logging.getLogger(__name__).error("%s\n%s", fault.summary, fault.traceback)
