"""Breakpoints: the tree waits at a node, and the mission is paused, until it is unlocked.

A node that waits looks to its parent as one that runs. In BehaviorTree.CPP a breakpoint blocks the
thread that ticks, and is unlocked when the monitor is gone; here the loop goes on, the machine is
held as in any pause, and it stays held until somebody unlocks it or resumes the mission.
"""

import threading
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.mission.groot.protocol import GrootError
from executive.mission.wishes import Wishes
from executive.tree.leaf_nodes import RunNode
from executive.tree.orders import Order

BEFORE, AFTER = 0, 1
_BREAKPOINT = 0  # mode; the other replaces the node
BY = "a Groot2 client"


@dataclass(eq=False, slots=True)
class Breakpoint:
    """A breakpoint of one node.

    Attributes:
        uid: Number of the node.
        node: The node.
        position: Before it begins, or after it has ended.
        is_enabled: It holds the tree.
        is_once: It is removed when it was unlocked.
        is_reached: The tree has come to wait here, and nobody has unlocked it.
    """

    uid: int
    node: Behaviour
    position: int
    is_enabled: bool = True
    is_once: bool = False
    is_reached: bool = False

    @property
    def is_held(self) -> bool:
        """Whether the tree waits here; not if the node was cancelled meanwhile."""
        return self.is_reached and _looks_running(self.node)

    @property
    def place(self) -> str:
        """Return where it is, for people."""
        return f"{'before' if self.position == BEFORE else 'after'} {self.node.path}"

    def as_json(self) -> dict[str, Any]:
        """Return it as the protocol has it."""
        return {
            "enabled": self.is_enabled,
            "uid": self.uid,
            "mode": _BREAKPOINT,
            "once": self.is_once,
            "desired_status": "SKIPPED",
            "position": self.position,
        }


