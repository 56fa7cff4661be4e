"""Where a run keeps its stones, and what plugin wrote them."""

from pathlib import Path

import yaml

from executive.errors import ConfigError
from executive.mission.run_folder import RunFolder

_DEFAULT = "sqlite"


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


def plugin_of(run_dir: Path) -> str:
    """Return the name of the objects plugin that the run's mission chose; the default one if it
    does not tell.
    """
    path = RunFolder(run_dir).mission
    if not path.is_file():
        return _DEFAULT
    try:
        chosen = yaml.safe_load(path.read_text(encoding="utf-8"))["plugins"]["objects"]
        return str(chosen["plugin"] if isinstance(chosen, dict) else chosen)
    except (yaml.YAMLError, KeyError, TypeError) as error:
        raise ConfigError(
            f"{path}: names no objects plugin ({error}); is it a run's mission?"
        ) from error
