"""Documents with one value changed, removed, renamed or added: what a reader says to each."""

import copy
import hashlib
import json
import random
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from executive.errors import ConfigError
from executive.tree.problem import MissionFileError

WRONG = (None, True, -1, 0, 2, 0.5, 1e9, "", "parsec", "{x}", "2 s", [], [3], {}, {"no": 1})


def _places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Yield where each value of a document is."""
    inner = value.items() if isinstance(value, dict) else enumerate(value)
    for key, one in inner:
        yield (*path, key)
        if isinstance(one, dict | list):
            yield from _places(one, (*path, key))


def edits(document: dict[str, Any], count: int, seed: int) -> Iterator[tuple[str, str]]:
    """Yield so many edits, drawn with a seed: what was done, and the text of the document."""
    rng = random.Random(seed)
    places = list(_places(document))
    rng.shuffle(places)
    for n in range(count):
        place = places[n % len(places)] if n < len(places) else rng.choice(places)
        changed = copy.deepcopy(document)
        holder: Any = changed
        for key in place[:-1]:
            holder = holder[key]
        what = rng.choice(["removed", "renamed", "wrong", "wrong", "wrong", "wrong"])
        if what == "removed":
            del holder[place[-1]]
        elif what == "renamed" and isinstance(holder, dict):
            holder[f"{place[-1]}x"] = holder.pop(place[-1])
        else:
            what = rng.choice(WRONG)
            holder[place[-1]] = what
        name = f"{n} {'.'.join(map(str, place))}: {what!r}"
        yield name, json.dumps(changed, indent=1)


def answers(
    document: dict[str, Any], count: int, seed: int, folder: Path, read: Callable[[str], Any]
) -> dict[str, str]:
    """Return what a reader says: its mistakes, or a digest of what it has read."""
    told = {"whole": _plain(repr(read(json.dumps(document))), folder)}
    for name, text in edits(document, count, seed):
        try:
            found = hashlib.sha256(_plain(repr(read(text)), folder).encode()).hexdigest()[:12]
        except (ConfigError, MissionFileError) as error:
            found = _plain(str(error), folder)
        told[name] = found
    return told


def _plain(text: str, folder: Path) -> str:
    return re.sub(r" at 0x[0-9a-f]+", "", text.replace(f"{folder}/", ""))
