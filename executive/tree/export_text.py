"""Trees as indented text."""

from collections.abc import Iterator

from executive.tree.language import MissionFile, Tree
from executive.tree.node_kinds import Node
from executive.tree.outline import headline, labelled, modifier_words, ports


def to_text(mission: MissionFile) -> str:
    """Return the mission's plugins and trees for a terminal."""
    lines = [f"{mission.name}{f': {mission.description}' if mission.description else ''}", ""]
    width = max((len(capability) for capability in mission.plugins), default=0)
    for capability, several in mission.plugins.items():
        lines.append(f"  {capability:{width}}  {', '.join(one.name for one in several)}")
    for tree in mission.trees.values():
        lines += ["", _title(tree), *_lines(tree.root, "", "")]
    return "\n".join(lines)


def _title(tree: Tree) -> str:
    sides = (("in", tree.inputs), ("out", tree.outputs))
    told = [
        f"{side} {', '.join(f'{p}: {t.text}' for p, t in given.items())}"
        for side, given in sides
        if given
    ]
    return tree.name + (f" ({'; '.join(told)})" if told else "")


def _lines(node: Node, first: str, rest: str) -> Iterator[str]:
    yield f"{first}{headline(node)}{_tail(node)}"
    below = labelled(node)
    for index, (child, label) in enumerate(below):
        is_last = index == len(below) - 1
        branch, onward = ("`-- ", "    ") if is_last else ("|-- ", "|   ")
        yield from _lines(child, f"{rest}{branch}{label}", f"{rest}{onward}")


def _tail(node: Node) -> str:
    inputs, outputs = ports(node)
    arrows = [", ".join(f"{port} <- {key}" for port, key in inputs.items()) if inputs else ""]
    arrows.append(", ".join(f"{port} -> {key}" for port, key in outputs.items()) if outputs else "")
    words = ", ".join(modifier_words(node.modifiers))
    told = "; ".join(part for part in arrows if part)
    return f"{f'  [{words}]' if words else ''}{f'  {told}' if told else ''}"
