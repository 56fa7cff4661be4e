"""Reads `faults:` and `watch:` of a mission: what is done to it on purpose, and what it watches."""

from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import lru_cache

from executive.errors import ConfigError, did_you_mean
from executive.faults.description import KINDS, Fault, PluginFault
from executive.machine.machine import FILE, Machine, load_machine, machine_folder
from executive.tree.language import Tree
from executive.tree.override import PlacedSetting
from executive.tree.reading import Reading
from executive.tree.selection import Selection
from executive.tree.settings import check_settings
from executive.tree.sources import Layer
from executive.tree.value import Scalar, Table, TableEntry, Value, merged
from executive.watch.rules import Watched, conditions_of

FAULTS, WATCH = "faults", "watch"
_ROOT = "main"  # the tree of a mission, and the path of its root, whatever that is called
SECTIONS = (FAULTS, WATCH)


class FaultReader:
    """Reads both sections against the machine, the trees and the plugins of a mission."""

    def __init__(
        self,
        machine: Machine,
        trees: Mapping[str, Tree],
        plugins: Mapping[str, Sequence[Selection]],
        reading: Reading,
    ) -> None:
        self._machine, self._plugins, self._reading = machine, plugins, reading
        labels = Counter(node.label for tree in trees.values() for node in tree.root.walk())
        root = trees[_ROOT].root.label if _ROOT in trees else ""
        self._root = root if labels[root] == 1 else _ROOT
        self._nodes = sorted({*labels, _ROOT})

    def faults(self, value: Value | None) -> tuple[Fault, ...]:
        """Return the faults of `faults:`, in the order of the file."""
        if value is None:
            return ()
        if isinstance(value, Scalar) and value.value is None:
            return ()
        listing = self._reading.listing(value, "'faults'")
        found = [self._fault(item) for item in listing.items] if listing else []
        return tuple(fault for fault in found if fault is not None)

    def watch(self, value: Value | None) -> Watched:
        """Return the rules of `watch:` by condition."""
        table = self._reading.table(value, "'watch'") if value is not None else None
        known = conditions_of(self._machine)
        found = {}
        for condition, entry in (table.entries if table else {}).items():
            if condition not in known:
                near = did_you_mean(condition, known)
                told = f"'watch' has no condition '{condition}'{near}"
                self._reading.problems.error(entry.key_mark, told)
                continue
            settings = self._reading.table(_written_out(entry.value), f"the rule of '{condition}'")
            if settings is not None:
                owner = f"the rule of '{condition}'"
                rule = check_settings(known[condition], settings, owner, self._reading.problems)
                if rule is not None:
                    found[condition] = rule
        return found

    def _fault(self, value: Value) -> Fault | None:
        table = self._reading.table(value, "a fault")
        if table is None:
            return None
        kinds = [kind for kind in KINDS if kind in table.entries]
        if len(kinds) != 1:
            told = f"a fault is of one of {', '.join(KINDS)}; got {' and '.join(kinds) or 'none'}"
            self._reading.fail(table, told)
            return None
        owner = f"a fault of a {kinds[0]}"
        fault = check_settings(KINDS[kinds[0]], table, owner, self._reading.problems)
        if fault is None:
            return None
        refusals = (
            [self._plugin_refusal(fault)]
            if isinstance(fault, PluginFault)
            else [fault.refusal(self._machine)]
        )
        refusals.append(self._node_refusal(fault.node))
        for field, told in (one for one in refusals if one is not None):
            self._reading.fail(table.get(field) or table, told)
        if fault.node == self._root:
            fault = fault.model_copy(update={"node": _ROOT})
        return fault if refusals == [None, None] else None

    def _node_refusal(self, node: str | None) -> tuple[str, str] | None:
        if node is None or node in self._nodes:
            return None
        return "node", f"no node is called '{node}'{did_you_mean(node, self._nodes)}"

    def _plugin_refusal(self, fault: PluginFault) -> tuple[str, str] | None:
        chosen = self._plugins.get(fault.plugin, ())
        if not chosen:
            near = did_you_mean(fault.plugin, self._plugins)
            return "plugin", f"the mission selects no {fault.plugin} plugin{near}"
        verbs = {v for one in chosen for v in self._verbs(fault.plugin, one.name)}
        if fault.verb in verbs:
            return None
        near = did_you_mean(fault.verb, sorted(verbs))
        return "verb", f"no verb '{fault.verb}' of {fault.plugin}{near}"

    def _verbs(self, capability: str, name: str) -> Collection[str]:
        try:
            plugin = self._reading.catalogue.plugin(capability, name)
        except ConfigError:
            return ()
        return [v for v in dir(plugin) if not v.startswith("_") and callable(getattr(plugin, v))]


