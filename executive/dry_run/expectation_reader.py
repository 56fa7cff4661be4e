"""Reads `expect:` of a file of mocks: what the run is to show."""

from collections.abc import Iterator

from executive.dry_run.expectations import Expectations, ExpectedKey, ExpectedNodes
from executive.dry_run.places import Places
from executive.errors import did_you_mean
from executive.tree.key_source import Computed, Ref
from executive.tree.problem import Mark
from executive.tree.reading import Reading
from executive.tree.value import Listing, Table, Value

_EXPECTED = ("outcome", "within", "visited", "not_visited", "ends", "keys", "that")
_OUTCOMES = ("success", "failure")
_ENDS = ("success", "failure", "skipped", "halted")


class ExpectationReader:
    """Reads `expect:` against the tree of a mission."""

    def __init__(self, places: Places, reading: Reading) -> None:
        self._places, self._reading = places, reading

    def expectations(self, value: Value | None) -> Expectations:
        """Return what is expected; nothing if there is no `expect:`."""
        table = self._reading.table(value, "'expect'") if value is not None else None
        if table is None:
            return Expectations()
        self._reading.known_keys(table, _EXPECTED, "'expect'")
        within = table.get("within")
        seconds = self._reading.seconds(within, "'within'") if within is not None else None
        return Expectations(
            self._outcome(table.get("outcome")),
            (seconds, within.mark) if seconds is not None and within is not None else None,
            tuple(self._nodes(table, "visited")),
            tuple(self._nodes(table, "not_visited")),
            tuple(self._ends(table)),
            tuple(self._keys(table)),
            tuple(self._that(table)),
        )

    def _outcome(self, value: Value | None) -> tuple[str, Mark] | None:
        text = self._reading.text(value, "'outcome'") if value is not None else None
        if text is None or value is None:
            return None
        return (self._one_of(value, text, _OUTCOMES), value.mark)

    def _nodes(self, table: Table, key: str) -> Iterator[ExpectedNodes]:
        value = table.get(key)
        listing = self._reading.listing(value, f"'{key}'") if value is not None else None
        for item in listing.items if listing else ():
            name = self._reading.text(item, f"a node of '{key}'")
            paths = self._paths(name, item.mark) if name is not None else ()
            if name is not None and paths:
                yield ExpectedNodes(name, paths, item.mark)

    def _ends(self, table: Table) -> Iterator[ExpectedNodes]:
        value = table.get("ends")
        ends = self._reading.table(value, "'ends'") if value is not None else None
        for name, entry in (ends.entries if ends else {}).items():
            many = entry.value.items if isinstance(entry.value, Listing) else (entry.value,)
            texts = [(one, self._reading.text(one, f"an end of '{name}'")) for one in many]
            found = tuple(self._one_of(one, text, _ENDS) for one, text in texts if text is not None)
            paths = self._paths(name, entry.key_mark)
            if paths:
                yield ExpectedNodes(name, paths, entry.key_mark, found)

    def _keys(self, table: Table) -> Iterator[ExpectedKey]:
        value = table.get("keys")
        keys = self._reading.table(value, "'keys'") if value is not None else None
        for key, entry in (keys.entries if keys else {}).items():
            source = self._reading.source(entry.value, f"'{key}'")
            if source is not None:
                yield ExpectedKey(key, source, entry.key_mark)

    def _that(self, table: Table) -> Iterator[Ref | Computed]:
        value = table.get("that")
        listing = self._reading.listing(value, "'that'") if value is not None else None
        for item in listing.items if listing else ():
            expression = self._reading.expression(item, "an expression of 'that'")
            if expression is not None:
                yield expression

    def _paths(self, name: str, mark: Mark) -> tuple[str, ...]:
        paths = self._places.nodes_called(name)
        if not paths:
            near = did_you_mean(name, self._places.node_names())
            self._reading.problems.error(mark, f"the mission has no node '{name}'{near}")
        return paths

    def _one_of(self, value: Value, text: str, allowed: tuple[str, ...]) -> str:
        if text not in allowed:
            self._reading.fail(value, f"no node ends so: '{text}'{did_you_mean(text, allowed)}")
        return text
