"""A checked mission: its settings, its plugins, its trees; frozen, and free of YAML."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from executive.faults.description import Fault
from executive.messages.region import Region
from executive.tree.loop_settings import LoopSettings
from executive.tree.node_kinds import Node
from executive.tree.problem import Mark, Problem
from executive.tree.selection import Selection
from executive.watch.rules import Watched


@dataclass(frozen=True, slots=True)
class TypeName:
    """The declared type of a tree's port: `Stone`, `list[Stone]`, or `Stone?` if optional."""

    text: str
    mark: Mark

    @property
    def is_optional(self) -> bool:
        return self.text.endswith("?")

    @property
    def name(self) -> str:
        return self.text.removesuffix("?")


@dataclass(frozen=True, slots=True)
class Tree:
    """A named tree; its ports say which values go in and out."""

    name: str
    root: Node
    inputs: Mapping[str, TypeName]
    outputs: Mapping[str, TypeName]
    mark: Mark


@dataclass(frozen=True, slots=True)
class MissionFile:
    """A mission without mistakes.

    Attributes:
        name: What `mission:` says.
        description: One line for people.
        loop: Settings of the tick loop.
        plugins: Selections by capability, in the order in which data flows; only `monitoring` may
            have several. A plugin with a name stands under `capability.name`.
        trees: `main`, and every tree that it calls.
        warnings: What works but was hardly meant.
        regions: Named parts of the ground, by name.
        faults: What is done to the mission on purpose, in the order of the file.
        watch: What is watched while it runs, and what happens then, by condition.
    """

    name: str
    description: str
    loop: LoopSettings
    plugins: Mapping[str, tuple[Selection, ...]]
    trees: Mapping[str, Tree]
    warnings: tuple[Problem, ...] = field(default=())
    regions: Mapping[str, Region] = field(default_factory=dict)
    faults: tuple[Fault, ...] = field(default=())
    watch: Watched = field(default_factory=dict)
