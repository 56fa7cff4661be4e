"""Hosts of the pose graph: inline with the scans, or in a separate process."""

import logging
import multiprocessing
import signal
import time
from abc import ABC, abstractmethod
from collections import deque
from multiprocessing.connection import Connection

from executive_plugins.mapping.pair_graph import PairGraph, PairNode, Poses

_log = logging.getLogger(__name__)
_LEAVE_S = 1.0  # time for a child to end by itself
_SPAWN_S = 30.0  # time for a child to import its modules


class GraphHost(ABC):
    """Adds nodes to a graph and returns new poses, without blocking for long."""

    @abstractmethod
    def add(self, node: PairNode) -> None:
        """Hand a node over."""

    @abstractmethod
    def take(self) -> Poses | None:
        """Return the newest poses, once; None if there are no new ones."""

    @abstractmethod
    def close(self) -> None:
        """Release all resources."""


class InlineGraph(GraphHost):
    """Solves at once; the result is deterministic."""

    def __init__(self, window: int) -> None:
        self._graph = PairGraph(window)
        self._poses: Poses | None = None

    def add(self, node: PairNode) -> None:
        self._poses = self._graph.add(node)

    def take(self) -> Poses | None:
        poses, self._poses = self._poses, None
        return poses

    def close(self) -> None:
        """Do nothing: this host holds no resources."""


class ProcessGraph(GraphHost):
    """Solves in a child process, since GTSAM holds the interpreter's lock during a whole update.

    One batch is under way at a time. A child that has died or has not answered in time, by the wall
    clock, is replaced. The next one starts at the first node without an answer, at the pose of the
    state estimate.

    Attributes:
        restarts: Number of children that were replaced.
    """

    def __init__(self, window: int, answer_within_s: float) -> None:
        self._window = window
        self._answer_within_s = answer_within_s
        self.restarts = 0
        self._sent: list[PairNode] = []
        self._waiting: deque[PairNode] = deque()
        self._spawn()

    def _spawn(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._connection, theirs = context.Pipe()
        self.child = context.Process(target=_serve, args=(theirs, self._window), daemon=True)
        self.child.start()
        theirs.close()
        # The child answers once when it is ready.
        self._deadline_s: float | None = time.monotonic() + _SPAWN_S

    def add(self, node: PairNode) -> None:
        self._waiting.append(node)

    def take(self) -> Poses | None:
        try:
            poses = self._receive()
            if self._deadline_s is None and self._waiting:
                self._send()
        except (EOFError, OSError):
            self._replace("died")
            return None
        if self._deadline_s is not None and time.monotonic() > self._deadline_s:
            self._replace("does not answer")
        return poses

    def _receive(self) -> Poses | None:
        if self._deadline_s is None or not self._connection.poll():
            return None
        poses: Poses | None = self._connection.recv()
        self._deadline_s = None
        self._sent = []
        return poses

    def _send(self) -> None:
        self._sent = list(self._waiting)
        self._waiting.clear()
        self._connection.send(self._sent)
        self._deadline_s = time.monotonic() + self._answer_within_s

    def _replace(self, reason: str) -> None:
        _log.warning(
            "the process of the map's graph %s; a new one starts at the next scan pair", reason
        )
        self.restarts += 1
        self._waiting.extendleft(reversed(self._sent))
        self._sent = []
        self._end()
        self._spawn()

    def _end(self) -> None:
        self._connection.close()
        self.child.kill()
        self.child.join()

    def close(self) -> None:
        if self._deadline_s is None and self.child.is_alive():
            self._connection.send([])
            self.child.join(_LEAVE_S)
        self._end()


def _serve(connection: Connection, window: int) -> None:
    """Answer batches of nodes with the window's poses, until an empty batch or the parent's end."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's to handle
    graph = PairGraph(window)
    connection.send(None)
    while True:
        try:
            nodes: list[PairNode] = connection.recv()
        except EOFError:
            return
        if not nodes:
            return
        for node in nodes:
            poses = graph.add(node)
        connection.send(poses)
