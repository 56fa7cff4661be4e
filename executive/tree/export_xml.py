"""Trees as BehaviorTree.CPP 4 XML, so that Groot2 opens them.

What that language lacks is expressed by what it has: `while` is a ReactiveSequence with the
condition first, `if` an IfThenElse, `on_failure` a Fallback whose second child is forced to fail.
`for_each`, `consume`, `loop` with `until`, `on_halt` and `ask` are nodes of our own, declared in
the TreeNodesModel as the leaves are.
"""

import json
from collections.abc import Mapping, Sequence
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from executive.tree.language import (
    Ask,
    Attempts,
    Branch,
    Call,
    CheckKeys,
    CheckLeaf,
    Combined,
    Composite,
    Computed,
    Condition,
    Consume,
    ForEach,
    Group,
    KeyHolds,
    Kind,
    LeafUse,
    Loop,
    MissionFile,
    Modifiers,
    Node,
    Parallel,
    RunLeaf,
    Set,
    Source,
    Switch,
    Turned,
    Wait,
)
from executive.tree.node_model import attribute, node_models
from executive.tree.resolved import source_value
from executive.tree.settings import settings_dump

_COMPOSITES = {
    "sequence": "Sequence",
    "fallback": "Fallback",
    "reactive_sequence": "ReactiveSequence",
    "reactive_fallback": "ReactiveFallback",
    "persistent_sequence": "SequenceWithMemory",
}
_TURNED = {"not": "Inverter", "force_failure": "ForceFailure"}
_MOST_CASES = 6  # BehaviorTree.CPP has Switch2 to Switch6


def to_xml(mission: MissionFile) -> str:
    """Return the trees and the models of all nodes that are not built into BehaviorTree.CPP."""
    root = Element("root", BTCPP_format="4", main_tree_to_execute="main")
    for tree in mission.trees.values():
        SubElement(root, "BehaviorTree", ID=tree.name).append(_node(tree.root, in_fallback=False))
    root.append(node_models(mission))
    indent(root, "  ")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{tostring(root, encoding="unicode")}'


def _node(node: Node, *, in_fallback: bool) -> Element:
    element = _kind(node.kind)
    if node.modifiers.name or (
        "name" not in element.attrib and element.tag in ("Action", "Condition", "SubTree")
    ):
        element.set("name", node.label)
    return _modified(element, node.modifiers, in_fallback)


def _modified(element: Element, modifiers: Modifiers, in_fallback: bool) -> Element:
    if modifiers.on_halt:
        element = _around("OnHalt", element, _node(modifiers.on_halt, in_fallback=False))
    if modifiers.optional:
        element = _around("ForceSuccess", element)
    if modifiers.on_failure:
        element = _recovering(element, _node(modifiers.on_failure, in_fallback=False))
    if modifiers.retry:
        element = _retried(element, modifiers.retry)
    if modifiers.timeout_s is not None:
        element = _around("Timeout", element, msec=_milliseconds(modifiers.timeout_s))
    if modifiers.while_:
        element = _around("ReactiveSequence", _condition(modifiers.while_), element)
    if modifiers.once:
        element = _around("RunOnce", element, then_skip="true")
    if modifiers.if_:
        otherwise = [] if in_fallback else [Element("AlwaysSuccess")]
        element = _around("IfThenElse", _condition(modifiers.if_), element, *otherwise)
    return element


def _recovering(element: Element, recovery: Element) -> Element:
    return _around("Fallback", element, _around("ForceFailure", recovery))


def _retried(element: Element, attempts: Attempts) -> Element:
    if attempts.pause_s:
        element = _recovering(element, Element("Sleep", msec=_milliseconds(attempts.pause_s)))
    return _around("RetryUntilSuccessful", element, num_attempts=str(attempts.count))


def _kind(kind: Kind) -> Element:  # noqa: C901 - one case a kind
    match kind:
        case Composite():
            return _composite(kind)
        case Parallel():
            return _parallel(kind)
        case Turned(kind=how, child=child):
            return _around(_TURNED[how], _node(child, in_fallback=False))
        case Branch():
            return _branch(kind)
        case Switch():
            return _switch(kind.source.key, list(kind.cases.items()), kind.otherwise)
        case Group(child=child):
            return _node(child, in_fallback=False)
        case Loop():
            return _loop(kind)
        case ForEach(item=item, source=source, body=body):
            return _around(
                "ForEach",
                _node(body, in_fallback=False),
                item=item,
                items=_text(source_value(source)),
            )
        case Consume(item=item, source=source, body=body):
            queue = _text(source_value(source))
            return _around("Consume", _node(body, in_fallback=False), item=item, queue=queue)
        case RunLeaf(use=use):
            return _leaf("Action", use)
        case CheckLeaf(use=use):
            return _leaf("Condition", use)
        case CheckKeys(condition=condition):
            return _condition(condition)
        case Call():
            return Element(
                "SubTree", {"ID": kind.tree, **_wires(kind.inputs), **_wires(kind.outputs)}
            )
    return _small(kind)


