"""A word of the mission language: what it is, what it takes, what it drives, an example."""

from dataclasses import asdict, dataclass
from typing import Any, Literal

WordKind = Literal["node", "modifier", "action", "check"]


@dataclass(frozen=True, slots=True)
class PortWord:
    """An input or output port of a leaf."""

    name: str
    type: str
    optional: bool
    meaning: str


@dataclass(frozen=True, slots=True)
class SettingWord:
    """A setting of a leaf.

    Attributes:
        name: Its key under `with:`.
        type: What it takes; for a quantity its dimension, such as `angle`.
        unit: Unit of a plain number; empty if the setting is no quantity.
        default: Its default as text, or `required`; empty if it may be left out.
        bounds: Its limits; empty for none.
        meaning: One line.
    """

    name: str
    type: str
    unit: str
    default: str
    bounds: str
    meaning: str


@dataclass(frozen=True, slots=True)
class Word:
    """One word, whatever it is.

    Attributes:
        name: As a mission file writes it.
        kind: A node, a modifier, or a leaf: an action or a check.
        summary: What it does, in one paragraph.
        form: How it is written, key by key.
        example: A node as YAML that can be copied.
        keys: Keys beside it, for a node.
        inputs: Input ports of a leaf.
        outputs: Output ports of a leaf.
        settings: Settings of a leaf.
        needs: Capabilities of which the mission must select a plugin.
        claims: Parts of the machine that the leaf drives.
        package: The package that brings it.
    """

    name: str
    kind: WordKind
    summary: str
    form: tuple[str, ...]
    example: str
    keys: tuple[str, ...] = ()
    inputs: tuple[PortWord, ...] = ()
    outputs: tuple[PortWord, ...] = ()
    settings: tuple[SettingWord, ...] = ()
    needs: tuple[str, ...] = ()
    claims: tuple[str, ...] = ()
    package: str = "executive"

    def as_dict(self) -> dict[str, Any]:
        """Return it as plain values, for JSON."""
        return asdict(self)
