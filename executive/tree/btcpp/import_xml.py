"""BehaviorTree.CPP 4 XML as a mission.

Nodes, scripts, pre- and postconditions become what means the same in the mission language; what has
no counterpart is refused with its place. The blackboard of a tree becomes its store: a port of a
SubTree is an input or an output, or both, as the TreeNodesModel says, else as the tree uses it.
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from executive.tree.btcpp.elements import XmlElement, read_elements
from executive.tree.btcpp.names import is_taken
from executive.tree.btcpp.read_leaf import LeafImporter, Model, literal, read_models, unwrapped
from executive.tree.btcpp.read_nodes import NodeImporter
from executive.tree.btcpp.wrapping import Data
from executive.tree.catalogue import Catalogue
from executive.tree.problem import Mark, Problem, Problems
from executive.tree.sources import API

MAIN = "main"
_KEY = re.compile(r"\{([A-Za-z_]\w*)")
_TYPES = {"std::string": "str", "string": "str", "double": "float", "": "object"}
_TYPE_NAME = re.compile(r"(\w+|list\[\w+\])\??")


@dataclass(frozen=True, slots=True)
class Imported:
    """A mission as data, and what is worth a second look."""

    document: Data
    warnings: tuple[Problem, ...]


def from_xml(text: str, file: str, catalogue: Catalogue, mission: str) -> Imported:
    """Return the trees of an XML file as a mission.

    Args:
        text: The XML.
        file: Its name, for messages.
        catalogue: The behaviours that are installed; of others the XML's models tell the ports.
        mission: The name of the mission.

    Raises:
        MissionFileError: If it is no XML of BehaviorTree.CPP, or holds what a mission cannot say;
            all of it is listed, each with its line.
    """
    problems = Problems()
    root = read_elements(text, file)
    trees = _trees(root, problems)
    problems.raise_errors()
    models = read_models(root)
    names = _names(root, trees, problems)
    problems.raise_errors()
    nodes = NodeImporter(LeafImporter(catalogue, models, problems), names, problems)
    bodies = {names[id_]: nodes.node(tree.children[0]) for id_, tree in trees.items()}
    ports = {names[id_]: model for id_, model in models.items() if id_ in names}
    written = _Ports(bodies, ports, problems).written()
    problems.raise_errors()
    return Imported({"api": API, "mission": mission, "trees": written}, problems.warnings())


def _trees(root: XmlElement, problems: Problems) -> dict[str, XmlElement]:
    if root.tag != "root":
        problems.error(root.mark, f"the outermost element is 'root', not '{root.tag}'")
    if root.get("BTCPP_format", "4") != "4":
        problems.error(root.mark, f"BTCPP_format is {root.get('BTCPP_format')}, and 4 is read")
    trees: dict[str, XmlElement] = {}
    for element in root.children:
        if element.tag == "include":
            problems.error(element.mark, "include cannot be said: put the trees into one file")
        if element.tag != "BehaviorTree":
            continue
        if len(element.children) != 1:
            told = f"a BehaviorTree has one child, here are {len(element.children)}"
            problems.error(element.mark, told)
        trees[element.get("ID", f"BehaviorTree_{len(trees)}")] = element
    if root.tag == "root" and not trees:
        problems.error(root.mark, "there is no BehaviorTree")
    return trees


def _names(root: XmlElement, trees: Mapping[str, XmlElement], problems: Problems) -> dict[str, str]:
    """Return the names of the trees by their IDs; the one that is run is `main`."""
    first = root.get("main_tree_to_execute") or (next(iter(trees)) if len(trees) == 1 else "")
    if first not in trees:
        told = f"there is no tree '{first}'" if first else "it must name the tree that is run"
        problems.error(root.mark, f"main_tree_to_execute: {told}")
    names: dict[str, str] = {}
    for id_, element in trees.items():
        plain = id_.removesuffix("_tree") if is_taken(id_.removesuffix("_tree")) else id_
        name = MAIN if id_ == first else re.sub(r"\W", "_", plain)
        if name in names.values():
            problems.error(element.mark, f"two trees would be called '{name}'")
        names[id_] = name
    return names


class _Ports:
    """Gives trees their ports and calls their wires."""

    def __init__(
        self, bodies: Mapping[str, Data], models: Mapping[str, Model], problems: Problems
    ) -> None:
        self._bodies = bodies
        self._models = models
        self._problems = problems
        self._calls = [call for body in bodies.values() for call in _calls(body)]

    def written(self) -> dict[str, Data]:
        """Return the trees as a mission writes them."""
        headers = {name: self._header(name) for name in self._bodies}
        for call in self._calls:
            self._wire(call, *headers[call["call"]])
        return {
            name: {
                **({"in": ins} if (ins := headers[name][0]) else {}),
                **({"out": outs} if (outs := headers[name][1]) else {}),
                **(body if not {"in", "out"} & body.keys() else {"do": body}),
            }
            for name, body in ((MAIN, self._bodies[MAIN]), *self._others())
        }

    def _others(self) -> Iterator[tuple[str, Data]]:
        return ((name, body) for name, body in self._bodies.items() if name != MAIN)

    def _header(self, name: str) -> tuple[dict[str, str], dict[str, str]]:
        """Return the types of a tree's inputs and outputs."""
        model = self._models.get(name)
        if model is not None:
            types = {port: _type(text) for port, text in model.types.items()}
            sides = model.sides.items()
            return (
                {port: types[port] for port, side in sides if side == "in"},
                {port: types[port] for port, side in sides if side == "out"},
            )
        calls = [call for call in self._calls if call["call"] == name]
        reads, writes = _keys(self._bodies[name])
        given = {port for call in calls for port in call["ports"]}
        if any(call.get("is_automatic") for call in calls):
            given |= {key for key in reads | writes if not key.startswith("_")}
        outs = sorted(given & writes)
        ins = sorted(port for port in given if port in reads or port not in writes)
        return (
            {port: "object?" if port in writes else "object" for port in ins},
            dict.fromkeys(outs, "object"),
        )

    def _wire(self, call: Data, ins: Mapping[str, str], outs: Mapping[str, str]) -> None:
        given, mark = call.pop("ports"), call.pop("mark")
        is_automatic = call.pop("is_automatic", False)
        model = self._models.get(call["call"])
        inputs: Data = {}
        outputs: Data = {}
        for port in {**ins, **outs}:
            text = given.get(port, model.defaults.get(port, "") if model else "")
            if not text and not is_automatic and not ins.get(port, "").endswith("?"):
                self._problems.error(mark, f"the call of {call['call']} gives no port '{port}'")
            if text in ("", "{=}", f"{{{port}}}"):
                continue
            if port in ins:
                inputs[port] = unwrapped(text) if "{" in text else literal(text)
            if port in outs:
                self._output(port, text, mark, outputs)
        for port in given.keys() - ins.keys() - outs.keys():
            self._problems.error(mark, f"{call['call']} has no port '{port}'")
        call.update({side: wires for side, wires in (("in", inputs), ("out", outputs)) if wires})

    def _output(self, port: str, text: str, mark: Mark, outputs: Data) -> None:
        if _KEY.match(text) and text.endswith("}"):
            outputs[port] = text
        elif not text.startswith("{"):  # a literal: what the tree writes goes nowhere
            self._problems.error(mark, f"port '{port}' is written by the tree, and given '{text}'")


