"""The TreeNodesModel of BehaviorTree.CPP 4: every custom node with its ports."""

import inspect
from collections.abc import Iterable
from xml.etree.ElementTree import Element, SubElement

from executive.leaf.action import Action
from executive.tree.language import (
    Ask,
    Call,
    Consume,
    ForEach,
    LeafUse,
    Loop,
    MissionFile,
    Tree,
)
from executive.tree.port_types import type_name
from executive.tree.traversal import uses_of

RESERVED = ("name", "ID")  # attributes that BehaviorTree.CPP takes for itself


def node_models(mission: MissionFile) -> Element:
    """Return the models of the leaves, subtrees and own nodes that a mission uses."""
    models = Element("TreeNodesModel")
    nodes = [node for tree in mission.trees.values() for node in tree.root.walk()]
    uses = {use.name: use for node in nodes for use in uses_of(node)}
    models.extend(_leaf_model(use) for _, use in sorted(uses.items()))
    called = {node.kind.tree for node in nodes if isinstance(node.kind, Call)}
    models.extend(_tree_model(mission.trees[name]) for name in sorted(called))
    models.extend(_own_models({type(node.kind) for node in nodes if not _is_repeat(node.kind)}))
    if any(node.modifiers.on_halt for node in nodes):
        models.append(Element("Control", ID="OnHalt"))  # the second child, when the first is halted
    return models


def _is_repeat(kind: object) -> bool:
    return isinstance(kind, Loop) and kind.until is None


def _leaf_model(use: LeafUse) -> Element:
    leaf = use.leaf
    model = Element("Action" if issubclass(leaf, Action) else "Condition", ID=use.name)
    for name, field in leaf.Settings.model_fields.items():
        default = None if field.is_required() else field.get_default(call_default_factory=True)
        _port(model, "input_port", name, "", field.description or "", default)
    for side, ports in (("input_port", leaf.inputs), ("output_port", leaf.outputs)):
        for name, port in ports.items():
            _port(model, side, name, type_name(port.type), port.doc)
    summary = (inspect.getdoc(leaf) or "").partition("\n")[0]
    SubElement(SubElement(model, "MetadataFields"), "Metadata", description=summary)
    return model


def _tree_model(tree: Tree) -> Element:
    model = Element("SubTree", ID=tree.name)
    for side, ports in (("input_port", tree.inputs), ("output_port", tree.outputs)):
        for name, wanted in ports.items():
            _port(model, side, name, wanted.name, "")
    return model


def _own_models(kinds: Iterable[type]) -> Iterable[Element]:
    if ForEach in kinds:
        model = Element("Decorator", ID="ForEach")
        _port(model, "input_port", "items", "", "The list to go through.")
        _port(model, "output_port", "item", "", "Key of the present item.")
        yield model
    if Consume in kinds:
        model = Element("Decorator", ID="Consume")
        _port(model, "inout_port", "queue", "", "The list that items are taken off.")
        _port(model, "output_port", "item", "", "Key of the present item.")
        yield model
    if Loop in kinds:
        model = Element("Control", ID="LoopUntil")
        _port(
            model,
            "input_port",
            "max",
            "int",
            "Rounds at most; the first child decides when the loop ends.",
        )
        yield model
    if Ask in kinds:
        model = Element("Action", ID="Ask")
        _port(
            model, "input_port", "question", "string", "What the operator is asked; yes is success."
        )
        _port(model, "input_port", "default", "bool", "The answer if no one can be asked.")
        yield model


def attribute(name: str) -> str:
    """Return a port's or setting's name as an attribute."""
    return f"{name}_" if name in RESERVED else name


def _port(
    model: Element, side: str, name: str, kind: str, doc: str, default: object = None
) -> None:
    port = SubElement(model, side, name=attribute(name))
    if kind:
        port.set("type", kind)
    if default is not None:
        port.set("default", str(default))
    port.text = doc
