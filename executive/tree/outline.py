"""One line for each node, as pictures of a tree show it."""

from collections.abc import Iterator, Mapping
from typing import Any

from executive.tree.conditions import condition_text
from executive.tree.language import (
    Ask,
    Call,
    Composite,
    ForEach,
    Loop,
    Modifiers,
    Node,
    RunLeaf,
    Set,
    Source,
    Wait,
)
from executive.tree.resolved import source_value
from executive.tree.traversal import uses_of


def headline(node: Node) -> str:
    """Return the kind, the name and what matters of the arguments."""
    words = _kind_words(node)
    name = node.modifiers.name
    return f"{words} ({name})" if name else words


def _kind_words(node: Node) -> str:
    match node.kind:
        case Composite(kind="parallel", children=children, succeed=succeed):
            return (
                "parallel"
                if succeed == len(children)
                else f"parallel, {succeed} of {len(children)}"
            )
        case Loop(until=until, max_rounds=rounds):
            parts = [
                f"until {condition_text(until)}" if until else "",
                f"at most {rounds} rounds" if rounds else "",
            ]
            return f"loop {', '.join(part for part in parts if part)}"
        case ForEach(item=item, source=source):
            return f"for_each {item} in {source_value(source)}"
        case RunLeaf() | Call():
            return f"{'run' if isinstance(node.kind, RunLeaf) else 'call'} {node.kind.label}"
        case Wait(duration_s=duration_s):
            return f"wait {duration_s:g} s"
        case Set(values=values):
            return "set " + ", ".join(
                f"{key} = {source_value(source)}" for key, source in values.items()
            )
        case Ask(question=question):
            return f'ask "{question}"'
    uses = list(uses_of(node))
    return (
        f"check {node.kind.label}" if uses and node.kind.label == uses[-1].name else node.kind.label
    )


def modifier_words(modifiers: Modifiers) -> list[str]:
    """Return the modifiers, outermost first, without the recovery's nodes."""
    retry = modifiers.retry
    return [
        *([f"if {condition_text(modifiers.if_)}"] if modifiers.if_ else []),
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