def section(
    key: str, found: Sequence[Layer], settings: Iterable[PlacedSetting], reading: Reading
) -> Value | None:
    """Return a section of the newest file that has it, with what options lay over it.

    Rules of `watch:` are laid over those of the base, one by one; `faults:` replaces the base's.
    """
    value: Value | None = None
    for layer in found:
        own = layer.table.get(key)
        if own is not None:
            is_laid = key == WATCH and isinstance(value, Table) and isinstance(own, Table)
            value = merged(_all(value), _all(own)) if is_laid and value is not None else own
    for setting in settings:
        value = _with(value, setting, key, reading)
    return value


def _all(watch: Value) -> Value:
    """Write all rules out, so that those of two files merge."""
    if not isinstance(watch, Table):
        return watch
    return Table(
        {k: TableEntry(e.key_mark, _written_out(e.value)) for k, e in watch.entries.items()},
        watch.mark,
    )


def _written_out(value: Value) -> Value:
    """Write the short form out: `stop` is `{do: stop}`."""
    if isinstance(value, Scalar) and isinstance(value.value, str):
        return Table({"do": TableEntry(value.mark, value)}, value.mark)
    return value


def _with(value: Value | None, setting: PlacedSetting, key: str, reading: Reading) -> Value | None:
    steps = setting.key.split(".")[1:]
    if not steps:
        return setting.value
    if key == FAULTS:
        told = "faults are set as a whole: faults=[{sensor: gnss, how: silent, at: 30 s}]"
        reading.problems.error(setting.mark, told)
        return value
    new: Value = setting.value
    for step in reversed(steps):
        new = Table({step: TableEntry(setting.mark, new)}, setting.mark)
    base = _all(value) if value is not None else Table({}, setting.mark)
    return merged(base, _all(new))


def selected_machine(robot: Sequence[Selection]) -> Machine | None:
    """Return the machine that a robot's settings name; None where there is none."""
    model = getattr(robot[0].settings, "model", None) if robot else None
    try:
        file = machine_folder(model) / FILE if model else None
        return _machine(model, file.stat().st_mtime_ns) if model and file else None
    except (ConfigError, OSError):
        return None  # told when the run is assembled


@lru_cache(maxsize=4)
def _machine(model: str, changed_ns: int) -> Machine:
    """Return a machine; its file is read again when it has changed."""
    return load_machine(model)


def read_faults_and_watch(
    found: Sequence[Layer],
    placed: Sequence[PlacedSetting],
    trees: Mapping[str, Tree],
    selected: Mapping[str, Sequence[Selection]],
    reading: Reading,
) -> tuple[tuple[Fault, ...], Watched]:
    """Read `faults:` and `watch:`, which name sensors of the machine; without one, neither."""
    values = {
        key: section(key, found, [one for one in placed if head(one) == key], reading)
        for key in SECTIONS
    }
    machine = selected_machine(selected.get("robot", ()))
    if machine is None or not any(values.values()):
        return (), {}
    reader = FaultReader(machine, trees, selected, reading)
    return reader.faults(values[FAULTS]), reader.watch(values[WATCH])


def head(setting: PlacedSetting) -> str:
    """Return what a setting is of: `loop`, a capability, or one of `SECTIONS`."""
    return setting.key.partition(".")[0]
