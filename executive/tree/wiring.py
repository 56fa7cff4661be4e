"""Between a leaf's ports and the store: inputs fetched, outputs checked and written."""

from collections.abc import Mapping
from copy import deepcopy
from typing import Any

from executive.config import Settings
from executive.errors import ConfigError, did_you_mean
from executive.leaf.outcome import Outcome
from executive.leaf.port import written_by
from executive.leaf.store import Store
from executive.tree.expressions.evaluation import evaluate
from executive.tree.expressions.template import filled
from executive.tree.key_source import Computed, Ref, Source, Template
from executive.tree.leaf_use import LeafUse
from executive.tree.port_types import holds, type_name
from executive.tree.settings import computed_settings


def title_of(title: Template, scope: "Scope") -> str:
    """Return a node's name with its keys filled in, or as it is written if one is missing."""
    try:
        return filled(title.parts, scope.store)
    except ConfigError:
        return str(title)


class Scope:
    """The store that the nodes of one tree share; a subtree's is emptied at each call."""

    def __init__(self, store: Store, uses: Mapping[str, str] | None = None) -> None:
        """Keep a store, and which plugins with names the calls above have chosen."""
        self.store = store
        self.uses = uses or {}

    def value(self, source: Source) -> Any:
        """Return the value of a reference or literal.

        Raises:
            ConfigError: If the key was never written.
        """
        match source:
            case Ref(key=key):
                return self.store.get(key)
            case Computed(expression=expression):
                return evaluate(expression, self.store)
            case Template(parts=parts):
                return filled(parts, self.store)
        return deepcopy(source.value)

    def inputs(self, use: LeafUse) -> dict[str, Any]:
        """Return a leaf's inputs by port; an optional one that was never written is None.

        Raises:
            ConfigError: If another key was never written.
        """
        values: dict[str, Any] = {}
        for port, spec in use.leaf.inputs.items():
            source = use.inputs[port]
            is_missing = spec.optional and isinstance(source, Ref) and source.key not in self.store
            values[port] = None if is_missing else self.value(source)
            if isinstance(source, Computed) and not holds(values[port], spec.type):
                raise ConfigError(
                    f"input '{port}' of {use.name} is {type_name(spec.type)}, and {source} gives "
                    f"{type(values[port]).__name__} ({source.mark})"
                )
        return values

    def settings(self, use: LeafUse) -> Settings:
        """Return a leaf's settings, with those that are computed when it starts.

        Raises:
            ConfigError: If a key was never written, or the settings class refuses a value.
        """
        if use.parameters is None:
            return use.settings
        sources = use.parameters.sources
        values = {name: self.value(source) for name, source in sources.items()}
        places = {name: source.mark for name, source in sources.items()}
        return computed_settings(
            use.leaf.Settings, {**use.parameters.literals, **values}, use.name, places
        )

    def write(self, use: LeafUse, outcome: Outcome[Any]) -> None:
        """Write a leaf's outputs.

        Raises:
            ConfigError: If it has no such output, a value has another type, or a success lacks an
                output.
        """
        if outcome.outputs is None and not use.leaf.outputs:
            return
        written = written_by(outcome)
        for port, value in written.items():
            if port not in use.leaf.outputs:
                raise ConfigError(
                    f"{use.name} declares no output '{port}'{did_you_mean(port, use.leaf.outputs)}"
                )
            wanted = use.leaf.outputs[port].type
            if not holds(value, wanted):
                raise ConfigError(
                    f"output '{port}' of {use.name} is {type_name(wanted)}, got "
                    f"{type(value).__name__}"
                )
        missing = [
            p for p, spec in use.leaf.outputs.items() if not spec.optional and p not in written
        ]
        if outcome.success and missing:
            raise ConfigError(f"{use.name} succeeded without its output '{missing[0]}'")
        for port, value in written.items():
            self.store.set(use.outputs[port].key, value)
