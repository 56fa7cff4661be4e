"""Refuse a `parallel` in which two children drive the same part of the machine."""

from collections.abc import Mapping

from executive.leaf.claims import Part, common
from executive.tree.language import Tree
from executive.tree.node_kinds import Call, Node, Parallel
from executive.tree.problem import Problems
from executive.tree.traversal import uses_of

Claims = dict[str, str]  # the first leaf that drives a part, by part


class ClaimCheck:
    """Checks the parallels of all trees; a child claims what any leaf below it claims."""

    def __init__(self, trees: Mapping[str, Tree], problems: Problems) -> None:
        self._trees = trees
        self._problems = problems
        self._of_tree: dict[str, Claims] = {}

    def check(self) -> None:
        """Check each tree once."""
        for name in self._trees:
            self._tree(name)

    def _tree(self, name: str) -> Claims:
        if name not in self._of_tree:
            self._of_tree[name] = {}  # a tree that calls itself is refused elsewhere
            if name in self._trees:
                self._of_tree[name] = self._node(self._trees[name].root)
        return self._of_tree[name]

    def _node(self, node: Node) -> Claims:
        claims: Claims = {}
        for use in uses_of(node):
            claims |= {part: claims.get(part, use.name) for part in use.leaf.parts()}
        if isinstance(node.kind, Call):
            claims = {**self._tree(node.kind.tree), **claims}
        below = [(child, self._node(child)) for child in node.children()]
        if isinstance(node.kind, Parallel):
            before: Claims = {}
            for child, mine in below:
                self._compare(before, child, mine)
                before = {**mine, **before}
        beside = (node.modifiers.on_failure, node.modifiers.on_halt)
        for more in (*(mine for _, mine in below), *(self._node(one) for one in beside if one)):
            claims = {**more, **claims}
        return claims

    def _compare(self, first: Claims, child: Node, second: Claims) -> None:
        shared = common(tuple(first), tuple(second))
        if not shared:
            return
        one, other = _driver(first, shared[0]), _driver(second, shared[0])
        who = f"{one} and {other} both drive" if one != other else f"two {one} drive"
        self._problems.error(
            child.mark,
            f"{who} the {' and the '.join(shared)}, and a 'parallel' runs them at the same time: "
            "put them into a sequence, or choose one with 'if' and 'then' or 'switch'",
        )


def _driver(claims: Claims, part: str) -> str:
    return claims.get(part) or claims[Part.MACHINE]
