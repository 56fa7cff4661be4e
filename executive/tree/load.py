"""A mission by path or name to its checked description; every mistake is reported at once."""

import gc
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace

from executive.errors import did_you_mean
from executive.tree.catalogue import Catalogue, InstalledCatalogue
from executive.tree.claims import ClaimCheck
from executive.tree.dataflow.nodes import Dataflow
from executive.tree.expansion import check_expansion
from executive.tree.fault_reader import SECTIONS, head, read_faults_and_watch
from executive.tree.instance_check import InstanceCheck
from executive.tree.instances import instances_of
from executive.tree.language import MissionFile, Tree
from executive.tree.leaf_use import LeafUse
from executive.tree.loop_settings import LoopSettings
from executive.tree.machine_check import check_machine
from executive.tree.override import Override, PlacedSetting, apply_override, placed_setting
from executive.tree.plugin_reader import PluginReader, layered
from executive.tree.port_names import check_port_types
from executive.tree.problem import Problems
from executive.tree.reading import Reading
from executive.tree.region_reader import read_regions
from executive.tree.settings import check_settings
from executive.tree.sources import Layer, layers, libraries, shipped_folder, shown
from executive.tree.traversal import uses_of
from executive.tree.tree_reader import read_trees
from executive.tree.value import Table, TableEntry, merged

_TREES = "trees"


def load_mission(
    path_or_name: str,
    overrides: Sequence[Override] = (),
    catalogue: Catalogue | None = None,
    *,
    is_for_here: bool = False,
) -> MissionFile:
    """Load a mission: a file, or the name of a shipped one, with settings that override its own.

    Args:
        path_or_name: A path that ends in `.yaml`, or a shipped mission's name.
        overrides: `capability.field=value` or `loop.field=value`, later ones over earlier ones;
            settings and trees (`trees.NAME`) of another file with their places there.
        catalogue: What can be chosen; all that is installed by default.
        is_for_here: Whether it is to run here: the machine's file, and what plugins refuse of this
            machine and of this computer, are checked too.

    Raises:
        MissionFileError: If there is any mistake; it holds all of them, with their places.
    """
    with _without_collection():
        reading = Reading(catalogue or InstalledCatalogue(), Problems())
        return _load(path_or_name, overrides, reading, is_for_here=is_for_here)


@contextmanager
def _without_collection() -> Iterator[None]:
    """Let no garbage be looked for: nearly all that is made while a mission is read stays.

    Each search goes through all objects made so far; it took half the time for 20,000 nodes.
    """
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


def _load(
    path_or_name: str, overrides: Sequence[Override], reading: Reading, *, is_for_here: bool
) -> MissionFile:
    found = layers(path_or_name, reading)
    if not found:
        reading.problems.raise_errors()
    mission = found[-1]
    placed = [one for option in overrides if (one := placed_setting(option, reading))]
    loop_table, plugin_table = _settings(found, placed, reading)
    loop = check_settings(LoopSettings, loop_table, "loop", reading.problems)
    plugins = PluginReader(reading)
    selected = plugins.read(plugin_table)
    regions = read_regions(_regions(found, reading), reading)
    reading = replace(reading, regions=regions, instances=instances_of(selected))
    given = _trees(found, placed, reading)
    trees = read_trees(given, libraries(mission.path, reading), reading)
    trees = check_port_types(trees, reading)
    is_broken = "plugins" in mission.table.entries and not plugin_table.entries  # and reported
    if not is_broken and not reading.problems.is_partial:
        plugins.check_needs(selected, plugin_table, _uses(trees))
    if check_expansion(trees, reading.problems):
        Dataflow(trees, reading).check()
        ClaimCheck(trees, reading.problems).check()
        InstanceCheck(trees, reading.instances, reading.problems).check()
    faults, watch = read_faults_and_watch(found, placed, trees, selected, reading)
    if is_for_here:
        check_machine(plugins.written, reading)
    name, description = _titles(mission, reading)
    if not mission.path.is_relative_to(shipped_folder()):  # a shipped one is not what is mistaken
        reading.problems.tell_of(shown(mission.path))
    reading.problems.raise_errors()
    return MissionFile(
        name=name,
        description=description,
        loop=loop or LoopSettings(),
        plugins=selected,
        trees=trees,
        warnings=reading.problems.warnings(),
        regions=regions,
        faults=faults,
        watch=watch,
    )


def _settings(
    found: Sequence[Layer], placed: Sequence[PlacedSetting], reading: Reading
) -> tuple[Table, Table]:
    mark = found[-1].table.mark
    loop, plugins = Table({}, mark), Table({}, mark)
    for layer in found:
        over_loop, over_plugins = (_section(layer, key, reading) for key in ("loop", "plugins"))
        if over_loop:
            laid = merged(loop, over_loop)
            loop = laid if isinstance(laid, Table) else loop
        if over_plugins:
            plugins = layered(plugins, over_plugins)
    for setting in placed:
        if head(setting) not in (*SECTIONS, _TREES):
            loop, plugins = apply_override(setting, loop, plugins, reading)
    return loop, plugins


def _section(layer: Layer, key: str, reading: Reading) -> Table | None:
    value = layer.table.get(key)
    return None if value is None else reading.table(value, f"'{key}'")


def _regions(found: Sequence[Layer], reading: Reading) -> Table | None:
    """Lay the regions of a mission over those of its base; a region is replaced as a whole."""
    given = [table for layer in found if (table := _section(layer, "regions", reading)) is not None]
    entries = {name: entry for table in given for name, entry in table.entries.items()}
    return Table(entries, given[-1].mark) if given else None


def _trees(
    found: Sequence[Layer], placed: Sequence[PlacedSetting], reading: Reading
) -> Table | None:
    """Lay the trees of a mission over those of its base, and `trees.NAME` of another file over
    both; a tree is replaced as a whole.
    """
    is_given = any("trees" in layer.table.entries for layer in found)
    if not is_given and not reading.problems.is_partial:
        reading.fail(found[-1].table, "'trees' is missing")
    given = [table for layer in found if (table := _section(layer, "trees", reading)) is not None]
    entries: dict[str, TableEntry] = {}
    for table in given:
        entries.update(table.entries)
    for setting in placed:
        section, _, name = setting.key.partition(".")
        if section == _TREES and name in entries:
            entries[name] = TableEntry(setting.mark, setting.value)
        elif section == _TREES:
            near = did_you_mean(name, entries)
            told = f"the mission has no tree '{name}' of its own to replace{near}"
            reading.problems.error(setting.mark, told)
    return Table(entries, given[-1].mark) if given else None


def _titles(mission: Layer, reading: Reading) -> tuple[str, str]:
    name, description = mission.table.get("mission"), mission.table.get("description")
    if name is None:
        reading.fail(mission.table, "'mission' is missing: the mission's name")
    title = reading.name(name, "'mission'") if name is not None else None
    line = reading.text(description, "'description'") if description is not None else None
    return title or "", line or ""


def _uses(trees: Mapping[str, Tree]) -> list[LeafUse]:
    return [use for tree in trees.values() for node in tree.root.walk() for use in uses_of(node)]
