"""How large the trees become when every call is written out, as the running mission holds them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from executive.tree.language import Tree
from executive.tree.node_kinds import Call, Node
from executive.tree.problem import Mark, Problems

# Ticking and halting go down the tree by recursion, a few of Python's 1000 frames a level.
MAX_DEPTH = 100
# Each node is an object of about 2 kB that is made before the start, and named in each picture.
MAX_NODES = 200_000


@dataclass(frozen=True, slots=True)
class _Size:
    """Nodes and levels of a tree with its calls written out."""

    nodes: int
    depth: int


def check_expansion(trees: Mapping[str, Tree], problems: Problems) -> bool:
    """Note trees that call each other in a circle, and one that becomes too large.

    Returns:
        Whether the trees are small enough to be followed call by call.
    """
    calls = {name: tuple(_calls(tree.root)) for name, tree in trees.items()}
    sizes: dict[str, _Size] = {}
    for name in _callees_first(calls, problems):
        sizes[name] = _size(trees[name].root, sizes)
        told = _refusal(sizes[name])
        if told:
            problems.error(trees[name].mark, f"tree '{name}' {told}")
            return False
    return True


def _refusal(size: _Size) -> str:
    if size.depth > MAX_DEPTH:
        return (
            f"is {size.depth} levels deep with its calls written out, and {MAX_DEPTH} is the most: "
            "let one tree call several others in a sequence instead of each the next one"
        )
    if size.nodes > MAX_NODES:
        return (
            f"has {size.nodes:,} nodes with its calls written out, and {MAX_NODES:,} is the most: "
            "each call is a copy; repeat one call with 'loop' or 'for_each'"
        )
    return ""


def _calls(root: Node) -> Iterator[Call]:
    for node, _ in _levels(root):
        if isinstance(node.kind, Call):
            yield node.kind


def _levels(root: Node) -> Iterator[tuple[Node, int]]:
    waiting = [(root, 1)]
    while waiting:
        node, level = waiting.pop()
        yield node, level
        waiting.extend((child, level + 1) for child in reversed(node.below()))


def _size(root: Node, sizes: Mapping[str, _Size]) -> _Size:
    nodes = depth = 0
    for node, level in _levels(root):
        called = sizes.get(node.kind.tree) if isinstance(node.kind, Call) else None
        inner = called or _Size(0, 0)
        nodes += 1 + inner.nodes
        depth = max(depth, level + inner.depth)
    return _Size(nodes, depth)


def _callees_first(calls: Mapping[str, Sequence[Call]], problems: Problems) -> list[str]:
    """Return the trees, each behind those that it calls; the last call of a circle is left out."""
    order: list[str] = []
    state: dict[str, str] = {}
    for first in calls:
        path: list[tuple[str, Iterator[Call]]] = []
        _open(first, calls, state, path)
        while path:
            name, left = path[-1]
            call = next(left, None)
            if call is None:
                path.pop()
                order.append(name)
                state[name] = "done"
            elif state.get(call.tree) == "open":
                _note_circle([one for one, _ in path], call.tree, call.mark, problems)
            else:
                _open(call.tree, calls, state, path)
    return order


def _open(
    name: str,
    calls: Mapping[str, Sequence[Call]],
    state: dict[str, str],
    path: list[tuple[str, Iterator[Call]]],
) -> None:
    if name in calls and name not in state:
        state[name] = "open"
        path.append((name, iter(calls[name])))


def _note_circle(path: Sequence[str], name: str, mark: Mark, problems: Problems) -> None:
    circle = (*path[path.index(name) :], name)
    problems.error(
        mark,
        f"trees call each other in a circle: {' → '.join(circle)}; repeat with 'loop' or 'retry'",
    )
