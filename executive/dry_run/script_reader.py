"""Reads `mocks:` of a file of mocks: the outcomes of leaves and questions, in order."""

from collections.abc import Mapping, Sequence

from executive.dry_run.given_value import read_given
from executive.dry_run.made_up import Recipe
from executive.dry_run.places import Places
from executive.dry_run.script import MockedOutcome, MockedStatus, Script
from executive.errors import did_you_mean
from executive.leaf.action import Condition
from executive.tree.reading import Reading, is_text
from executive.tree.value import Listing, Table, TableEntry, Value

_OUTCOME_KEYS = ("status", "after", "reason", "final", "outputs", "answer")
_STATUSES = tuple(status.value for status in MockedStatus)


class ScriptReader:
    """Reads `mocks:`."""

    def __init__(self, places: Places, reading: Reading) -> None:
        self._places, self._reading = places, reading

    def script(self, value: Value | None) -> Script:
        """Return the outcomes by path."""
        table = self._reading.table(value, "'mocks'") if value is not None else None
        entries = table.entries.items() if table else ()
        found: dict[str, tuple[str, tuple[MockedOutcome, ...]]] = {}
        # Entries that mean fewer places stand over those that mean more.
        meant = [(name, entry, self._places.mocked_by(name)) for name, entry in entries]
        for name, entry, paths in sorted(meant, key=lambda one: -len(one[2])):
            if not paths:
                self._unknown(name, entry)
            elif (outcomes := self._outcomes(name, entry.value, paths)) is not None:
                found.update(dict.fromkeys(paths, (name, outcomes)))
        return Script(found)

    def _unknown(self, name: str, entry: TableEntry) -> None:
        near = did_you_mean(name, self._places.mockable_names())
        told = f"the mission has no leaf and no question '{name}'{near}"
        self._reading.problems.error(entry.key_mark, told)

    def _outcomes(
        self, name: str, value: Value, paths: tuple[str, ...]
    ) -> tuple[MockedOutcome, ...] | None:
        kinds = {self._places.leaves[path].kind for path in paths if path in self._places.leaves}
        if len(kinds) > 1 or (kinds and any(path in self._places.questions for path in paths)):
            told = f"'{name}' means leaves of several kinds: {', '.join(paths)}; give whole paths"
            self._reading.fail(value, told)
            return None
        items = value.items if isinstance(value, Listing) else (value,)
        if not items:
            self._reading.fail(value, f"'{name}' takes a list of at least one outcome")
        found = [self._outcome(name, item, paths[0], index) for index, item in enumerate(items)]
        outcomes = tuple(one for one in found if one is not None)
        return outcomes if outcomes and len(outcomes) == len(items) else None

    def _outcome(self, name: str, value: Value, path: str, index: int) -> MockedOutcome | None:
        if is_text(value):
            return self._short(value, path)
        table = self._reading.table(value, f"an outcome of '{name}'")
        if table is None:
            return None
        self._reading.known_keys(table, _OUTCOME_KEYS, f"an outcome of '{name}'")
        given = table.get("status")
        status = MockedStatus.SUCCESS if given is None else self._status(given, path)
        after, reason, final = (table.get(key) for key in ("after", "reason", "final"))
        if after is not None:
            self._check_after(after, name, path, index)
        return MockedOutcome(
            status or MockedStatus.SUCCESS,
            self._reading.seconds(after, "'after'", allow_zero=True) if after else None,
            (self._reading.text(reason, "'reason'") or "") if reason else "",
            bool(self._reading.truth(final, "'final'")) if final else False,
            self._outputs(table, name, path),
            self._choice(table, path, status),
        )

    def _short(self, value: Value, path: str) -> MockedOutcome | None:
        """Return the outcome that is only a status, or only a choice."""
        text, choices = self._reading.text(value, "an outcome"), self._places.questions.get(path)
        if choices and text is not None and text != MockedStatus.FAILURE:
            answer = self._chosen(value, text, choices)
            return MockedOutcome(answer=answer) if answer else None
        status = self._status(value, path)
        return None if status is None else MockedOutcome(status)

    def _status(self, value: Value, path: str) -> MockedStatus | None:
        text = self._reading.text(value, "a status")
        place = self._places.leaves.get(path)
        is_action = place is not None and not issubclass(place.kind, Condition)
        allowed = _STATUSES if is_action else _STATUSES[:2]
        if text is None or text in allowed:
            return None if text is None else MockedStatus(text)
        why = "" if text not in _STATUSES else ": a condition and a question answer at once"
        told = f"no status '{text}' here{did_you_mean(text, allowed)}{why}"
        self._reading.fail(value, told)
        return None

    def _check_after(self, value: Value, name: str, path: str, index: int) -> None:
        place = self._places.leaves.get(path)
        if place is None:
            told = "no mission time passes while a person is asked; leave 'after' out"
            self._reading.fail(value, f"'{name}': {told}")
        elif issubclass(place.kind, Condition) and index == 0:
            told = "the first answer of a condition holds at once; leave its 'after' out"
            self._reading.fail(value, f"'{name}': {told}")

    def _outputs(self, table: Table, name: str, path: str) -> Mapping[str, Recipe]:
        value = table.get("outputs")
        outputs = self._reading.table(value, "'outputs'") if value is not None else None
        place = self._places.leaves.get(path)
        ports = place.kind.outputs if place else {}
        found = {}
        for port, entry in (outputs.entries if outputs else {}).items():
            if port not in ports:
                near = did_you_mean(port, ports)
                self._reading.problems.error(entry.key_mark, f"{name} has no output '{port}'{near}")
                continue
            recipe = read_given(entry.value, ports[port].type, port, self._reading)
            if recipe is not None:
                found[port] = recipe
        return found

    def _choice(self, table: Table, path: str, status: MockedStatus | None) -> str:
        value, choices = table.get("answer"), self._places.questions.get(path, ())
        if value is None:
            if choices and status is MockedStatus.SUCCESS:
                told = f"a question with choices takes 'answer': {', '.join(choices)}"
                self._reading.fail(table, told)
            return ""
        text = self._reading.text(value, "'answer'")
        return self._chosen(value, text, choices) if text is not None else ""

    def _chosen(self, value: Value, text: str, choices: Sequence[str]) -> str:
        """Return one of the choices; empty after a mistake was noted."""
        if text in choices:
            return text
        told = f"no choice '{text}'{did_you_mean(text, choices)}"
        self._reading.fail(
            value, told if choices else "only a question with choices takes an answer"
        )
        return ""
