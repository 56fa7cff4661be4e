"""Nodes of the language itself that call no plugin: wait, set, call, do."""

from collections.abc import Mapping
from dataclasses import dataclass

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.leaf.runtime import Runtime
from executive.leaf.store import Store
from executive.tree.key_source import Literally, Ref, Source
from executive.tree.modifiers import EPSILON_S
from executive.tree.node_kinds import Call
from executive.tree.nodes import Controller, Steps
from executive.tree.wiring import Scope


class GroupNode(Controller):
    """One child, so that it can be given modifiers from outside."""

    is_journalled = False

    def proceed(self) -> Steps:
        yield from self.children[0].tick()
        return self.adopt(self.children[0])


class WaitNode(Controller):
    """Succeeds when so much of the mission's time has passed."""

    def __init__(self, name: str, path: str, runtime: Runtime, duration_s: float) -> None:
        super().__init__(name, path, runtime)
        self._duration_s = duration_s
        self._started_s = 0.0

    def begin(self) -> None:
        self._started_s = self.runtime.clock.now_s()
        self.runtime.due(self._started_s + self._duration_s)

    def proceed(self) -> Steps:
        yield from ()
        left_s = self._duration_s - (self.runtime.clock.now_s() - self._started_s)
        self.feedback_message = f"{max(left_s, 0.0):.1f} s left" if left_s > EPSILON_S else ""
        return Status.RUNNING if left_s > EPSILON_S else Status.SUCCESS


class SetNode(Controller):
    """Writes literals, or copies of other keys, into the store."""

    def __init__(
        self, name: str, path: str, runtime: Runtime, values: Mapping[str, Source], scope: Scope
    ) -> None:
        super().__init__(name, path, runtime)
        self._values = values
        self._is_literal = all(isinstance(one, Literally) for one in values.values())
        self._scope = scope

    def proceed(self) -> Steps:
        yield from ()
        fetched = {key: self._scope.value(source) for key, source in self._values.items()}
        for key, value in fetched.items():
            self._scope.store.set(key, value)
        if self.is_repeated and not self._is_literal:  # the next tick may give another value
            self.runtime.due(self.runtime.clock.now_s())
        return Status.SUCCESS


@dataclass(frozen=True, slots=True)
class CallFrame:
    """The stores on both sides of a call, and what is carried between them."""

    kind: Call
    optional: frozenset[str]  # inputs that may be missing
    outer: Scope
    inner: Scope

    def enter(self) -> None:
        """Begin with an empty store and carry the inputs in."""
        sources = self.kind.inputs.items()
        self.inner.store = Store(
            {port: self.outer.value(s) for port, s in sources if not self._is_absent(port, s)}
        )

    def leave(self) -> None:
        """Carry the outputs out, as far as they were written."""
        for port, ref in self.kind.outputs.items():
            if port in self.inner.store:
                self.outer.store.set(ref.key, self.inner.store.get(port))

    def _is_absent(self, port: str, source: Source) -> bool:
        return (
            port in self.optional and isinstance(source, Ref) and source.key not in self.outer.store
        )


class CallNode(Controller):
    """A subtree with its own store: inputs are copied in at the start, outputs out at the end.

    What a cancelled call has written is copied out as well, so that a recovery can read it.
    """

    def __init__(
        self, call: CallFrame, name: str, path: str, runtime: Runtime, root: Behaviour
    ) -> None:
        super().__init__(name, path, runtime, [root])
        self._call = call
        self._is_entered: bool  # set by `begin`

    @property
    def tree(self) -> str:
        """Return the name of the tree that is called."""
        return self._call.kind.tree

    @property
    def store(self) -> Store:
        """Return the keys of the present call."""
        return self._call.inner.store

    def begin(self) -> None:
        self._is_entered = False

    def proceed(self) -> Steps:
        if not self._is_entered:
            self._call.enter()
            self._is_entered = True
        yield from self.children[0].tick()
        status = self.adopt(self.children[0])
        if status is not Status.RUNNING:
            self._call.leave()
        return status

    def cancel(self) -> None:
        if self._is_entered:
            self._call.leave()
