"""Trees at random that the executive and BehaviorTree.CPP must play alike.

Left out is what differs on purpose (docs/node_rules.md, "Where it differs on purpose"): actions
before the last child of a reactive sequence without any condition, earlier children of a reactive
fallback that fail after some time; what is left out as a child of a parallel, a round of a loop or
within a timeout; and persistent sequences in called trees.
"""

from dataclasses import dataclass, field
from random import Random
from typing import Any
from xml.etree import ElementTree

from executive.tree.btcpp.export_xml import to_xml
from executive.tree.language import MissionFile

TICKS = 14
Data = dict[str, Any]


@dataclass(frozen=True, slots=True)
class RandomScene:
    """A tree as data, and how it is ticked."""

    main: Data
    trees: dict[str, Data]
    halts: tuple[int, ...]

    @property
    def has_timers(self) -> bool:
        """Whether an order of events within a tick may differ: timers fire between the ticks."""
        return "timeout" in str(self.main) or "timeout" in str(self.trees)


@dataclass(frozen=True, slots=True)
class _Place:
    """What may stand at a place of the tree."""

    depth: int
    may_skip: bool = True  # be left out
    in_call: bool = False

    def below(self, *, may_skip: bool | None = None, in_call: bool = False) -> "_Place":
        skips = self.may_skip if may_skip is None else self.may_skip and may_skip
        return _Place(self.depth - 1, skips, self.in_call or in_call)


