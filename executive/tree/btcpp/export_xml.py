"""Trees as BehaviorTree.CPP 4 XML, which its parser (4.10) takes and Groot2 opens.

What that language lacks is expressed by what it has: `while` is a WhileDoElse without `else`, `if`
an IfThenElse whose `else` is a node that is always skipped, `on_failure` a TryCatch. Conditions and
`set` become scripts where scripts can say them. `for_each`, `consume`, `loop` with `until`, `ask`,
an `on_halt` that is no script, and a condition that is none (`Holds`) are nodes of our own,
declared in the TreeNodesModel as the leaves are.
"""

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from executive.tree.btcpp.names import (
    COMPOSITES,
    LEFT_OUT,
    MOST_CASES,
    TURNED,
    attribute,
    leaf_tag,
    tree_id,
    uses_attribute,
)
from executive.tree.btcpp.node_model import node_models
from executive.tree.btcpp.script import assignment, condition_script, set_script
from executive.tree.expressions.syntax import Truth
from executive.tree.key_source import Computed, Ref, Source
from executive.tree.language import MissionFile
from executive.tree.leaf_use import Condition, KeyHolds, LeafUse
from executive.tree.node_kinds import (
    Ask,
    Attempts,
    Branch,
    Call,
    CheckKeys,
    CheckLeaf,
    Composite,
    Consume,
    ForEach,
    Group,
    Kind,
    Loop,
    Modifiers,
    Node,
    Parallel,
    RunLeaf,
    Set,
    Switch,
    Turned,
    Wait,
)
from executive.tree.resolved import source_value
from executive.tree.settings import settings_dump
from executive.tree.traversal import uses_of


def to_xml(mission: MissionFile) -> str:
    """Return the trees and the models of all nodes that are not built into BehaviorTree.CPP."""
    nodes = [node for tree in mission.trees.values() for node in tree.root.walk()]
    leaves = frozenset(leaf_tag(use.name) for node in nodes for use in uses_of(node))
    ids = {name: tree_id(name, leaves) for name in mission.trees}
    root = Element("root", BTCPP_format="4", main_tree_to_execute=ids["main"])
    for tree in mission.trees.values():
        written = SubElement(root, "BehaviorTree", ID=ids[tree.name])
        written.append(TreeWriter(ids).node(tree.root))
    root.append(node_models(mission, ids, {element.tag for element in root.iter()}))
    indent(root, "  ")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{tostring(root, encoding="unicode")}'


class TreeWriter:
    """Writes the nodes of one tree; `ids` are the IDs of the trees by their names."""

    def __init__(self, ids: Mapping[str, str]) -> None:
        self._ids = ids
        self._call_names: Counter[str] = Counter()

    def node(self, node: Node) -> Element:
        """Return a node with its modifiers around it, outermost first."""
        if _is_nothing(node):
            return _left_out()
        element = self.kind_element(node.kind)
        name = node.modifiers.name
        if name and isinstance(node.kind, Group):  # its child has a name of its own
            element = _around("Sequence", element)
        if name:
            element.set("name", self._unique(name) if isinstance(node.kind, Call) else name)
        return self._modified(element, node.modifiers)

    def _unique(self, name: str) -> str:
        """Return a name that no other SubTree of this tree has: two of one name are refused."""
        self._call_names[name] += 1
        count = self._call_names[name]
        return name if count == 1 else f"{name} {count}"

    def _modified(self, element: Element, modifiers: Modifiers) -> Element:
        if modifiers.on_halt:
            element = self._on_halt(element, modifiers.on_halt)
        if modifiers.optional:
            element = _around("ForceSuccess", element)
        if modifiers.on_failure:
            element = _around("TryCatch", element, self.node(modifiers.on_failure))
        if modifiers.retry:
            element = _retried(element, modifiers.retry)
        if modifiers.timeout_s is not None:
            element = _around("Timeout", element, msec=_milliseconds(modifiers.timeout_s))
        if modifiers.while_:
            element = _around("WhileDoElse", _condition(modifiers.while_), element)
        if modifiers.once:
            element = _around("RunOnce", element, then_skip="true")
        if modifiers.if_:
            element = _around("IfThenElse", _condition(modifiers.if_), element, _left_out())
        return element

    def _on_halt(self, element: Element, cleanup: Node) -> Element:
        script = set_script(cleanup.kind) if isinstance(cleanup.kind, Set) else None
        if script is None or cleanup.modifiers != Modifiers() or "_onHalted" in element.attrib:
            return _around("OnHalt", element, self.node(cleanup))
        element.set("_onHalted", script)
        return element

    def kind_element(self, kind: Kind) -> Element:  # noqa: C901 - one case a kind
        match kind:
            case Composite(children=children):
                return _around(COMPOSITES[kind.kind], *map(self.node, children))
            case Parallel():
                return self._parallel(kind)
            case Turned(kind=how, child=child):
                return _around(TURNED[how], self.node(child))
            case Branch():
                return self._branch(kind)
            case Switch():
                return self._switch(kind.source.key, list(kind.cases.items()), kind.otherwise)
            case Group(child=child):
                return self.node(child)
            case Loop():
                return self._loop(kind)
            case ForEach(item=item, source=source, body=body):
                return self._for_items("ForEach", body, item, items=_source_text(source))
            case Consume(item=item, source=source, body=body):
                return self._for_items("Consume", body, item, queue=_source_text(source))
            case RunLeaf(use=use) | CheckLeaf(use=use):
                return _leaf(use)
            case CheckKeys(condition=condition):
                return _condition(condition)
            case Call():
                wires = {**_wires(kind.inputs), **_wires(kind.outputs)}
                named = uses_attribute(kind.uses)
                return Element("SubTree", {"ID": self._ids[kind.tree], **wires, **named})
            case Wait(duration_s=duration_s):
                return Element("Sleep", msec=_milliseconds(duration_s))
            case Set():
                return _set(kind)
            case Ask():
                return _ask(kind)

    def _for_items(self, tag: str, body: Node, item: str, **source: str) -> Element:
        return _around(tag, self.node(body), item=f"{{{item}}}", **source)

    def _parallel(self, kind: Parallel) -> Element:
        children = map(self.node, kind.children)
        if kind.wait_for_all:  # it succeeds with fewer failures, however many successes that leaves
            return _around("ParallelAll", *children, max_failures=str(kind.fail))
        succeed = "-1" if kind.needs_all else str(kind.succeed)  # all that were not left out
        return _around("Parallel", *children, success_count=succeed, failure_count=str(kind.fail))

    def _branch(self, kind: Branch) -> Element:
        tag = "IfThenElse" if kind.kind == "if" else "WhileDoElse"
        otherwise = self.node(kind.otherwise) if kind.otherwise else _left_out()
        return _around(tag, _condition(kind.condition), self.node(kind.then), otherwise)

    def _switch(
        self, key: str, cases: Sequence[tuple[str, Node]], otherwise: Node | None
    ) -> Element:
        """Return a Switch2 to Switch6; a further one is the default of one with too many cases."""
        now, later = list(cases[:MOST_CASES]), cases[MOST_CASES:]
        if later:
            default = self._switch(key, later, otherwise)
        else:
            default = self.node(otherwise) if otherwise else Element("AlwaysFailure")
        if len(now) == 1:  # there is no Switch1; the same case twice is never reached
            now = now * 2
        names = {f"case_{number}": name for number, (name, _) in enumerate(now, 1)}
        children = [self.node(case) for _, case in now]
        return _around(f"Switch{len(now)}", *children, default, variable=f"{{{key}}}", **names)

    def _loop(self, kind: Loop) -> Element:
        body = self.node(kind.body)
        if kind.until is None:
            return _around("Repeat", body, num_cycles=str(kind.max_rounds or -1))
        element = _around("LoopUntil", _condition(kind.until), body)
        if kind.max_rounds:
            element.set("max", str(kind.max_rounds))
        return element


