"""Between a leaf's ports and the store: inputs fetched, outputs checked and written."""

from copy import deepcopy
from typing import Any

from executive.errors import ConfigError, did_you_mean
from executive.leaf.outcome import Outcome
from executive.leaf.port import written_by
from executive.leaf.store import Store
from executive.tree.language import LeafUse, Ref, Source
from executive.tree.port_types import holds, type_name


class Scope:
    """The store that the nodes of one tree share; a subtree's is emptied at each call."""

    def __init__(self, store: Store) -> None:
        self.store = store

    def value(self, source: Source) -> Any:
        """Return the value of a reference or literal.

        Raises:
            ConfigError: If the key was never written.
        """
        return self.store.get(source.key) if isinstance(source, Ref) else deepcopy(source.value)

    def inputs(self, use: LeafUse) -> dict[str, Any]:
        """Return a leaf's inputs by port; an optional one that was never written is None.

        Raises:
            ConfigError: If another key was never written.
        """
        values: dict[str, Any] = {}
        for port, spec in use.leaf.inputs.items():
            ref = use.inputs[port]
            is_missing = spec.optional and ref.key not in self.store
            values[port] = None if is_missing else self.store.get(ref.key)
        return values

    def write(self, use: LeafUse, outcome: Outcome[Any]) -> None:
        """Write a leaf's outputs.

        Raises:
            ConfigError: If it has no such output, a value has another type, or a success lacks an
                output.
        """
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
