"""Trees as a graph for Graphviz."""

from collections.abc import Iterator
from itertools import count

from executive.tree.language import MissionFile
from executive.tree.node_kinds import (
    Branch,
    Call,
    CheckKeys,
    CheckLeaf,
    Composite,
    Node,
    Parallel,
    RunLeaf,
    Switch,
)
from executive.tree.outline import headline, labelled, modifier_words

_SHAPES = (
    (Composite | Parallel, "box", "#d6e4f0"),
    (Branch | Switch, "diamond", "#d6e4f0"),
    (RunLeaf, "ellipse", "#dff0d8"),
    (CheckLeaf | CheckKeys, "hexagon", "#fcf3cf"),
    (Call, "folder", "#eadcf4"),
)
_OTHER = ("box", "#eeeeee")


def to_dot(mission: MissionFile) -> str:
    """Return a digraph with one cluster a tree."""
    numbers = count()
    lines = [
        f"digraph {_quoted(mission.name)} {{",
        '  node [fontname="Helvetica", fontsize=10, style=filled]; edge '
        '[fontname="Helvetica", fontsize=9];',
    ]
    for index, tree in enumerate(mission.trees.values()):
        lines += [f"  subgraph cluster_{index} {{", f"    label={_quoted(tree.name)};"]
        lines += [f"    {line}" for line in _node(tree.root, numbers, "", "")]
        lines.append("  }")
    return "\n".join([*lines, "}"])


def _node(node: Node, numbers: Iterator[int], parent: str, label: str) -> Iterator[str]:
    me = f"n{next(numbers)}"
    shape, colour = next(((s, c) for kind, s, c in _SHAPES if isinstance(node.kind, kind)), _OTHER)
    text = "\\n".join(
        _escaped(part)
        for part in (headline(node), ", ".join(modifier_words(node.modifiers)))
        if part
    )
    yield f'{me} [label="{text}", shape={shape}, fillcolor="{colour}"];'
    if parent:
        yield f"{parent} -> {me}" + (f" [label={_quoted(label)}, style=dashed];" if label else ";")
    for child, led_by in labelled(node):
        yield from _node(child, numbers, me, led_by.removesuffix(": "))


def _escaped(text: str) -> str:
    return text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", " ")


def _quoted(text: str) -> str:
    return f'"{_escaped(text)}"'
