"""Where a run keeps its stones, and what plugin wrote them."""

from pathlib import Path

from executive.errors import ConfigError
from executive.mission.run_folder import RunFolder
from executive.plain_yaml import read_plain_yaml
from executive.tree.choices import Choices


def database_of(run_dir: Path) -> Path:
    """Return the path of a run's object database.

    Raises:
        ConfigError: If the folder is none, or holds no database.
    """
    path = RunFolder(run_dir).objects
    if not run_dir.is_dir():
        raise ConfigError(
            f"{run_dir}: no such folder; give the folder of a run, such as runs/relocate-…"
        )
    if not path.is_file():
        raise ConfigError(
            f"{run_dir} holds no {path.name}: give the folder of a run that knows stones"
        )
    return path


def choices_of(run_dir: Path) -> Choices:
    """Return the objects plugin that the run's mission chose, with its settings; the default one
    if the folder holds no mission.

    Raises:
        ConfigError: If the mission's file names no objects plugin, or one that is not installed.
    """
    path = RunFolder(run_dir).mission
    if not path.is_file():
        return Choices(("objects",))
    try:
        chosen = read_plain_yaml(path)["plugins"]["objects"]
    except (KeyError, TypeError) as error:
        raise ConfigError(
            f"{path}: names no objects plugin ({error}); is it a run's mission?"
        ) from error
    return Choices(("objects",), defaults={"objects": chosen}, source=str(path))
