"""Every cloud of a folder, one after the other; what is done is passed over."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from executive.commands.console import say
from executive.errors import ConfigError, DataError, ExecutiveError

Work = Callable[[Path, Path], dict[str, Any]]


def each_of(folder: Path, out: Path | None, asked: Mapping[str, Any], work: Work) -> int:
    """Do a work on each cloud of a folder, write its answer as JSON, and return the exit status.

    The answer of `site.ply` is `site.ply.json`, and stands from the moment that all of it is
    written. It is passed over while it is newer than its cloud and the same was asked for. A cloud
    that cannot be used is told, and the others are gone on with.

    Args:
        folder: Where the clouds are.
        out: Where answers go; it is made if it is not there.
        asked: The options that the answers depend on; they are written with each.
        work: Takes a cloud and the path of a PLY file to write; returns the answer.

    Raises:
        ConfigError: If no folder for the answers is given, or it is a file.
        DataError: If the folder holds no cloud.
    """
    from executive.clouds.reader import SUFFIXES

    if out is None or out.is_file() or out.resolve() == folder.resolve():
        raise ConfigError(f"--out: {folder} is a folder of clouds: name another folder for answers")
    clouds = sorted(path for path in folder.iterdir() if path.suffix.lower() in SUFFIXES)
    if not clouds:
        raise DataError(f"{folder}: holds no cloud ({', '.join(SUFFIXES)})")
    out.mkdir(parents=True, exist_ok=True)
    failed = 0
    for number, cloud in enumerate(clouds, 1):
        done = out / f"{cloud.name}.json"
        if _is_done(done, cloud, asked):
            say(f"{cloud.name}: done before ({number} of {len(clouds)})")
            continue
        try:
            found = {"asked": asked, **work(cloud, out / f"{cloud.name}.segments.ply")}
        except ExecutiveError as error:
            failed += 1
            say(f"{cloud.name}: cannot be used: {error} ({number} of {len(clouds)})")
            continue
        begun = done.with_suffix(".begun")
        begun.write_text(json.dumps(found, indent=2, ensure_ascii=False), encoding="utf-8")
        begun.replace(done)
    say(f"{folder}: {len(clouds) - failed} of {len(clouds)} clouds")
    return int(failed > 0)


def _is_done(done: Path, cloud: Path, asked: Mapping[str, Any]) -> bool:
    """Return whether an answer is there, of the cloud as it is, to the same options."""
    if not done.is_file() or done.stat().st_mtime < cloud.stat().st_mtime:
        return False
    try:
        before = json.loads(done.read_text(encoding="utf-8"))
    except ValueError:  # it is no answer of this command: it is written anew
        return False
    return isinstance(before, dict) and before.get("asked") == asked
