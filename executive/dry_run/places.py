"""Which nodes of a tree a name in a file means: by path, its end, leaf, or node's name."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from py_trees.behaviour import Behaviour

from executive.config import Settings
from executive.coverage.sketch import Sketch
from executive.leaf.action import Leaf
from executive.leaf.runtime import LeafMaker
from executive.tree.ask_node import AskNode
from executive.tree.build import build_tree
from executive.tree.language import MissionFile


@dataclass(frozen=True, slots=True)
class LeafPlace:
    """A leaf at one place of the tree.

    Attributes:
        name: Name of the behaviour.
        kind: Its class.
    """

    name: str
    kind: type[Leaf[Any]]


@dataclass(frozen=True, slots=True)
class Places:
    """The nodes of a mission's tree by path.

    Attributes:
        root: The nodes themselves; they cannot be ticked.
        leaves: The actions and conditions, those of `if`, `while` and `until` included.
        questions: The choices of each question; empty for yes and no.
        nodes: The paths of all nodes that are journalled.
    """

    root: Behaviour
    leaves: Mapping[str, LeafPlace]
    questions: Mapping[str, tuple[str, ...]]
    nodes: tuple[str, ...]

    def mocked_by(self, name: str) -> tuple[str, ...]:
        """Return the leaves and questions that an entry of `mocks:` means."""
        named = {path: place.name for path, place in self.leaves.items()}
        return _meant(name, (*self.leaves, *self.questions), named)

    def nodes_called(self, name: str) -> tuple[str, ...]:
        """Return the nodes that a name in `expect:` means."""
        return _meant(name, self.nodes, {p: one.name for p, one in self.leaves.items()})

    def mockable_names(self) -> tuple[str, ...]:
        """Return what an entry of `mocks:` may be called, paths left out."""
        labels = (_label(path) for path in (*self.leaves, *self.questions))
        return tuple(sorted({*labels, *(place.name for place in self.leaves.values())}))

    def node_names(self) -> tuple[str, ...]:
        """Return what a node in `expect:` may be called, paths left out."""
        return tuple(sorted({_label(path) for path in self.nodes}))


def places_of(mission: MissionFile) -> Places:
    """Return the nodes of a mission's tree."""
    listing = _Listing()
    root = build_tree(mission, listing)
    nodes = [node for node in root.iterate() if node.is_journalled]
    questions = {node.path: node.choices for node in nodes if isinstance(node, AskNode)}
    return Places(root, listing.leaves, questions, tuple(node.path for node in nodes))


class _Listing(Sketch):
    """Takes note of the leaves while a tree is built."""

    def __init__(self) -> None:
        super().__init__()
        self.leaves: dict[str, LeafPlace] = {}

    def leaf_maker(self, node: str, leaf: str, uses: Mapping[str, str]) -> LeafMaker:
        blank = super().leaf_maker(node, leaf, uses)

        def make(kind: type[Leaf[Any]], settings: Settings) -> Leaf[Any]:
            self.leaves[node] = LeafPlace(leaf, kind)
            return blank(kind, settings)

        return make


def _meant(name: str, paths: Sequence[str], named: Mapping[str, str]) -> tuple[str, ...]:
    """Return the paths that a name means; a path goes before its end, and that before a name."""
    if name in paths:
        return (name,)
    tails = (f"/{name}", f":{name}") if "/" in name else (f"/{name}",)
    ends = tuple(path for path in paths if path.endswith(tails))
    return ends or tuple(p for p in paths if name in (_label(p), named.get(p)))


def _label(path: str) -> str:
    """Return a node's name without its number: `ScanSwing` of `main/0:ScanSwing`."""
    return path.rpartition("/")[2].rpartition(":")[2]
