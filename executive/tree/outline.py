"""One line for each node, as pictures of a tree show it."""

from collections.abc import Iterator, Mapping
from typing import Any

from executive.tree.conditions import condition_text
from executive.tree.key_source import Source
from executive.tree.node_kinds import (
    Ask,
    Branch,
    Call,
    CheckKeys,
    Consume,
    ForEach,
    Loop,
    Modifiers,
    Node,
    Parallel,
    RunLeaf,
    Set,
    Switch,
    Wait,
)
from executive.tree.resolved import source_value
from executive.tree.traversal import uses_of


def headline(node: Node) -> str:
    """Return the kind, the name and what matters of the arguments."""
    words = _kind_words(node) + _chosen(node)
    name = node.modifiers.name
    return f"{words} ({name})" if name else words


def _chosen(node: Node) -> str:
    """Return which plugins with names a leaf or call uses."""
    wired = node.kind if isinstance(node.kind, Call) else getattr(node.kind, "use", None)
    uses: Mapping[str, str] = wired.uses if wired is not None else {}
    return "".join(f", use {capability}.{name}" for capability, name in uses.items())


def _kind_words(node: Node) -> str:  # noqa: C901 - one case a kind
    match node.kind:
        case Parallel():
            return _parallel_words(node.kind)
        case Branch(kind=kind, condition=condition):
            return f"{kind} {condition_text(condition)}"
        case Switch(source=source):
            return f"switch {source_value(source)}"
        case Loop(until=until, max_rounds=rounds):
            parts = [
                f"until {condition_text(until)}" if until else "",
                f"at most {rounds} rounds" if rounds else "",
            ]
            return f"loop {', '.join(part for part in parts if part) or 'forever'}"
        case ForEach(item=item, source=source):
            return f"for_each {item} in {source_value(source)}"
        case Consume(item=item, source=source):
            return f"consume {item} from {source_value(source)}"
        case RunLeaf() | Call():
            return f"{'run' if isinstance(node.kind, RunLeaf) else 'call'} {node.kind.label}"
        case Wait(duration_s=duration_s):
            return f"wait {duration_s:g} s"
        case Set(values=values):
            return "set " + ", ".join(
                f"{key} = {source_value(source)}" for key, source in values.items()
            )
        case CheckKeys(condition=condition):
            return f"check {condition_text(condition)}"
        case Ask(question=question):
            return f'ask "{question}"'
    uses = list(uses_of(node))
    return (
        f"check {node.kind.label}" if uses and node.kind.label == uses[-1].name else node.kind.label
    )


def _parallel_words(kind: Parallel) -> str:
    total = len(kind.children)
    words = ["parallel"]
    if not kind.needs_all:
        words.append(f"{kind.succeed} of {total}")
    if kind.fail != total - kind.succeed + 1:
        words.append(f"fails with {kind.fail}")
    if kind.wait_for_all:
        words.append("waits for all")
    return ", ".join(words)


def labelled(node: Node) -> list[tuple[Node, str]]:
    """Return the nodes below, each with what leads to it: empty for a plain child."""
    kind, labels = node.kind, [""] * len(node.children())
    if isinstance(kind, Branch):
        labels = ["then: " if kind.kind == "if" else "do: ", "else: "]
    elif isinstance(kind, Switch):
        labels = [*(f"{case}: " for case in kind.cases), "else: "]
    below = list(zip(node.children(), labels, strict=False))
    m = node.modifiers
    beside = ((m.on_failure, "on failure: "), (m.on_halt, "on halt: "))
    return below + [(one, label) for one, label in beside if one]


def modifier_words(modifiers: Modifiers) -> list[str]:
    """Return the modifiers, outermost first, without those that hold nodes."""
    retry = modifiers.retry
    return [
        *([f"if {condition_text(modifiers.if_)}"] if modifiers.if_ else []),
        *(["once"] if modifiers.once else []),
        *([f"while {condition_text(modifiers.while_)}"] if modifiers.while_ else []),
        *([f"timeout {modifiers.timeout_s:g} s"] if modifiers.timeout_s is not None else []),
        *(
            [f"retry {retry.count}" + (f" every {retry.pause_s:g} s" if retry.pause_s else "")]
            if retry
            else []
        ),
        *(["optional"] if modifiers.optional else []),
    ]


def ports(node: Node) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
    """Return a leaf's or call's inputs and outputs by port, as the mission language writes them."""
    wired = node.kind if isinstance(node.kind, Call) else getattr(node.kind, "use", None)
    if wired is None:
        return {}, {}
    sides: Iterator[Mapping[str, Source]] = iter((wired.inputs, wired.outputs))
    inputs, outputs = ({port: source_value(one) for port, one in side.items()} for side in sides)
    return inputs, outputs