class Breakpoints:
    """The breakpoints of a tree; may be called from another thread than the one that ticks it.

    Attributes:
        told: What was done, for the journal: what, and where.
    """

    def __init__(
        self,
        node: Callable[[int], Behaviour | None],
        wishes: Wishes,
        reached: Callable[[int], None],
    ) -> None:
        """Begin with none.

        Args:
            node: Gives a node by its number.
            wishes: What people want of the mission.
            reached: Called with a node's number when the tree waits there.
        """
        self._node = node
        self._wishes = wishes
        self._reached = reached
        self._lock = threading.Lock()
        self._reason = ""  # of the pause that they asked for
        self._all: dict[tuple[int, int], Breakpoint] = {}
        self._results: dict[Behaviour, Status] = {}  # of nodes after which the tree waits
        self.told: deque[tuple[str, str]] = deque()

    def insert(self, wanted: dict[str, Any]) -> None:
        """Insert one, or change the one that is there.

        Raises:
            GrootError: If there is no such node, or it is to be replaced.
        """
        uid, position = _number(wanted, "uid"), _position(wanted)
        node = self._node(uid)
        if node is None:
            raise GrootError("Node ID not found")
        if wanted.get("mode", _BREAKPOINT) != _BREAKPOINT:
            raise GrootError("a node of a machine's mission cannot be replaced by a result")
        with self._lock:
            found = self._all.setdefault((uid, position), Breakpoint(uid, node, position))
            found.is_once = bool(wanted.get("once", False))
            self._enable(found, is_enabled=bool(wanted.get("enabled", True)))
            self._wrap(node)
        self.told.append(("breakpoint", found.place))

    def remove(self, wanted: dict[str, Any]) -> None:
        """Remove one; the tree goes on if it waits there.

        Raises:
            GrootError: If there is none.
        """
        with self._lock:
            self._remove(self._found(wanted))

    def remove_all(self) -> None:
        """Remove all."""
        with self._lock:
            for found in list(self._all.values()):
                self._remove(found)

    def disable_all(self) -> None:
        """Keep all, and hold the tree at none."""
        with self._lock:
            for found in self._all.values():
                self._enable(found, is_enabled=False)

    def unlock(self, wanted: dict[str, Any]) -> None:
        """Let the tree go on at one.

        Raises:
            GrootError: If there is none, or the node is to end in a way that it cannot.
        """
        with self._lock:
            found = self._found(wanted)
            self._end_as(found, str(wanted.get("desired_status", "SKIPPED")))
            if wanted.get("remove_when_done"):
                found.is_once = True
            self._let_go(found)
        self.told.append(("unlock", found.place))

    def as_json(self) -> list[dict[str, Any]]:
        """Return all as the protocol has them."""
        with self._lock:
            return [one.as_json() for one in self._all.values()]

    # --- inside

    def _found(self, wanted: dict[str, Any]) -> Breakpoint:
        found = self._all.get((_number(wanted, "uid"), _position(wanted)))
        if found is None:
            raise GrootError("Node ID not found")
        return found

    def _end_as(self, found: Breakpoint, status: str) -> None:
        """Let the node end as the client wants: an action before its beginning may be skipped."""
        if status in ("SKIPPED", "IDLE"):  # as it is
            return
        node, refused = found.node, "only an action that has not begun can be answered for"
        if status == "SUCCESS" and isinstance(node, RunNode) and found.position == BEFORE:
            refused = node.order(Order("skip", BY))
        if refused:
            raise GrootError(refused)

    def _enable(self, found: Breakpoint, *, is_enabled: bool) -> None:
        found.is_enabled = is_enabled
        if not is_enabled:
            self._let_go(found)

    def _remove(self, found: Breakpoint) -> None:
        self._let_go(found)
        self._all.pop((found.uid, found.position), None)
        self.told.append(("no breakpoint", found.place))

    def _let_go(self, found: Breakpoint) -> None:
        """Let the tree go on, once it waits nowhere else; not if a person has paused it as well."""
        was_held, found.is_reached = found.is_held, False
        is_last = not any(one.is_held for one in self._all.values())
        if was_held and is_last and self._wishes.pause == self._reason:
            self._wishes.go_on(BY)

    # --- in the tick

    def _wrap(self, node: Behaviour) -> None:
        """Let a node ask for its breakpoints whenever it is ticked from now on."""
        if "tick" in vars(node):
            return
        original = node.tick

        def tick() -> Iterator[Behaviour]:
            if self._waits_before(node):
                yield node
                return
            ended = self._given_back(node)
            if ended is not None:
                node.status = ended
                yield node
                return
            yield from original()
            self._wait_after(node)

        vars(node)["tick"] = tick

    def _waits_before(self, node: Behaviour) -> bool:
        """Return whether the tree waits before a node: once each time that it begins."""
        with self._lock:
            found = self._of(node, BEFORE)
            if node.status is not Status.RUNNING:
                self._results.pop(node, None)
                if found is None or not found.is_enabled:
                    return False
                self._hold(found)
                return True
            if _looks_running(node) and node not in self._results:
                node.status = Status.INVALID  # the tree has waited, and the node begins
                self._pass(found)
            return False

    def _wait_after(self, node: Behaviour) -> None:
        with self._lock:
            found = self._of(node, AFTER)
            if found is not None and found.is_enabled and node.status is not Status.RUNNING:
                self._results[node] = node.status
                self._hold(found)

    def _given_back(self, node: Behaviour) -> Status | None:
        """Return how a node ended after which the tree has waited."""
        with self._lock:
            if not _looks_running(node) or node not in self._results:
                return None
            self._pass(self._of(node, AFTER))
            return self._results.pop(node)

    def _of(self, node: Behaviour, position: int) -> Breakpoint | None:
        for one in self._all.values():
            if one.node is node and one.position == position:
                return one
        return None

    def _hold(self, found: Breakpoint) -> None:
        found.node.status = Status.RUNNING
        found.is_reached = True
        self._reason = f"breakpoint {found.place}"
        self._wishes.hold(self._reason)
        self._reached(found.uid)

    def _pass(self, found: Breakpoint | None) -> None:
        """Note that the tree goes on, whoever let it."""
        if found is None:
            return
        found.is_reached = False
        if found.is_once:
            self._all.pop((found.uid, found.position), None)


def _looks_running(node: Behaviour) -> bool:
    """Return whether a node waits, and only looks to its parent as if it ran."""
    return node.status is Status.RUNNING and not node.is_under_way


def _number(wanted: dict[str, Any], name: str) -> int:
    found = wanted.get(name)
    if not isinstance(found, int) or isinstance(found, bool):
        raise GrootError(f"'{name}' must be a whole number")
    return found


def _position(wanted: dict[str, Any]) -> int:
    found = _number(wanted, "position")
    if found not in (BEFORE, AFTER):
        raise GrootError("'position' is 0 (before) or 1 (after)")
    return found