def _is_nothing(node: Node) -> bool:
    """Whether a node is always left out, as `else: skip` is."""
    asked = node.modifiers.if_
    is_never = isinstance(asked, Computed) and asked.expression == Truth(False)
    return is_never and isinstance(node.kind, CheckKeys)


def _left_out() -> Element:
    """Return a node that is always skipped."""
    return Element("AlwaysSuccess", _skipIf=LEFT_OUT)


def _retried(element: Element, attempts: Attempts) -> Element:
    if attempts.pause_s:
        pause = Element("Sleep", msec=_milliseconds(attempts.pause_s))
        element = _around("TryCatch", element, pause)
    return _around("RetryUntilSuccessful", element, num_attempts=str(attempts.count))


def _set(kind: Set) -> Element:
    script = set_script(kind)
    if script is not None:
        return Element("Script", code=script)
    parts = [_written(key, source) for key, source in kind.values.items()]
    return parts[0] if len(parts) == 1 else _around("Sequence", *parts, name="set")


def _written(key: str, source: Source) -> Element:
    script = assignment(key, source)
    if script is not None:
        return Element("Script", code=script)
    return Element("SetBlackboard", value=_source_text(source), output_key=key)


def _ask(kind: Ask) -> Element:
    given = {
        "question": str(kind.question),
        "default": None if kind.default is None else _text(kind.default),
        "choices": ";".join(kind.choices) or None,
        "answer": _source_text(kind.answer) if kind.answer else None,
    }
    return Element("Ask", {key: value for key, value in given.items() if value is not None})


def _condition(condition: Condition) -> Element:
    if isinstance(condition, LeafUse):
        return _leaf(condition)
    if isinstance(condition, KeyHolds):
        return Element("ScriptCondition", code=f"{condition.key} == true")
    if isinstance(condition, Computed):
        return _computed(condition)
    parts = [_condition(part) for part in condition.parts]
    return _around({"not": "Inverter", "all": "Sequence", "any": "Fallback"}[condition.how], *parts)


def _computed(condition: Computed) -> Element:
    if isinstance(condition.expression, Truth):
        return Element("AlwaysSuccess" if condition.expression.value else "AlwaysFailure")
    script = condition_script(condition.expression)
    if script is not None:
        return Element("ScriptCondition", code=script)
    return Element("Holds", expression=_source_text(condition))


def _leaf(use: LeafUse) -> Element:
    literals = settings_dump(use.settings)
    settings = {attribute(key): _text(value) for key, value in literals.items()}
    if use.parameters:
        settings |= _wires(use.parameters.sources)
    wires = {**_wires(use.inputs), **_wires(use.outputs)}
    return Element(leaf_tag(use.name), {**settings, **wires, **uses_attribute(use.uses)})


def _wires(wires: Mapping[str, Source]) -> dict[str, str]:
    return {attribute(port): _source_text(source) for port, source in wires.items()}


def _around(tag: str, *children: Element, **attributes: str) -> Element:
    element = Element(tag, attributes)
    element.extend(children)
    return element


def _milliseconds(duration_s: float) -> str:
    return str(round(1e3 * duration_s))


def _source_text(source: Source) -> str:
    """Return a value's text; an expression is kept from looking like the name of one key."""
    text = _text(source_value(source))
    is_pointer = text.startswith("{") and text.endswith("}") and not isinstance(source, Ref)
    return f"({text})" if is_pointer else text


def _text(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
