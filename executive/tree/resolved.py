"""A resolved mission: one file with every setting, tree and wire explicit, which loads again."""

from collections.abc import Mapping
from typing import Any

import yaml

from executive.config import Settings
from executive.registry import is_plural
from executive.tree.expressions.syntax import Truth
from executive.tree.instances import USE
from executive.tree.key_source import Computed, Literally, Ref, Source
from executive.tree.language import MissionFile, Tree, TypeName
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
from executive.tree.scalar import SurpriseError, resolve
from executive.tree.selection import ON_ERROR, Selection
from executive.tree.settings import settings_dump
from executive.tree.sources import API


def resolved_yaml(mission: MissionFile) -> str:
    """Return a complete mission file; loading it gives the same mission."""
    return yaml_text(resolved_document(mission))


def yaml_text(document: Mapping[str, Any]) -> str:
    """Return a document as YAML 1.2, without aliases; reading it gives the same document."""
    return yaml.dump(dict(document), Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=120)


def yaml_flow(value: Any) -> str:
    """Return a value as YAML 1.2 in one line: `{angle: 120 deg, duration: 20 s}`."""
    text = yaml.dump(
        value,
        Dumper=_Dumper,
        default_flow_style=True,
        sort_keys=False,
        allow_unicode=True,
        width=float("inf"),
    )
    return text.removesuffix("\n...\n").strip()


def resolved_document(mission: MissionFile) -> dict[str, Any]:
    """Return the content of a complete mission file: mappings, lists and scalars."""
    document: dict[str, Any] = {"api": API, "mission": mission.name}
    if mission.description:
        document["description"] = mission.description
    document["loop"] = settings_dump(mission.loop)
    document["plugins"] = _plugins(mission.plugins)
    if mission.regions:
        document["regions"] = {
            name: {"polygon": region.corners_map.tolist()}
            for name, region in mission.regions.items()
        }
    if mission.watch:
        document["watch"] = {name: _given(rule) for name, rule in mission.watch.items()}
    if mission.faults:
        document["faults"] = [_given(fault) for fault in mission.faults]
    document["trees"] = {name: _tree(tree) for name, tree in mission.trees.items()}
    return document


def _given(settings: Settings) -> dict[str, Any]:
    """Return the settings that are not absent."""
    return {name: one for name, one in settings_dump(settings).items() if one is not None}


class _Dumper(yaml.SafeDumper):
    """Writes YAML 1.2: no aliases, and quotes wherever a plain text would be read otherwise."""

    def ignore_aliases(self, data: Any) -> bool:
        return True

    def text(self, text: str) -> yaml.ScalarNode:
        """Represent a text."""
        try:
            is_plain = resolve(text) == text
        except SurpriseError:
            is_plain = False
        return self.represent_scalar("tag:yaml.org,2002:str", text, style=None if is_plain else '"')


_Dumper.add_representer(str, _Dumper.text)


def _selection(one: Selection) -> dict[str, Any]:
    on_error = {ON_ERROR: "fail"} if one.can_fail else {}
    uses = {USE: dict(one.uses)} if one.uses else {}
    return {"plugin": one.name, **on_error, **uses, **settings_dump(one.settings)}


def _plugins(plugins: Mapping[str, tuple[Selection, ...]]) -> dict[str, Any]:
    """Return `plugins:`, those with names below their capability."""
    written: dict[str, Any] = {}
    for key, several in plugins.items():
        capability, _, name = key.partition(".")
        if name:
            written.setdefault(capability, {})[name] = _selection(several[0])
        else:
            written[capability] = _selections(capability, several)
    return written


def _selections(capability: str, several: tuple[Selection, ...]) -> Any:
    written = [_selection(one) for one in several]
    return written if is_plural(capability) else written[0]


def _tree(tree: Tree) -> dict[str, Any]:
    ports = {"in": _ports(tree.inputs), "out": _ports(tree.outputs)}
    return {side: types for side, types in ports.items() if types} | node_dict(tree.root)


def _ports(ports: Mapping[str, TypeName]) -> dict[str, str]:
    return {port: wanted.text for port, wanted in ports.items()}


def node_dict(node: Node) -> dict[str, Any]:
    """Return a node as the mission language writes it."""
    return _kind(node.kind) | _modifiers(node.modifiers)


