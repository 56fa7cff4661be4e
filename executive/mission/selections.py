"""What a mission selects: its plugins, its machine, and what it can do without."""

from collections.abc import Collection

from executive import registry
from executive.errors import ConfigError, ExecutiveError, RobotError
from executive.interfaces.robot import RobotSettings
from executive.mission.assembly import Assembly, Selections, assemble
from executive.mission.fault import fault_of
from executive.tree.language import MissionFile
from executive.tree.traversal import uses_leaf


def selections_of(description: MissionFile, seen_by: Collection[str]) -> Selections:
    """Leave out the viewer unless something is to be seen.

    Args:
        description: The mission.
        seen_by: The options of the command line that need a viewer.

    Raises:
        ConfigError: If there is one, and the mission selects no viewer.
    """
    if seen_by and "viewing" not in description.plugins:
        cure = "the mission selects no viewer; add --set viewing.plugin=rerun"
        raise ConfigError(f"{' and '.join(seen_by)}: {cure}")
    return {
        name: chosen for name, chosen in description.plugins.items() if name != "viewing" or seen_by
    }


def assembled(selections: Selections, model: str, seed: int) -> Assembly:
    """Make the plugins.

    Raises:
        ConfigError: If a plugin refuses its settings or lacks what it needs.
        RobotError: If the constructor of a plugin raises something else; it names the line.
    """
    try:
        return assemble(selections, model, seed)
    except ExecutiveError:
        raise
    except Exception as error:  # whatever a constructor raises
        fault = fault_of(error, {})
        making = "; ".join(getattr(error, "__notes__", ()))
        raise RobotError(f"{fault.error} {making} ({fault.place})") from error


def can_fail(description: MissionFile) -> frozenset[tuple[str, str]]:
    """Return capability and name of the plugins that the mission can do without."""
    return frozenset(
        (capability, one.name)
        for capability, several in description.plugins.items()
        for one in several
        if one.can_fail
    )


def is_judged(description: MissionFile) -> bool:
    """Return whether something can judge what a mission's robot has done, as a simulator can."""
    return description.plugins["robot"][0].name in registry.names(registry.ORACLES)


def verifies(description: MissionFile) -> bool:
    """Return whether a mission asks where each stone is that it released."""
    return uses_leaf("VerifyPlacement", "main", description.trees)


def model_of(description: MissionFile) -> str:
    """Return the name or folder of the machine of a mission.

    Raises:
        ConfigError: If the settings of its robot name none.
    """
    settings = description.plugins["robot"][0].settings
    if not isinstance(settings, RobotSettings):
        raise ConfigError(
            f"the settings of robot plugin '{description.plugins['robot'][0].name}' name no model"
        )
    return settings.model
