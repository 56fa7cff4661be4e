"""Several plugins of one capability in a mission, told apart by names.

`placing: {rows: {plugin: slots}, wall: {plugin: dry_stone}}` selects the plugins `placing.rows` and
`placing.wall`; `use: rows` at a leaf chooses one. The instance `default` is taken where none is
named.
"""

from collections.abc import Mapping
from typing import TypeAlias

from executive.errors import did_you_mean
from executive.tree.problem import Mark
from executive.tree.reading import Reading
from executive.tree.value import Scalar, Table, Value, describe

USE = "use"
DEFAULT = "default"
# What the loop and the run use themselves, and what sees every observation: one of each.
SINGLE = ("robot", "estimation", "odometry", "mapping", "objects", "monitoring", "viewing")

Instances: TypeAlias = Mapping[str, tuple[str, ...]]  # names of the instances by capability
Uses: TypeAlias = Mapping[str, str]  # the chosen instance by capability


def key_of(capability: str, instance: str) -> str:
    """Return the key under which a mission keeps a plugin: `placing`, or `placing.rows`."""
    return f"{capability}.{instance}" if instance else capability


def capability_of(key: str) -> str:
    """Return the capability of such a key."""
    return key.partition(".")[0]


def chosen_key(capability: str, uses: Uses, known: Mapping[str, object]) -> str | None:
    """Return the key of the plugin that is used, or None if there is none or no way to choose.

    Args:
        capability: The capability.
        uses: What was chosen by name.
        known: The mission's plugins or selections by key.
    """
    if capability in known:
        return capability
    key = key_of(capability, uses.get(capability, DEFAULT))
    return key if key in known else None


def is_named(value: Value) -> bool:
    """Return whether a selection gives its plugins names, each with a mapping with `plugin`."""
    if not isinstance(value, Table) or "plugin" in value.entries:
        return False
    return any(
        isinstance(entry.value, Table) and "plugin" in entry.value.entries
        for entry in value.entries.values()
    )


def instances_of(keys: Mapping[str, object]) -> dict[str, tuple[str, ...]]:
    """Return the names of instances by capability, for the capabilities that have names."""
    found: dict[str, tuple[str, ...]] = {}
    for key in keys:
        capability, _, instance = key.partition(".")
        if instance:
            found[capability] = (*found.get(capability, ()), instance)
    return found


def read_uses(
    reading: Reading, value: Value, owner: str, needed: tuple[str, ...] | None
) -> dict[str, str]:
    """Read `use:`: the name of an instance, or a mapping from capability to name.

    After a mistake some choice is returned all the same, so that no other mistake follows from it.

    Args:
        reading: The mission's instances, and where mistakes are noted.
        value: What was written.
        owner: Who uses them, for messages.
        needed: The capabilities that the owner uses; None for any.
    """
    known = {
        capability: names
        for capability, names in reading.instances.items()
        if needed is None or capability in needed
    }
    if isinstance(value, Table):
        chosen = {c: _named(reading, c, e.key_mark, e.value, known, owner)
                  for c, e in value.entries.items()}  # fmt: skip
        return {**_any_of(known if None in chosen.values() else {}), **_without_none(chosen)}
    if not (isinstance(value, Scalar) and isinstance(value.value, str)):
        reading.fail(value, f"'use' takes a name or {{capability: name}}, not {describe(value)}")
        return _any_of(known)
    found = [capability for capability, names in known.items() if value.value in names]
    if len(found) == 1:
        return {found[0]: value.value}
    if found:
        told = f"'{value.value}' names a plugin of {' and of '.join(found)}: write "
        reading.fail(value, f"{told}'use: {{{found[0]}: {value.value}}}'")
    elif known:
        every = [name for names in known.values() for name in names]
        reading.fail(
            value, f"no plugin '{value.value}' for {owner}{did_you_mean(value.value, every)}"
        )
    else:
        reading.fail(value, f"{owner} uses no capability whose plugins have names in this mission")
    return _any_of(known)


def _any_of(known: Instances) -> dict[str, str]:
    return {capability: names[0] for capability, names in known.items()}


def _without_none(chosen: Mapping[str, str | None]) -> dict[str, str]:
    return {capability: name for capability, name in chosen.items() if name is not None}


def _named(
    reading: Reading, capability: str, mark: Mark, value: Value, known: Instances, owner: str
) -> str | None:
    """Return the name in one entry of a mapping, or None after a mistake was noted."""
    if capability not in known:
        told = f"{owner} uses no {capability} plugin that has a name in this mission"
        reading.problems.error(mark, f"{told}{did_you_mean(capability, known) if known else ''}")
        return None
    name = reading.text(value, f"the {capability} plugin in 'use'")
    if name is None or name in known[capability]:
        return name
    near = did_you_mean(name, known[capability])
    reading.fail(value, f"no {capability} plugin is called '{name}'{near}")
    return None
