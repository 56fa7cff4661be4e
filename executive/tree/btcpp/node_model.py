"""The TreeNodesModel of BehaviorTree.CPP 4: every custom node with its ports."""

import inspect
from collections.abc import Collection, Mapping
from xml.etree.ElementTree import Element, SubElement

from executive.leaf.action import Action
from executive.tree.btcpp.names import OWN, USES, attribute, leaf_tag
from executive.tree.language import MissionFile, Tree
from executive.tree.leaf_use import LeafUse
from executive.tree.node_kinds import Call
from executive.tree.port_types import type_name
from executive.tree.traversal import uses_of

# The nodes of the mission language itself: what each is, and its ports.
_OWN_PORTS: Mapping[str, tuple[str, tuple[tuple[str, str, str, str], ...]]] = {
    "ForEach": (
        "Decorator",
        (
            ("input", "items", "", "The list to go through."),
            ("output", "item", "", "The present item."),
        ),
    ),
    "Consume": (
        "Decorator",
        (
            ("inout", "queue", "", "The list that items are taken off."),
            ("output", "item", "", "The present item."),
        ),
    ),
    "LoopUntil": (
        "Control",
        (
            (
                "input",
                "max",
                "int",
                "Rounds at most; the first child decides when the loop ends.",
            ),
        ),
    ),
    "OnHalt": ("Control", ()),  # the second child is ticked once, when the first is halted
    "Ask": (
        "Action",
        (
            ("input", "question", "string", "What the operator is asked; yes is success."),
            ("input", "default", "string", "The answer if no one can be asked."),
            ("input", "choices", "string", "What to choose from; empty for yes and no."),
            ("output", "answer", "string", "The choice."),
        ),
    ),
    "Holds": (
        "Condition",
        (("input", "expression", "string", "A condition in the mission's expressions."),),
    ),
}


def node_models(mission: MissionFile, ids: Mapping[str, str], tags: Collection[str]) -> Element:
    """Return the models of the leaves, subtrees and own nodes that a mission uses.

    Args:
        mission: The mission.
        ids: The IDs of its trees, by name.
        tags: The tags that its trees are written with.
    """
    models = Element("TreeNodesModel")
    nodes = [node for tree in mission.trees.values() for node in tree.root.walk()]
    every = sorted((use for node in nodes for use in uses_of(node)), key=lambda use: len(use.uses))
    uses = {use.name: use for use in every}  # one that names plugins, if there is any
    models.extend(_leaf_model(use) for _, use in sorted(uses.items()))
    called = {node.kind.tree for node in nodes if isinstance(node.kind, Call)}
    models.extend(_tree_model(mission.trees[name], ids[name]) for name in sorted(called))
    models.extend(_own_model(tag) for tag in OWN if tag in tags)
    return models


def _leaf_model(use: LeafUse) -> Element:
    leaf = use.leaf
    model = Element("Action" if issubclass(leaf, Action) else "Condition", ID=leaf_tag(use.name))
    for name, field in leaf.Settings.model_fields.items():
        default = None if field.is_required() else field.get_default(call_default_factory=True)
        _port(model, "input_port", name, "", field.description or "", default)
    for side, ports in (("input_port", leaf.inputs), ("output_port", leaf.outputs)):
        for name, port in ports.items():
            _port(model, side, name, type_name(port.type), port.doc)
    if use.uses:
        _port(model, "input_port", USES, "", "The plugins that it uses, by name.")
    summary = (inspect.getdoc(leaf) or "").partition("\n")[0]
    SubElement(SubElement(model, "MetadataFields"), "Metadata", description=summary)
    return model


def _tree_model(tree: Tree, written: str) -> Element:
    model = Element("SubTree", ID=written)
    for side, ports in (("input_port", tree.inputs), ("output_port", tree.outputs)):
        for name, wanted in ports.items():
            _port(model, side, name, wanted.text, "")
    return model


def _own_model(tag: str) -> Element:
    sort, ports = _OWN_PORTS[tag]
    model = Element(sort, ID=tag)
    for side, name, kind, doc in ports:
        _port(model, f"{side}_port", name, kind, doc)
    return model


def _port(
    model: Element, side: str, name: str, kind: str, doc: str, default: object = None
) -> None:
    port = SubElement(model, side, name=attribute(name))
    if kind:
        port.set("type", kind)
    if default is not None:
        port.set("default", str(default))
    port.text = doc
