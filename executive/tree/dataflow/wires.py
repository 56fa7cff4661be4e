"""What one node reads and writes: its ports, settings, conditions and texts, against the keys."""

from typing import Annotated, Any

from executive.leaf.store import Store
from executive.tree.dataflow.keys import ANYTHING, UNKNOWN, Keys, Types
from executive.tree.dataflow.writers import Writers
from executive.tree.expressions.checking import Typing
from executive.tree.expressions.evaluation import evaluate
from executive.tree.expressions.functions import shown
from executive.tree.expressions.kinds import Known, known_value, measured
from executive.tree.expressions.presence import asked_for
from executive.tree.expressions.syntax import Key, Number, keys_of
from executive.tree.key_source import Computed, Literally, Ref, Source, Template
from executive.tree.leaf_use import Combined, Condition, KeyHolds, LeafUse
from executive.tree.place import Place
from executive.tree.port_types import fits, names, type_name, type_of
from executive.tree.problem import Mark, Problems
from executive.tree.setting_types import field_type, refusal, setting_name, suits_setting


class Wires:
    """Checks what the nodes of one tree read, in the order of execution."""

    def __init__(self, keys: Keys, writers: Writers, problems: Problems) -> None:
        """Begin with the keys of a tree.

        Args:
            keys: What may be read now; changed by what is written.
            writers: What writes a key anywhere in the tree.
            problems: Takes the mistakes.
        """
        self.keys = keys
        self._writers = writers
        self._problems = problems

    def condition(self, condition: Condition) -> None:
        """Check a condition; what it asks for with `has` may be read from then on."""
        if isinstance(condition, LeafUse):
            point, start = self.keys.point(), self.keys.writes()
            self.use(condition)
            after = self.keys.rewind(point)
            self.keys.spoil(start)
            self.keys.join(after)
        elif isinstance(condition, Combined):
            for part in condition.parts:
                self.condition(part)
        elif isinstance(condition, Computed):
            typing = self._typing(condition.place, "the condition")
            if typing.truth(condition.expression):
                self._narrow(condition)
        else:
            self._truth(condition)

    def _narrow(self, condition: Computed) -> None:
        paths = asked_for(condition.expression, True)
        for key in keys_of(condition.expression) if paths else ():
            if str(key) in paths and key.name not in self.keys:
                self.keys.change(key.name, UNKNOWN)

    def _truth(self, condition: KeyHolds) -> None:
        types = self.types(Ref(condition.key, condition.mark), "the condition")
        if types and not any(fits(one, bool) for one in types):
            told = f"a condition needs true or false, and {{{condition.key}}} holds {names(types)}"
            self._problems.error(condition.mark, told)

    def use(self, use: LeafUse) -> None:
        """Check what a leaf reads, and write its outputs."""
        for port, spec in use.leaf.inputs.items():
            source = use.inputs[port]
            types = self.input(port, source, spec.optional, use.name)
            kind = measured(spec.type, port, spec.doc)
            if types and not any(fits(one, kind) for one in types):
                told = (
                    f"input '{port}' of {use.name} is {type_name(kind)}, and "
                    f"{shown_source(source)} holds {names(types)}"
                )
                self._problems.error(mark_of(source, use.mark), told)
        self._parameters(use)
        for port, ref in use.outputs.items():
            wanted = use.leaf.outputs[port]
            before = self.keys.get(ref.key)
            self.keys.write({ref.key: frozenset({measured(wanted.type, port, wanted.doc)})})
            if wanted.optional and before is not None:
                self.keys.join({ref.key: before})

    def _parameters(self, use: LeafUse) -> None:
        for name, source in (use.parameters.sources if use.parameters else {}).items():
            what = f"setting '{name}' of {use.name}"
            types = self.types(source, what)
            wanted = field_type(use.leaf.Settings.model_fields[name])
            if types and not any(suits_setting(one, wanted) for one in types):
                got = " or ".join(sorted({shown(one) for one in types}))
                told = f"{what} is {setting_name(wanted)}, and {shown_source(source)} is {got}"
                self._problems.error(source.mark, told)
            elif isinstance(source, Ref):
                self._values(use, name, source, types)

    def _values(self, use: LeafUse, name: str, source: Ref, types: Types) -> None:
        """Report a setting whose value is known before the start and out of bounds."""
        known = [known_value(one) for one in types]
        refused = [(one, refusal(use.leaf.Settings, name, one.value)) for one in known if one]
        if refused and len(refused) == len(known) and all(told for _, told in refused):
            one, told = refused[0]
            given = f": {one.given}" if one.given else ""
            self._problems.error(
                source.mark,
                f"setting '{name}' of {use.name}: {told[:1].lower()}{told[1:]}, and key "
                f"'{source.key}' is {one.value!r}{given}",
            )

    def input(self, port: str, source: Source, is_optional: bool, owner: str) -> Types | None:
        """Return the types that an input port is given, or None if an optional one is left out."""
        if is_optional and isinstance(source, Ref) and source.key not in self.keys:
            is_left_out = not source.is_listed or self._writers.has_node(source.key)
            return None if is_left_out else self.types(source, f"input '{port}' of {owner}")
        return self.types(source, f"input '{port}' of {owner}")

    def types(self, source: Source, reader: str) -> Types:
        """Return the types that a source may give; none after a mistake was noted."""
        if isinstance(source, Literally):
            return frozenset({_exactly(type_of(source.value), source.value)})
        if isinstance(source, Computed):
            types = self._typing(source.place, reader).types(source.expression)
            if isinstance(source.expression, Number):
                value = evaluate(source.expression, Store())
                types = frozenset(_exactly(kind, value) for kind in types)
            return types
        if isinstance(source, Template):
            typing = self._typing(source.place, reader)
            for part in source.parts:
                if not isinstance(part, str):
                    typing.types(part)
            return frozenset({str})
        if source.key in self.keys or ANYTHING in self.keys:
            return self.keys.get(source.key, UNKNOWN)
        told = f"{reader} reads key '{source.key}' before it is written"
        self._problems.error(source.mark, told + self._writers.advice(source.key, self.keys))
        return frozenset()

    def _typing(self, place: Place, reader: str) -> Typing:
        """Return what finds the types of an expression with the present keys."""

        def types_of(key: Key, may_miss: bool) -> Types:
            is_absent = key.name not in self.keys and ANYTHING not in self.keys
            if may_miss and is_absent and key.name in self._writers:
                return UNKNOWN
            if not is_absent:
                return self.keys.get(key.name, UNKNOWN)
            return self.types(Ref(key.name, place.at(key.at)), reader)

        def fail(at: int, message: str) -> None:
            self._problems.error(place.at(at), f"{reader}: {message}")

        return Typing(types_of, fail)


def _exactly(kind: Any, value: Any) -> Any:
    """Return a type with its only value; lists are not followed item by item."""
    return Annotated[kind, Known(value)] if isinstance(value, bool | int | float | str) else kind


def shown_source(source: Source) -> str:
    """Say where a value comes from, for a sentence."""
    if isinstance(source, Literally):
        return repr(source.value)
    return f"key '{source.key}'" if isinstance(source, Ref) else f"'{source}'"


def mark_of(source: Source, otherwise: Mark) -> Mark:
    """Return the place of a source, or another place for a literal, which has none."""
    return otherwise if isinstance(source, Literally) else source.mark
