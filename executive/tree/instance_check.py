"""Refuse a leaf that needs one of several plugins of a capability, and does not say which."""

from collections.abc import Mapping

from executive.tree.instances import DEFAULT, Instances, Uses
from executive.tree.language import Tree
from executive.tree.leaf_use import LeafUse
from executive.tree.node_kinds import Call
from executive.tree.problem import Problems
from executive.tree.traversal import uses_of


class InstanceCheck:
    """Walks from `main` through all calls: what a call chooses holds in the tree that it calls."""

    def __init__(self, trees: Mapping[str, Tree], instances: Instances, problems: Problems) -> None:
        self._trees = trees
        self._instances = instances
        self._problems = problems
        self._seen: set[tuple[str, tuple[tuple[str, str], ...]]] = set()

    def check(self) -> None:
        """Check each tree once for each choice under which it is called."""
        if self._instances:
            self._tree("main", {})

    def _tree(self, name: str, uses: Uses) -> None:
        seen = name, tuple(sorted(uses.items()))
        if seen in self._seen or name not in self._trees:
            return
        self._seen.add(seen)
        for node in self._trees[name].root.walk():
            for leaf in uses_of(node):
                self._leaf(leaf, {**uses, **leaf.uses})
            if isinstance(node.kind, Call):
                self._tree(node.kind.tree, {**uses, **node.kind.uses})

    def _leaf(self, leaf: LeafUse, uses: Uses) -> None:
        for need in leaf.leaf.needs:
            names = self._instances.get(need.capability, ())
            if names and need.capability not in uses and DEFAULT not in names:
                told = (
                    f"{leaf.name} uses a {need.capability} plugin, and the mission has several: "
                    f"{', '.join(names)}; choose one with 'use: {names[0]}' here or where the tree "
                    f"is called, or name one of them '{DEFAULT}'"
                )
                self._problems.error(leaf.mark, told)
