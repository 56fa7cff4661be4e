"""Attributes of a leaf as settings, inputs and outputs of a mission's leaf."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from executive.errors import ConfigError, did_you_mean
from executive.leaf.action import Action, Leaf
from executive.tree.btcpp.elements import XmlElement
from executive.tree.btcpp.names import USES, leaf_name, port, uses_of_attribute
from executive.tree.catalogue import Catalogue
from executive.tree.problem import Problems
from executive.tree.setting_types import takes_text

Data = dict[str, Any]
_SIDES = {"input_port": "in", "output_port": "out", "inout_port": "in"}


@dataclass(frozen=True, slots=True)
class Model:
    """What the TreeNodesModel says of a node: `Action`, `Condition`, …, and its ports' sides."""

    sort: str
    sides: Mapping[str, str] = field(default_factory=dict)
    defaults: Mapping[str, str] = field(default_factory=dict)
    types: Mapping[str, str] = field(default_factory=dict)


def read_models(root: XmlElement) -> dict[str, Model]:
    """Return the models of a file by the IDs of their nodes."""
    models: dict[str, Model] = {}
    for listing in (child for child in root.children if child.tag == "TreeNodesModel"):
        for model in listing.children:
            ports = [one for one in model.children if one.tag in _SIDES and one.get("name")]
            models[model.get("ID")] = Model(
                model.tag,
                {one.get("name"): _SIDES[one.tag] for one in ports},
                {
                    one.get("name"): one.get("default")
                    for one in ports
                    if "default" in one.attributes
                },
                {one.get("name"): one.get("type") for one in ports},
            )
    return models


@dataclass(frozen=True, slots=True)
class LeafImporter:
    """Turns elements of leaves into nodes."""

    catalogue: Catalogue
    models: Mapping[str, Model]
    problems: Problems

    def leaf(self, element: XmlElement, given: Mapping[str, str]) -> Data:
        """Return the node of a leaf; `given` are its attributes without those for all nodes."""
        is_long = element.tag in ("Action", "Condition")
        tag = element.get("ID") if is_long else element.tag
        name = leaf_name(tag)
        try:
            leaf = self.catalogue.behaviour(name)
        except ConfigError as error:
            told = f"{error}: `executive check` refuses the mission until a plugin brings it"
            self.problems.warning(element.mark, told)
            model = self.models.get(tag, Model(element.tag if is_long else "Action"))
            kind = "check" if model.sort == "Condition" else "run"
            return {kind: name, **self._by_model(model, given)}
        kind = "run" if issubclass(leaf, Action) else "check"
        return {kind: name, **self._by_class(element, leaf, given)}

    def _by_class(
        self, element: XmlElement, leaf: type[Leaf[Any]], given: Mapping[str, str]
    ) -> Data:
        parts: dict[str, Data] = {"with": {}, "in": {}, "out": {}}
        for attribute, text in given.items():
            name = port(attribute)
            if name == USES and name not in leaf.Settings.model_fields:
                parts[USES] = uses_of_attribute(text)
            elif name in leaf.Settings.model_fields:
                value = _setting(leaf, name, text)
                if value is not None:
                    parts["with"][name] = value
            elif name in leaf.inputs or name in leaf.outputs:
                side = "in" if name in leaf.inputs else "out"
                self._wire(element, side, name, text, parts)
            else:
                known = (*leaf.Settings.model_fields, *leaf.inputs, *leaf.outputs)
                told = f"{leaf.__name__} has no port '{name}'{did_you_mean(name, known)}"
                self.problems.error(element.mark, told)
        return {side: wires for side, wires in parts.items() if wires}

    def _wire(
        self, element: XmlElement, side: str, name: str, text: str, parts: dict[str, Data]
    ) -> None:
        if "{" not in text:
            told = f"port '{name}' takes a key, not '{text}': write it with a Script before"
            self.problems.error(element.mark, told)
        elif unwrapped(text) not in (f"{{{name}}}", "{=}"):  # of the same name: not listed
            parts[side][name] = unwrapped(text)

    def _by_model(self, model: Model, given: Mapping[str, str]) -> Data:
        parts: dict[str, Data] = {"with": {}, "in": {}, "out": {}}
        for attribute, text in given.items():
            name = port(attribute)
            key = f"{{{name}}}" if text == "{=}" else text
            side = model.sides.get(attribute, "in") if "{" in text else "with"
            parts[side][name] = key if side != "with" else literal(text)
        return {side: wires for side, wires in parts.items() if wires}


def unwrapped(text: str) -> str:
    """Return an expression without the parentheses that keep it from looking like one key."""
    return text[1:-1] if text.startswith("({") and text.endswith("})") else text


def literal(text: str) -> Any:
    """Return a literal of an attribute: a number, a truth value, a list, or the text itself."""
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return text


def _setting(leaf: type[Leaf[Any]], name: str, text: str) -> Any:
    """Return a setting's value, or None if it is the default."""
    info = leaf.Settings.model_fields[name]
    if not info.is_required():
        default = info.get_default(call_default_factory=True)
        if text == (default if isinstance(default, str) else json.dumps(default, default=str)):
            return None
    if "{" in text:
        return unwrapped(text)
    return text if takes_text(info) else literal(text)
