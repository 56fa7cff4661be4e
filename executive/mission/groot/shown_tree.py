"""What a monitor is shown of a running tree: its XML, statuses, and the keys of its stores.

It only reads, and may be called from another thread while the tree is ticked: what it shows is then
between two ticks in part.
"""

import uuid
from typing import Any

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from executive.errors import ConfigError
from executive.leaf.store import Store
from executive.mission.mission import Mission
from executive.mission.record.leaf_memory import shown
from executive.tree.btcpp.live_xml import live_xml
from executive.tree.language import MissionFile
from executive.tree.small_nodes import CallNode

_MOST_NODES = 0xFFFF  # the number of a node has 16 bits
_SKIPPED = 4
_STATUSES = {Status.INVALID: 0, Status.RUNNING: 1, Status.SUCCESS: 2, Status.FAILURE: 3}


class ShownTree:
    """A tree with a number for each node.

    Attributes:
        id: 16 bytes that no other tree has.
        xml: The whole tree.
    """

    def __init__(self, description: MissionFile, mission: Mission) -> None:
        """Number the nodes.

        Raises:
            ConfigError: If there are more than the protocol can number.
        """
        nodes = [*_parents_first(mission.root)]
        if len(nodes) > _MOST_NODES:
            raise ConfigError(f"--groot shows at most {_MOST_NODES} nodes, this tree: {len(nodes)}")
        self._nodes = dict(enumerate(nodes, 1))
        self.id = uuid.uuid4().bytes
        uids = {node: uid for uid, node in self._nodes.items()}
        self.xml = live_xml(description, mission.root, lambda node: uids[node])
        self._calls = {node.path: node for node in nodes if isinstance(node, CallNode)}
        self._main = mission.store

    def node(self, uid: int) -> Behaviour | None:
        """Return a node by its number."""
        return self._nodes.get(uid)

    def statuses(self) -> dict[int, int]:
        """Return the status of each node as the protocol numbers them."""
        return {uid: _status(node) for uid, node in self._nodes.items()}

    def blackboards(self, names: list[str]) -> dict[str, Any]:
        """Return the keys of stores: `main`, or the `_fullpath` of a call; all for no names."""
        stores = {"main": self._main} | {
            path: call.store for path, call in self._calls.items() if call.status is Status.RUNNING
        }
        return {name: _values(stores[name]) for name in names or stores if name in stores}


def _parents_first(node: Behaviour) -> list[Behaviour]:
    return [node, *(one for child in node.children for one in _parents_first(child))]


def _status(node: Behaviour) -> int:
    status = node.status
    return _SKIPPED if status is Status.SUCCESS and node.is_skipped else _STATUSES[status]


def _values(store: Store) -> dict[str, Any]:
    """Return what a store holds, large values by their class."""
    found = {}
    for key in tuple(store.keys()):
        try:
            found[key] = shown(store.get(key))
        except ConfigError:  # it is gone since
            continue
    return found
