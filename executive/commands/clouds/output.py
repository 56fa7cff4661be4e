"""The file that a command writes a cloud to."""

from collections.abc import Sequence
from pathlib import Path

from executive.commands.console import check_output
from executive.errors import ConfigError

_COPC = ".copc.laz"


def check_cloud_output(option: str, path: Path | None, read: Sequence[Path] = ()) -> None:
    """Refuse a file that no cloud can be written to, before anything is computed.

    Args:
        option: What it was given to, for messages.
        path: The file; None if none is wanted.
        read: Files that the command reads.

    Raises:
        ConfigError: If its name has another suffix than those that are written or says COPC, whose
            octree nothing here builds; or as `check_output`.
    """
    from executive.clouds.writer import WRITTEN

    if path is not None and path.name.lower().endswith(_COPC):
        plain = path.with_name(path.name[: -len(_COPC)] + ".laz")
        raise ConfigError(
            f"{option}: {path}: COPC is read, not written; write {plain}, and have PDAL or "
            "untwine make a COPC file of it"
        )
    check_output(option, path, *WRITTEN, read=read)