@dataclass(slots=True)
class _Maker:
    chance: Random
    leaves: int = 0
    trees: dict[str, Data] = field(default_factory=dict)

    def name(self) -> str:
        """Return the name of a new leaf: a, b, … z, a1, …"""
        number, self.leaves = self.leaves, self.leaves + 1
        return chr(ord("a") + number % 26) + (str(number // 26) if number > 25 else "")

    def act(self, least: int = 0, ends: str = "") -> Data:
        """Return an action that takes at least so many ticks."""
        script = ends or "".join(self.chance.choices("sssf", k=self.chance.randint(1, 4)))
        ticks = max(least, self.chance.choice([0, 0, 1, 1, 2, 3]))
        return {"run": "Act", "with": {"id": self.name(), "ticks": ticks, "ends": script}}

    def given(self) -> Data:
        """Return a condition whose answer changes over the ticks."""
        answers = "".join(self.chance.choices("110", k=self.chance.randint(1, TICKS)))
        return {"check": "Given", "with": {"id": self.name(), "answers": answers}}

    def condition(self) -> Data:
        """Return a condition of one to three leaves."""
        how = self.chance.choice(["one", "one", "one", "not", "all", "any"])
        if how == "one":
            return self.given()
        return {how: self.given() if how == "not" else [self.given(), self.given()]}

    def node(self, place: _Place) -> Data:
        """Return a node with or without modifiers."""
        made = self.kind(place)
        while self.chance.random() < 0.3:
            made = self.modified(made, place)
        return made

    def kind(self, place: _Place) -> Data:
        """Return a node of any kind."""
        if place.depth <= 0:
            return self.chance.choice([self.act, self.act, self.given, self.small])()
        kinds = [
            self.in_order,
            self.in_order,
            self.reactive_sequence,
            self.reactive_fallback,
            self.parallel,
            self.turned,
            self.branch,
            self.loop,
            self.switch,
            self.call,
            self.leaf,
        ]
        return self.chance.choice(kinds)(place)

    def leaf(self, place: _Place) -> Data:
        """Return a leaf."""
        return self.kind(_Place(0, place.may_skip, place.in_call))

    def small(self) -> Data:
        """Return a wait or a set."""
        return self.chance.choice(
            [{"wait": self.seconds()}, {"set": {"s": self.chance.choice("xyz")}}]
        )

    def seconds(self) -> float:
        """Return a time that is over at a tick, or between two of them."""
        return self.chance.randint(1, 8) * 0.05

    def nodes(self, place: _Place, least: int = 1) -> list[Data]:
        """Return some nodes."""
        return [self.node(place) for _ in range(self.chance.randint(least, 3))]

    def in_order(self, place: _Place) -> Data:
        """Return a sequence or a fallback."""
        kinds = ["sequence", "sequence", "fallback", "persistent_sequence"]
        kind = self.chance.choice(kinds[:3] if place.in_call else kinds)
        return {kind: self.nodes(place.below())}

    def asking(self, place: _Place) -> Data:
        """Return a node that asks a condition, alone or with others."""
        if self.chance.random() < 0.6:
            return self.given()
        return {self.chance.choice(["sequence", "fallback"]): [self.given(), self.node(place)]}

    def reactive_sequence(self, place: _Place) -> Data:
        """Return a reactive sequence whose earlier children ask something."""
        earlier = [self.asking(place.below()) for _ in range(self.chance.randint(1, 2))]
        return {"reactive_sequence": [*earlier, self.node(place.below())]}

    def reactive_fallback(self, place: _Place) -> Data:
        """Return a reactive fallback whose earlier children answer at once, or succeed."""
        earlier = [
            self.chance.choice(
                [
                    self.given(),
                    self.given(),
                    self.act_at_once(),
                    {"sequence": [self.given(), self.act(ends="s")]},
                    {"not": self.given()},
                ]
            )
            for _ in range(self.chance.randint(1, 2))
        ]
        return {"reactive_fallback": [*earlier, self.node(place.below())]}

    def act_at_once(self) -> Data:
        """Return an action that takes no time."""
        made = self.act()
        made["with"]["ticks"] = 0
        return made

    def parallel(self, place: _Place) -> Data:
        """Return a parallel with any thresholds."""
        children = self.nodes(place.below(may_skip=False), least=2)
        made: Data = {"parallel": children}
        how = self.chance.choice(["all", "succeed", "fail", "wait"])
        number = self.chance.randint(1, len(children))
        if how == "wait":
            made |= {"wait_for_all": True, "fail": number}
        elif how != "all":
            made[how] = number
        return made

    def turned(self, place: _Place) -> Data:
        """Return a `not` or `force_failure`."""
        return {self.chance.choice(["not", "force_failure"]): self.node(place.below())}

    def branch(self, place: _Place) -> Data:
        """Return if/then/else or while/do/else; an `if` without `else` where that may be."""
        kind, body = self.chance.choice([("if", "then"), ("while", "do")])
        made = {kind: self.condition(), body: self.node(place.below())}
        if kind == "while" or not place.may_skip or self.chance.random() < 0.6:
            made["else"] = self.node(place.below())
        return made

    def loop(self, place: _Place) -> Data:
        """Return a loop; one without end has a body that takes time."""
        if self.chance.random() < 0.25:
            return {"loop": "forever", "do": self.act(least=1)}
        body = self.node(place.below(may_skip=False))
        return {"loop": {"max": self.chance.randint(1, 3)}, "do": body}

    def switch(self, place: _Place) -> Data:
        """Return a switch over a key that was set before, and that the cases may set."""
        cases = {case: self.node(place.below()) for case in "xyz"[: self.chance.randint(1, 3)]}
        chosen: Data = {"switch": "{s}", "cases": cases}
        if self.chance.random() < 0.7:
            chosen["else"] = self.node(place.below())
        return {"sequence": [{"set": {"s": self.chance.choice("xyz")}}, chosen]}

    def call(self, place: _Place) -> Data:
        """Return a call of a tree of its own."""
        name = f"tree_{len(self.trees)}"
        self.trees[name] = {}
        self.trees[name] = self.node(place.below(in_call=True))
        return {"call": name}

    def modified(self, node: Data, place: _Place) -> Data:
        """Return a node with a modifier around it."""
        modifiers = ["while", "timeout", "timeout", "retry", "optional", "on_failure"]
        if place.may_skip:
            modifiers += ["if", "once"]
        how = self.chance.choice(modifiers)
        if how in ("retry", "timeout") and place.may_skip:
            node = self.node(_Place(place.depth - 1, False, place.in_call))
        values = {
            "while": self.condition,
            "if": self.condition,
            "timeout": self.seconds,
            "retry": lambda: self.chance.randint(2, 3),
            "on_failure": lambda: self.node(_Place(place.depth - 1, place.may_skip, place.in_call)),
        }
        return {"do": node, how: values[how]() if how in values else True}


def random_scene(seed: int) -> RandomScene:
    """Return the tree of a seed."""
    maker = _Maker(Random(seed))
    main = maker.node(_Place(maker.chance.randint(1, 4)))
    main = (
        {"sequence": [{"set": {"s": "x"}}, main]} if maker.chance.random() < 0.5 else {"do": main}
    )
    halts = maker.chance.sample(range(1, TICKS), maker.chance.choice([0, 0, 1, 2]))
    return RandomScene(main, maker.trees, tuple(sorted(halts)))


def scene_xml(mission: MissionFile) -> str:
    """Return a mission for the player: rounds that took time end their tick, as they do in ours."""
    root = ElementTree.fromstring(to_xml(mission))
    for parent in list(root.iter()):
        if parent.tag in ("Repeat", "RetryUntilSuccessful"):
            body = parent[0]
            parent.remove(body)
            attempts = (
                {"attempts": parent.get("num_attempts")} if parent.get("num_attempts") else {}
            )
            ElementTree.SubElement(parent, "Later", attempts).append(body)  # type: ignore[arg-type]
    model = ElementTree.SubElement(root.find("TreeNodesModel"), "Decorator", ID="Later")  # type: ignore[arg-type]
    ElementTree.SubElement(model, "input_port", name="attempts")
    return ElementTree.tostring(root, encoding="unicode")
