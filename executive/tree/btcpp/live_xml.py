"""A tree that runs as BehaviorTree.CPP 4 XML: every node with its number, every call expanded.

It is what `WriteTreeToXML` of BehaviorTree.CPP gives with metadata: `_uid` at each node, and
`_fullpath` at each SubTree and at the BehaviorTree that it stands for. The nodes are those that are
ticked: a modifier is a decorator of its own. Names of nodes say what a monitor shows, such as
`timeout 30 s`; attributes are for people, and no engine would take this tree.
"""

from collections.abc import Callable, Mapping
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from py_trees.behaviour import Behaviour

from executive.tree.btcpp.export_xml import TreeWriter
from executive.tree.btcpp.names import leaf_tag, tree_id
from executive.tree.btcpp.node_model import node_models
from executive.tree.conditions import condition_text
from executive.tree.language import MissionFile
from executive.tree.modifiers import (
    IfNode,
    OnceNode,
    OnFailureNode,
    OnHaltNode,
    OptionalNode,
    RetryNode,
    TimeoutNode,
    WhileNode,
)
from executive.tree.node_kinds import Branch, Call, CheckKeys, Group, Kind, Set, Switch
from executive.tree.resolved import source_value
from executive.tree.small_nodes import CallNode
from executive.tree.traversal import uses_of

_MODIFIERS: Mapping[type[Behaviour], str] = {
    IfNode: "If",
    OnceNode: "RunOnce",
    WhileNode: "While",
    TimeoutNode: "Timeout",
    RetryNode: "RetryUntilSuccessful",
    OnFailureNode: "OnFailure",
    OptionalNode: "ForceSuccess",
    OnHaltNode: "OnHalt",
}
_OWN: Mapping[str, str] = {  # sorts of nodes that BehaviorTree.CPP lacks
    "If": "Decorator",
    "While": "Decorator",
    "Group": "Decorator",
    "OnFailure": "Control",
    "OnHalt": "Control",
    "IfElse": "Control",
    "WhileElse": "Control",
    "Switch": "Control",
    "SetKeys": "Action",
    "Expression": "Condition",
}


def live_xml(mission: MissionFile, root: Behaviour, uid: Callable[[Behaviour], int]) -> str:
    """Return the XML of a tree that was built for a mission.

    Args:
        mission: The mission.
        root: The root node.
        uid: Gives each node's number.
    """
    nodes = [node for tree in mission.trees.values() for node in tree.root.walk()]
    leaves = frozenset(leaf_tag(use.name) for node in nodes for use in uses_of(node))
    ids = {name: tree_id(name, leaves) for name in mission.trees}
    document = Element("root", BTCPP_format="4", main_tree_to_execute=ids["main"])
    writer = _LiveWriter(document, ids, uid)
    writer.tree("main", "", root)
    tags = {element.tag for element in document.iter()}
    models = node_models(mission, ids, tags)
    known = {model.get("ID") for model in models}
    for tag, sort in _OWN.items():
        if tag in tags and tag not in known:
            SubElement(models, sort, ID=tag)
    document.append(models)
    indent(document, "  ")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{tostring(document, encoding="unicode")}'


class _LiveWriter:
    """Writes each tree of a running mission beside the one that calls it."""

    def __init__(
        self, document: Element, ids: Mapping[str, str], uid: Callable[[Behaviour], int]
    ) -> None:
        self._document = document
        self._ids = ids
        self._uid = uid
        self._heads = TreeWriter(ids)

    def tree(self, name: str, path: str, root: Behaviour) -> None:
        """Write a tree, and after it those that it calls."""
        written = SubElement(
            self._document, "BehaviorTree", {"ID": self._ids[name], "_fullpath": path}
        )
        written.append(self._node(root))

    def _node(self, node: Behaviour) -> Element:
        element = self._head(node)
        element.set("name", node.name)
        element.set("_uid", str(self._uid(node)))
        if isinstance(node, CallNode):
            element.set("_fullpath", node.path)
            self.tree(node.described.tree, node.path, node.children[0])
        else:
            element.extend([self._node(child) for child in node.children])
        return element

    def _head(self, node: Behaviour) -> Element:
        if type(node) in _MODIFIERS:
            return Element(_MODIFIERS[type(node)])
        kind: Kind = node.described
        match kind:
            case Group():
                return Element("Group")
            case Branch(kind=how, condition=condition):
                tag = "IfElse" if how == "if" else "WhileElse"
                return Element(tag, condition=condition_text(condition))
            case Switch(source=source):
                return Element("Switch", variable=f"{{{source.key}}}")
            case Set(values=values):
                return Element(
                    "SetKeys", {key: str(source_value(one)) for key, one in values.items()}
                )
            case CheckKeys(condition=condition):
                return Element("Expression", expression=condition_text(condition))
            case Call():
                return self._heads.kind_element(kind)
        whole = self._heads.kind_element(kind)  # its children are not those that are ticked
        return Element(whole.tag, whole.attrib)
