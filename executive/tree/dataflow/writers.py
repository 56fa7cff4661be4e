"""What writes a key: a node of the tree, its caller, or an action that could stand before."""

from collections.abc import Collection, Iterator, Mapping

from executive.errors import did_you_mean, nearest
from executive.tree.catalogue import Catalogue
from executive.tree.key_source import Ref
from executive.tree.language import Tree
from executive.tree.node_kinds import Ask, Call, Consume, ForEach, Node, Set
from executive.tree.traversal import uses_of

_MOST = 3  # actions that a message names


class Writers:
    """What gives the keys of one tree, for the advice after a key is read too early."""

    def __init__(
        self, inputs: frozenset[str], nodes: Mapping[str, Node], catalogue: Catalogue
    ) -> None:
        """Keep them.

        Args:
            inputs: The tree's own inputs.
            nodes: Every key that the tree writes anywhere, with the first node that does.
            catalogue: What the tree could use.
        """
        self._inputs = inputs
        self._nodes = nodes
        self._catalogue = catalogue

    def __contains__(self, key: str) -> bool:
        return key in self._nodes or key in self._inputs

    def has_node(self, key: str) -> bool:
        """Return whether a node of the tree writes a key, be it only later."""
        return key in self._nodes

    def advice(self, key: str, known: Collection[str]) -> str:
        """Return the end of a message on a key that is read and not among the known ones."""
        if key in self._inputs:
            return f"; a call leaves this input out: ask 'has({{{key}}})' before"
        if node := self._nodes.get(key):
            return f"; '{node.label}' at line {node.mark.line} writes it, and never before this"
        if nearest(key, known):
            return did_you_mean(key, known)
        if actions := self._actions(key):
            return f"; {' or '.join(actions)} writes it: put that before"
        return did_you_mean(key, known) if known else "; nothing is written before it"

    def _actions(self, key: str) -> list[str]:
        """Return the behaviours with an output of this name, the first few of them."""
        return [name for name, leaf in self._catalogue.behaviours() if key in leaf.outputs][:_MOST]


def written_in(tree: Tree) -> dict[str, Node]:
    """Return every key that a tree writes, with the first node that does, in document order."""
    writers: dict[str, Node] = {}
    for node in tree.root.walk():
        for key in _written_by(node):
            writers.setdefault(key, node)
    return writers


def _written_by(node: Node) -> Iterator[str]:
    for use in uses_of(node):
        yield from (ref.key for ref in use.outputs.values())
    match node.kind:
        case Call(outputs=outputs):
            yield from (ref.key for ref in outputs.values())
        case Set(values=values):
            yield from values
        case ForEach(item=item) | Consume(item=item):
            yield item
        case Ask(answer=Ref(key=key)):
            yield key
