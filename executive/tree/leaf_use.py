"""A leaf with its settings and its wiring, and the conditions that are made of leaves and keys."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from executive.config import Settings
from executive.leaf.action import Leaf
from executive.tree.key_source import Computed, KeySource, Ref, Source
from executive.tree.problem import Mark


@dataclass(frozen=True, slots=True)
class Parameters:
    """Settings of a leaf that are computed when it starts.

    Attributes:
        literals: The settings that the file writes out, by name.
        sources: Where the others come from, by name.
    """

    literals: Mapping[str, Any]
    sources: Mapping[str, KeySource]


@dataclass(frozen=True, slots=True)
class LeafUse:
    """A leaf with its settings and its wiring; every port that is connected is listed.

    Attributes:
        name: Name of the behaviour, as installed.
        leaf: Its class.
        settings: Checked settings; of those that are computed at the start, the defaults.
        inputs: Where the value of each input port comes from.
        outputs: Key of the store by output port.
        mark: Where it stands.
        parameters: The settings, if some of them are computed.
        uses: Name of the plugin that it uses, by capability, where there are several.
    """

    name: str
    leaf: type[Leaf[Any]]
    settings: Settings
    inputs: Mapping[str, Source]
    outputs: Mapping[str, Ref]
    mark: Mark
    parameters: Parameters | None = None
    uses: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class KeyHolds:
    """A condition: a key of the store holds true."""

    key: str
    mark: Mark


@dataclass(frozen=True, slots=True)
class Combined:
    """A condition made of others: `not` (of one), `all` or `any`."""

    how: Literal["not", "all", "any"]
    parts: tuple["Condition", ...]


Condition = LeafUse | KeyHolds | Computed | Combined
