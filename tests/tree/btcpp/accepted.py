"""Missions whose XML the real BehaviorTree.CPP must take: the shipped ones, and every kind of node.

As a command it asks the library and records its answers:

    BTCPP_SOURCES=BehaviorTree.CPP python tests/tree/btcpp/accepted.py
"""

import json
import sys
from collections import Counter
from hashlib import sha256
from pathlib import Path
from xml.etree import ElementTree

import cases
import ours
import real

from executive.tree.btcpp.export_xml import to_xml
from executive.tree.btcpp.names import BUILT_IN, COMPOSITES, TURNED
from executive.tree.load import load_mission
from executive.tree.problem import MissionFileError
from executive.tree.sources import shipped_names

# Ports and children of the library's nodes, as far as they are written.
WITHOUT_PORTS = ("IfThenElse", "WhileDoElse", "ForceSuccess", "AlwaysSuccess", "AlwaysFailure")
ATTRIBUTES: dict[str, set[str | None]] = {
    **{tag: set() for tag in (*COMPOSITES.values(), *TURNED.values(), *WITHOUT_PORTS)},
    **{
        f"Switch{count}": {"variable", *(f"case_{one}" for one in range(1, count + 1))}
        for count in range(2, 7)
    },
    "Parallel": {"success_count", "failure_count"},
    "ParallelAll": {"max_failures"},
    "TryCatch": {"catch_on_halt"},
    "RetryUntilSuccessful": {"num_attempts"},
    "Repeat": {"num_cycles"},
    "Timeout": {"msec"},
    "RunOnce": {"then_skip"},
    "Script": {"code"},
    "ScriptCondition": {"code"},
    "SetBlackboard": {"value", "output_key"},
    "Sleep": {"msec"},
}
CHILDREN = {
    **dict.fromkeys(("Inverter", "ForceFailure", "ForceSuccess", "RetryUntilSuccessful"), (1, 1)),
    **dict.fromkeys(("Repeat", "Timeout", "RunOnce"), (1, 1)),
    **dict.fromkeys((*COMPOSITES.values(), "Parallel", "ParallelAll"), (1, 99)),
    **{f"Switch{count}": (count + 1, count + 1) for count in range(2, 7)},
    "IfThenElse": (2, 3),
    "WhileDoElse": (2, 3),
    "TryCatch": (2, 99),
}
RECORDED = Path(__file__).parent / "recorded" / "accepted.json"


def shipped() -> dict[str, str]:
    """Return the XML of the shipped missions, by name."""
    return {name: to_xml(load_mission(name)) for name in shipped_names()}


def of_cases() -> dict[str, str]:
    """Return the XML of all cases, by name."""
    found: dict[str, str] = {}
    for case in cases.all_cases():
        if case.main is None or case.refused:
            continue
        main = cases.expanded(case.main)
        if case.store:
            main = {"sequence": [{"set": case.store}, main]}
        try:
            found[f"{case.file}: {case.case}"] = to_xml(
                ours.loaded(main, cases.expanded(case.trees))
            )
        except MissionFileError as error:  # the test of the cases tells it, too
            print(f"{case.case}: {error}", file=sys.stderr)
    return found


def objections(xml: str) -> list[str]:
    """Return what the library's parser would refuse, by the rules that it states in its errors."""
    root = ElementTree.fromstring(xml)
    models = {model.get("ID"): model for model in root.find("TreeNodesModel") or ()}
    told: list[str] = []
    for tree in root.findall("BehaviorTree"):
        names = [one.get("name") for one in tree.iter("SubTree") if one.get("name")]
        told += [f"two SubTrees are called {name}" for name, n in Counter(names).items() if n > 1]
        if len(tree) != 1 or tree.get("ID") in BUILT_IN or tree.get("ID") in _leaves(models):
            told.append(f"the tree {tree.get('ID')} has a node's name, or not one child")
        for element in list(tree.iter())[1:]:
            told += _objections(element, models)
    return told


def _leaves(models: dict[str | None, ElementTree.Element]) -> set[str | None]:
    return {id_ for id_, model in models.items() if model.tag != "SubTree"}


def _objections(
    element: ElementTree.Element, models: dict[str | None, ElementTree.Element]
) -> list[str]:
    tag, count = element.tag, len(element)
    if tag in ("Action", "Condition", "Control", "Decorator"):
        return [f"{tag} in long form, which ReactiveSequence refuses"]
    model = models.get(element.get("ID") if tag == "SubTree" else tag)
    if model is None:
        wanted = ATTRIBUTES.get(tag)
        if wanted is None:
            return [f"{tag} is no node"]
    else:
        wanted = {one.get("name") for one in model if one.tag.endswith("_port")}
    given = {key for key in element.attrib if not key.startswith("_")} - {"name", "ID"}
    told = [f"{tag} has no port {name}" for name in given - wanted]
    if model is not None and tag == "SubTree":
        told += [f"the call gives no {name}" for name in wanted - given]
    least, most = CHILDREN.get(tag, (0, 0) if model is None else _children(model.tag))
    return told if least <= count <= most else [*told, f"{tag} has {count} children"]


def _children(sort: str) -> tuple[int, int]:
    return {"Control": (1, 99), "Decorator": (1, 1)}.get(sort, (0, 0))


def digest(xml: str) -> str:
    """Return what a recorded answer belongs to."""
    return sha256(xml.encode()).hexdigest()[:12]


def main() -> int:
    """Ask the library, tell what it refuses, and record what it takes."""
    found = {**shipped(), **of_cases()}
    try:
        answers = real.answers([real.Scene(xml, ticks=0) for xml in found.values()])
    except real.NotFoundError as error:
        print(f"not asked: {error}", file=sys.stderr)
        return 2
    refused = 0
    taken: dict[str, str] = {}
    for (name, xml), answer in zip(found.items(), answers, strict=True):
        if "error" in answer:
            refused += 1
            print(f"{name}: {answer['error']}")
        else:
            taken |= {name: digest(xml)} if ":" in name else {}
    RECORDED.parent.mkdir(exist_ok=True)
    RECORDED.write_text(json.dumps(taken, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    print(f"{len(found) - refused} of {len(found)} taken, {refused} refused")
    return 1 if refused else 0


if __name__ == "__main__":
    sys.exit(main())