def _type(text: str) -> str:
    known = _TYPES.get(text, text)
    return known if _TYPE_NAME.fullmatch(known) else "object"


def _calls(node: Any) -> Iterator[Data]:
    if isinstance(node, list):
        for one in node:
            yield from _calls(one)
    elif isinstance(node, dict):
        if "call" in node and "ports" in node:
            yield node
        for value in node.values():
            yield from _calls(value)


def _keys(node: Any) -> tuple[set[str], set[str]]:
    """Return the keys that a tree reads and writes."""
    if isinstance(node, str):
        return set(_KEY.findall(node)), set()
    if isinstance(node, dict):
        read, written = _below(value for key, value in node.items() if key not in ("out", "mark"))
        return read, written | _written(node)
    return _below(node) if isinstance(node, list) else (set(), set())


def _below(nodes: Iterable[Any]) -> tuple[set[str], set[str]]:
    several = [_keys(one) for one in nodes]
    return {key for one, _ in several for key in one}, {key for _, one in several for key in one}


def _written(node: Data) -> set[str]:
    """Return the keys that a node itself writes, or may write by a port."""
    wires = {**node.get("out", {}), **node.get("ports", {})}
    loop = node.get("for_each") or node.get("consume") or {}
    found = {key for text in wires.values() for key in _KEY.findall(str(text))}
    return {*node.get("set", {}), *([loop["item"]] if loop else []), *found}