def _small(kind: Wait | Set | Ask) -> Element:
    if isinstance(kind, Wait):
        return Element("Sleep", msec=_milliseconds(kind.duration_s))
    if isinstance(kind, Ask):
        default = {} if kind.default is None else {"default": _text(kind.default)}
        return Element("Action", {"ID": "Ask", "question": str(kind.question), **default})
    return _around(
        "Sequence",
        *(
            Element("SetBlackboard", value=_text(source_value(source)), output_key=key)
            for key, source in kind.values.items()
        ),
    )


def _composite(kind: Composite) -> Element:
    is_fallback = kind.kind.endswith("fallback")
    return _around(
        _COMPOSITES[kind.kind], *(_node(child, in_fallback=is_fallback) for child in kind.children)
    )


def _parallel(kind: Parallel) -> Element:
    children = [_node(child, in_fallback=False) for child in kind.children]
    if kind.wait_for_all:  # it succeeds with fewer failures, however many successes that leaves
        return _around("ParallelAll", *children, max_failures=str(kind.fail))
    thresholds = {"success_count": str(kind.succeed), "failure_count": str(kind.fail)}
    return _around("Parallel", *children, **thresholds)


def _branch(kind: Branch) -> Element:
    tag = "IfThenElse" if kind.kind == "if" else "WhileDoElse"
    otherwise = (
        _node(kind.otherwise, in_fallback=False) if kind.otherwise else Element("AlwaysSuccess")
    )
    then = _node(kind.then, in_fallback=False)
    return _around(tag, _condition(kind.condition), then, otherwise)


def _switch(key: str, cases: Sequence[tuple[str, Node]], otherwise: Node | None) -> Element:
    """Return a Switch2 to Switch6; a further one is the default of one with too many cases."""
    now, later = list(cases[:_MOST_CASES]), cases[_MOST_CASES:]
    if later:
        default = _switch(key, later, otherwise)
    else:
        default = _node(otherwise, in_fallback=False) if otherwise else Element("AlwaysFailure")
    if len(now) == 1:  # there is no Switch1; the same case twice is never reached
        now = now * 2
    names = {f"case_{number}": name for number, (name, _) in enumerate(now, 1)}
    children = [_node(case, in_fallback=False) for _, case in now]
    return _around(f"Switch{len(now)}", *children, default, variable=f"{{{key}}}", **names)


def _loop(kind: Loop) -> Element:
    body = _node(kind.body, in_fallback=False)
    if kind.until is None:
        return _around("Repeat", body, num_cycles=str(kind.max_rounds or -1))
    element = _around("LoopUntil", _condition(kind.until), body)
    if kind.max_rounds:
        element.set("max", str(kind.max_rounds))
    return element


def _condition(condition: Condition) -> Element:
    if isinstance(condition, LeafUse):
        return _leaf("Condition", condition)
    if isinstance(condition, KeyHolds):
        return Element("ScriptCondition", code=f"{condition.key} == true")
    if isinstance(condition, Computed):
        return Element("Condition", {"ID": "Holds", "expression": str(condition)})
    return _combined(condition)


def _combined(condition: Combined) -> Element:
    parts = [_condition(part) for part in condition.parts]
    return _around({"not": "Inverter", "all": "Sequence", "any": "Fallback"}[condition.how], *parts)


def _leaf(tag: str, use: LeafUse) -> Element:
    settings = {attribute(key): _text(value) for key, value in settings_dump(use.settings).items()}
    return Element(tag, {"ID": use.name, **settings, **_wires(use.inputs), **_wires(use.outputs)})


def _wires(wires: Mapping[str, Source]) -> dict[str, str]:
    return {attribute(port): _text(source_value(source)) for port, source in wires.items()}


def _around(tag: str, *children: Element, **attributes: str) -> Element:
    element = Element(tag, attributes)
    element.extend(children)
    return element


def _milliseconds(duration_s: float) -> str:
    return str(round(1e3 * duration_s))


def _text(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
