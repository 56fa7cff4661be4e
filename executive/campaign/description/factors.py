"""Reads what a campaign varies: factors with their levels, or a list of variants."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from executive.tree.override import PlacedSetting
from executive.tree.problem import Mark
from executive.tree.reading import Reading
from executive.tree.value import (
    Broken,
    Listing,
    Scalar,
    Table,
    TableEntry,
    Value,
    describe,
    without,
)

MISSION = "mission"  # a level's own mission; also the factor of a campaign of several missions
VARIANT = "variant"


@dataclass(frozen=True, slots=True)
class Level:
    """One level of a factor.

    Attributes:
        name: Its name in tables and charts.
        settings: What it sets.
        mission: The mission that its runs are of, if it chooses one.
    """

    name: str
    settings: tuple[PlacedSetting, ...] = ()
    mission: Value | None = None


@dataclass(frozen=True, slots=True)
class Factor:
    """What is varied, with its levels in the order of the file."""

    name: str
    mark: Mark
    levels: tuple[Level, ...]


def read_settings(table: Table, reading: Reading) -> tuple[PlacedSetting, ...]:
    """Return the settings of a table whose keys are `capability.field`."""
    found = []
    for key, entry in table.entries.items():
        if all(key.split(".")):
            found.append(PlacedSetting(key, entry.value, entry.key_mark))
        else:
            reading.problems.error(
                entry.key_mark, f"a setting is capability.field, such as loop.tick, not '{key}'"
            )
    return tuple(found)


def read_missions(value: Value, reading: Reading) -> Factor | None:
    """Return the missions of a campaign as a factor; one mission alone is a factor of one level."""
    missions = Listing((value,), value.mark) if isinstance(value, Scalar) else value
    listing = reading.listing(missions, "'missions'")
    if listing is None:
        return None
    levels = []
    for item in listing.items:
        text = reading.text(item, "a mission")
        if text is not None:
            name = text.rpartition("/")[2].removesuffix(".yaml").removesuffix(".yml")
            levels.append((Level(name, mission=item), item.mark))
    return Factor(MISSION, listing.mark, _unlike(levels, reading))


def read_factors(table: Table, reading: Reading) -> list[Factor]:
    """Return the factors of `factors:`.

    A mapping of level names to settings is a named factor; under a setting's key, a list of its
    values is a factor whose levels have the values as names.
    """
    found = []
    for name, entry in table.entries.items():
        if isinstance(entry.value, Listing):
            found.append(_of_values(name, entry, reading))
        else:
            found.append(_of_levels(name, entry, reading))
    return [factor for factor in found if factor is not None]


def read_variants(table: Table, reading: Reading) -> list[Factor]:
    """Return the variants of `variants:` as one factor."""
    factor = _of_levels(VARIANT, TableEntry(table.mark, table), reading)
    return [factor] if factor else []


def level_name(value: Value) -> str | None:
    """Return the name of the level of a plain value; None if the value is a list or mapping."""
    if not isinstance(value, Scalar) or value.value is None:
        return None
    is_word = isinstance(value.value, bool)
    return str(value.value).lower() if is_word else str(value.value)


def _of_values(name: str, entry: TableEntry, reading: Reading) -> Factor | None:
    listing = reading.listing(entry.value, f"factor '{name}'")
    if listing is None:
        return None
    if not all(name.split(".")) or "." not in name:
        told = (
            f"a list of values belongs to a setting, such as {name or 'loop'}.plugin; "
            "a factor of another name maps its levels to settings: {one: {}, other: {…}}"
        )
        reading.problems.error(entry.key_mark, told)
        return None
    levels = []
    for item in listing.items:
        called = level_name(item)
        if called is not None:
            setting = PlacedSetting(name, item, entry.key_mark)
            levels.append((Level(called, (setting,)), item.mark))
        elif not isinstance(item, Broken):
            told = "name the levels, {one: {…}, other: {…}}, where a value is"
            reading.fail(item, f"{told} {describe(item)}")
    return Factor(name, entry.key_mark, _unlike(levels, reading))


def _of_levels(name: str, entry: TableEntry, reading: Reading) -> Factor | None:
    table = reading.table(entry.value, f"a factor such as '{name}'")
    if table is None:
        return None
    if not table.entries:
        reading.fail(table, f"factor '{name}' needs at least one level")
        return None
    levels = []
    for called, level in table.entries.items():
        is_empty = isinstance(level.value, Scalar) and level.value.value is None
        settings = (
            Table({}, level.key_mark)
            if is_empty
            else reading.table(level.value, f"level '{called}', its settings,")
        )
        if settings is not None:
            own = read_settings(without(settings, [MISSION]), reading)
            levels.append(Level(called, own, settings.get(MISSION)))
    return Factor(name, entry.key_mark, tuple(levels))


def _unlike(levels: Sequence[tuple[Level, Mark]], reading: Reading) -> tuple[Level, ...]:
    """Return the levels; note each whose name another one has."""
    known: dict[str, Level] = {}
    for level, mark in levels:
        if level.name in known:
            reading.problems.error(mark, f"two levels are called '{level.name}'")
        known.setdefault(level.name, level)
    return tuple(known.values())


def refuse_conflicts(factors: Sequence[Factor], reading: Reading) -> None:
    """Note settings that two factors set: which of them holds would be a matter of order."""
    seen: dict[str, str] = {}
    for factor in factors:
        for key, mark in _keys(factor):
            other = next((f for k, f in seen.items() if f != factor.name and _meet(k, key)), None)
            if other is not None:
                reading.problems.error(mark, f"'{key}' is set by the factor '{other}' already")
        seen.update({key: factor.name for key, _ in _keys(factor)})


def _keys(factor: Factor) -> Iterator[tuple[str, Mark]]:
    for level in factor.levels:
        yield from ((setting.key, setting.mark) for setting in level.settings)
        if level.mission is not None:
            yield MISSION, level.mission.mark


def _meet(one: str, other: str) -> bool:
    return f"{one}.".startswith(f"{other}.") or f"{other}.".startswith(f"{one}.")