def _kind(kind: Kind) -> dict[str, Any]:  # noqa: C901 - one case a kind
    match kind:
        case Composite():
            return {kind.kind: [node_dict(child) for child in kind.children]}
        case Parallel():
            return _parallel(kind)
        case Turned(kind=how, child=child):
            return {how: node_dict(child)}
        case Branch():
            return _branch(kind)
        case Switch(source=source, cases=cases):
            written = {name: node_dict(case) for name, case in cases.items()}
            return {"switch": source_value(source), "cases": written, **_otherwise(kind)}
        case Group(child=child):
            return {"do": node_dict(child)}
        case Loop(until=until, max_rounds=rounds, body=body):
            given = {"until": condition_value(until) if until else None, "max": rounds}
            head = {key: value for key, value in given.items() if value is not None}
            return {"loop": head or "forever", "do": node_dict(body)}
        case ForEach(item=item, source=source, body=body):
            return {"for_each": {"item": item, "in": source_value(source)}, "do": node_dict(body)}
        case Consume(item=item, source=source, body=body):
            taken = {"item": item, "from": source_value(source)}
            return {"consume": taken, "do": node_dict(body)}
        case RunLeaf(use=use):
            return {"run": use.name, **_use(use)}
        case CheckLeaf(use=use):
            return {"check": use.name, **_use(use)}
        case CheckKeys(condition=condition):
            return {"check": condition_value(condition)}
        case Wait(duration_s=duration_s):
            return {"wait": duration_s}
        case Set(values=values):
            return {"set": {key: source_value(source) for key, source in values.items()}}
        case Ask():
            return _ask(kind)
        case Call():
            wires: dict[str, Any] = {"in": _wires(kind.inputs), "out": _wires(kind.outputs)}
            wires[USE] = dict(kind.uses)
            return {"call": kind.tree, **{side: given for side, given in wires.items() if given}}


def _parallel(kind: Parallel) -> dict[str, Any]:
    written: dict[str, Any] = {"parallel": [node_dict(child) for child in kind.children]}
    written |= {"succeed": kind.succeed}
    if kind.fail != len(kind.children) - kind.succeed + 1:
        written["fail"] = kind.fail
    if kind.wait_for_all:
        written["wait_for_all"] = True
    return written


def _branch(kind: Branch) -> dict[str, Any]:
    body = "then" if kind.kind == "if" else "do"
    asked = {kind.kind: condition_value(kind.condition), body: node_dict(kind.then)}
    return asked | _otherwise(kind)


def _otherwise(kind: Branch | Switch) -> dict[str, Any]:
    return {"else": node_dict(kind.otherwise)} if kind.otherwise else {}


def _ask(kind: Ask) -> dict[str, Any]:
    parts = {
        "ask": str(kind.question),
        "choices": list(kind.choices) or None,
        "default": kind.default,
        "out": {"answer": source_value(kind.answer)} if kind.answer else None,
    }
    return {key: part for key, part in parts.items() if part is not None}


def _use(use: LeafUse) -> dict[str, Any]:
    parts = {
        "with": _settings(use),
        "in": _wires(use.inputs),
        "out": _wires(use.outputs),
        USE: dict(use.uses),
    }
    return {key: part for key, part in parts.items() if part}


def _settings(use: LeafUse) -> Mapping[str, Any]:
    computed = use.parameters.sources if use.parameters else {}
    literals = {k: v for k, v in settings_dump(use.settings).items() if k not in computed}
    return {**literals, **{name: source_value(source) for name, source in computed.items()}}


def _wires(wires: Mapping[str, Source]) -> dict[str, Any]:
    """Return the wires that the file lists; optional ports may stay unconnected."""
    return {
        port: source_value(one)
        for port, one in wires.items()
        if not isinstance(one, Ref) or one.is_listed
    }


def source_value(source: Source) -> Any:
    """Return a reference or literal as the mission language writes it."""
    if isinstance(source, Literally):
        return source.value
    return f"{{{source.key}}}" if isinstance(source, Ref) else str(source)


def condition_value(condition: Condition) -> Any:
    """Return a condition as the mission language writes it."""
    if isinstance(condition, LeafUse):
        return {"check": condition.name, **_use(condition)}
    if isinstance(condition, KeyHolds):
        return f"{{{condition.key}}}"
    if isinstance(condition, Computed):
        expression = condition.expression
        return expression.value if isinstance(expression, Truth) else str(condition)
    parts = [condition_value(part) for part in condition.parts]
    return {condition.how: parts[0] if condition.how == "not" else parts}


def _modifiers(modifiers: Modifiers) -> dict[str, Any]:
    recovery = modifiers.on_failure
    written = {
        "if": condition_value(modifiers.if_) if modifiers.if_ else None,
        "once": modifiers.once or None,
        "while": condition_value(modifiers.while_) if modifiers.while_ else None,
        "timeout": modifiers.timeout_s,
        "retry": _attempts(modifiers.retry) if modifiers.retry else None,
        "on_failure": node_dict(recovery) if recovery else None,
        "optional": modifiers.optional or None,
        "on_halt": node_dict(modifiers.on_halt) if modifiers.on_halt else None,
        "name": modifiers.name or None,
    }
    return {key: value for key, value in written.items() if value is not None}


def _attempts(attempts: Attempts) -> Any:
    return (
        {"attempts": attempts.count, "pause": attempts.pause_s}
        if attempts.pause_s
        else attempts.count
    )
