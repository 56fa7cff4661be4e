"""`--set capability.field.sub=value`: the last layer of settings, checked as in a file."""

from dataclasses import dataclass

from executive.errors import did_you_mean
from executive.tree.document import read_text
from executive.tree.instances import is_named
from executive.tree.plugin_reader import normal
from executive.tree.problem import Mark, Problems, one_line
from executive.tree.reading import Reading
from executive.tree.value import Listing, Scalar, Table, TableEntry, Value, merged

LOOP = "loop"


@dataclass(frozen=True, slots=True)
class PlacedSetting:
    """A setting that another file lays over a mission; mistakes are reported at its place there.

    Attributes:
        key: `capability.field`.
        value: Its value.
        mark: Place of the key.
    """

    key: str
    value: Value
    mark: Mark


Override = str | PlacedSetting


def placed_setting(option: Override, reading: Reading) -> PlacedSetting | None:
    """Return an option or a setting of another file, or None after a mistake was noted."""
    return option if isinstance(option, PlacedSetting) else parsed_option(option, reading)


def apply_override(
    option: Override, loop: Table, plugins: Table, reading: Reading
) -> tuple[Table, Table]:
    """Apply one setting to those of the loop and of the plugins; errors name the option."""
    setting = placed_setting(option, reading)
    if setting is None:
        return loop, plugins
    path, value, mark = setting.key.split("."), setting.value, setting.mark
    if path[0] == LOOP:
        return _laid(loop, path[1:], value, mark, reading), plugins
    if path[0] not in reading.catalogue.capabilities():
        near = did_you_mean(path[0], (LOOP, *reading.catalogue.capabilities()))
        reading.problems.error(mark, f"no '{path[0]}' to set{near}")
        return loop, plugins
    return loop, _in_plugins(plugins, path, value, mark, reading)


def parsed_option(option: str, reading: Reading) -> PlacedSetting | None:
    """Return what `--set capability.field=value` says, or None after a mistake was noted."""
    mark = Mark(one_line(f"--set {option}"))
    key, equals, text = option.partition("=")
    if not equals or not all(key.strip().split(".")):
        reading.problems.error(mark, "expected capability.field=value")
        return None
    value = option_value(text, mark, reading)
    return None if value is None else PlacedSetting(key.strip(), value, mark)


def option_value(text: str, mark: Mark, reading: Reading) -> Value | None:
    """Return the value that an option's text holds, or None after a mistake was noted."""
    found = Problems()
    value = read_text(text, mark.file, found) if text.strip(" ") else Scalar(None, mark)
    for problem in found.all():
        reading.problems.error(mark, problem.message)
    return None if value is None or found.all() else _moved(value, mark)


def _moved(value: Value, mark: Mark) -> Value:
    """Return the value with the option as the place of every part."""
    if isinstance(value, Table):
        return Table(
            {k: TableEntry(mark, _moved(e.value, mark)) for k, e in value.entries.items()}, mark
        )
    if isinstance(value, Listing):
        return Listing(tuple(_moved(item, mark) for item in value.items), mark)
    return Scalar(value.value, mark) if isinstance(value, Scalar) else value


def _in_plugins(
    plugins: Table, path: list[str], value: Value, mark: Mark, reading: Reading
) -> Table:
    capability, rest = path[0], path[1:]
    entry = plugins.entries.get(capability)
    known = normal(entry.value) if entry else None
    if not rest:
        new: Value = normal(value)
    elif isinstance(known, Listing):
        new = _in_list(known, rest, value, mark, reading)
    elif isinstance(known, Table) and is_named(known):
        new = _in_named(capability, known, rest, value, mark, reading)
    elif rest == ["plugin"] and isinstance(known, Table) and _differs(known, value):
        new = Table({"plugin": TableEntry(mark, value)}, mark)
    elif known is not None:
        new = _laid(known, rest, value, mark, reading)
    elif rest == ["plugin"]:
        new = Table({"plugin": TableEntry(mark, value)}, mark)
    else:
        reading.problems.error(
            mark, f"the mission selects no {capability} plugin; set {capability}.plugin first"
        )
        return plugins
    key_mark = entry.key_mark if entry else mark
    return Table({**plugins.entries, capability: TableEntry(key_mark, new)}, plugins.mark)


def _in_named(
    capability: str, known: Table, path: list[str], value: Value, mark: Mark, reading: Reading
) -> Value:
    """Lay a value over the plugin that the path's first step names."""
    entry = known.entries.get(path[0])
    if entry is None:
        near = did_you_mean(path[0], known.entries)
        told = f"the {capability} plugins have names: write {capability}.NAME.field, no '{path[0]}'"
        reading.problems.error(mark, f"{told}{near}")
        return known
    base = normal(entry.value)
    if path[1:] == ["plugin"] and isinstance(base, Table) and _differs(base, value):
        new: Value = Table({"plugin": TableEntry(mark, value)}, mark)
    elif path[1:]:
        new = _laid(base, path[1:], value, mark, reading)
    else:
        new = normal(value)
    return Table({**known.entries, path[0]: TableEntry(entry.key_mark, new)}, known.mark)


def _differs(known: Table, value: Value) -> bool:
    chosen = known.get("plugin")
    return not (
        isinstance(chosen, Scalar) and isinstance(value, Scalar) and chosen.value == value.value
    )


def _in_list(known: Listing, path: list[str], value: Value, mark: Mark, reading: Reading) -> Value:
    """Lay a value over the item whose plugin has the path's first name."""
    items = {str(_plugin_of(item)): item for item in known.items}
    if path[0] not in items or len(path) < 2:
        near = did_you_mean(path[0], items)
        reading.problems.error(
            mark, f"several plugins are selected: name one of them and a field{near}"
        )
        return known
    items[path[0]] = _laid(items[path[0]], path[1:], value, mark, reading)
    return Listing(tuple(items.values()), known.mark)


def _plugin_of(item: Value) -> object:
    chosen = item.get("plugin") if isinstance(item, Table) else None
    return chosen.value if isinstance(chosen, Scalar) else None


def _laid(base: Value, path: list[str], value: Value, mark: Mark, reading: Reading) -> Table:
    if not isinstance(base, Table):
        base = Table({}, mark)
    if not path:
        if not isinstance(value, Table):
            reading.problems.error(mark, f"expected {LOOP}.field=value")
            return base
        new: Value = value
    else:
        new = value
        for step in reversed(path):
            new = Table({step: TableEntry(mark, new)}, mark)
    laid = merged(base, new)
    return Table(laid.entries, base.mark) if isinstance(laid, Table) else base
