"""Every cloud of a folder, one after the other; what is done is passed over."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from executive.commands.console import say
from executive.errors import ConfigError, DataError, ExecutiveError

Work = Callable[[Path, Path], dict[str, Any]]


@dataclass(frozen=True, slots=True)
class Batch:
    """A folder of clouds, and what is wanted of each.

    Attributes:
        folder: Where the clouds are.
        out: Where answers go; it is made if it is not there.
        asked: The options that the answers depend on; they are written with each.
        written: What the PLY file beside an answer holds, a part of its name: `segments`.
        read: Other files that the answers depend on.
    """

    folder: Path
    out: Path | None
    asked: Mapping[str, Any]
    written: str
    read: tuple[Path, ...] = ()


def check_batch(folder: Path, out: Path | None, as_json: bool, is_shown: bool) -> Path:
    """Return the folder of the answers; refuse what is there for one cloud alone.

    Raises:
        ConfigError: If no folder for the answers is given, or it is a file, or the answers are to
            be printed or shown.
    """
    if is_shown:
        raise ConfigError("--view: shows one cloud; name a file of the folder")
    if as_json:
        raise ConfigError("--json: the answers of a folder are files in the folder of --out")
    if out is None or out.is_file() or out.resolve() == folder.resolve():
        raise ConfigError(f"--out: {folder} is a folder of clouds: name another folder for answers")
    return out


def each_of(batch: Batch, work: Work) -> int:
    """Do a work on each cloud of a folder, write its answer as JSON, and return the exit status.

    The answer of `site.ply` is `site.ply.json`, and stands from the moment that all of it is
    written. It is passed over while it is newer than its cloud and the other files that were read,
    and the same was asked for. A cloud that cannot be used is told, and the others are gone on
    with. The status is 1 if there was one, or if an answer has `accepted` and it is false.

    Args:
        batch: The folder.
        work: Takes a cloud and the path of a PLY file to write; returns the answer.

    Raises:
        ConfigError: If no folder for the answers is given, or it is a file.
        DataError: If the folder holds no cloud.
    """
    from executive.clouds.reader import SUFFIXES

    folder = batch.folder
    out = check_batch(folder, batch.out, as_json=False, is_shown=False)
    clouds = sorted(path for path in folder.iterdir() if path.suffix.lower() in SUFFIXES)
    if not clouds:
        raise DataError(f"{folder}: holds no cloud ({', '.join(SUFFIXES)})")
    out.mkdir(parents=True, exist_ok=True)
    failed = refused = 0
    for number, cloud in enumerate(clouds, 1):
        count = f"({number} of {len(clouds)})"
        done = out / f"{cloud.name}.json"
        found = _answer_before(done, (cloud, *batch.read), batch.asked)
        if found is not None:
            say(f"{cloud.name}: done before {count}")
        else:
            try:
                found = _worked(batch, work, cloud, done)
            except ExecutiveError as error:
                failed += 1
                say(f"{cloud.name}: cannot be used: {error} {count}")
                continue
        refused += found.get("accepted", True) is False
    told = f", {refused} refused" if refused else ""
    say(f"{folder}: {len(clouds) - failed} of {len(clouds)} clouds{told}")
    return int(failed + refused > 0)


def _worked(batch: Batch, work: Work, cloud: Path, done: Path) -> dict[str, Any]:
    """Do the work on one cloud, write its answer whole or not at all, and return it.

    An answer that is there is to another cloud or to other options, and is removed before.
    """
    ply = done.with_suffix(f".{batch.written}.ply")
    for before in (done, ply):
        before.unlink(missing_ok=True)
    found = {"asked": batch.asked, **work(cloud, ply)}
    begun = done.with_suffix(".begun")
    begun.write_text(json.dumps(found, indent=2, ensure_ascii=False), encoding="utf-8")
    begun.replace(done)
    return found


def _answer_before(
    done: Path, read: tuple[Path, ...], asked: Mapping[str, Any]
) -> dict[str, Any] | None:
    """Return an answer that is there, of the files as they are, to the same options; else None."""
    if not done.is_file() or any(done.stat().st_mtime < one.stat().st_mtime for one in read):
        return None
    try:
        before = json.loads(done.read_text(encoding="utf-8"))
    except ValueError:  # it is no answer of this command: it is written anew
        return None
    return before if isinstance(before, dict) and before.get("asked") == asked else None
