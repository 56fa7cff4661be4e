"""A folder for what a survey has finished, so that one that was cut off goes on.

Arrays are read from the disk a page at a time: memory does not grow with the number of pictures.
"""

import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from executive.errors import ConfigError

_KEY = "survey.key"
_PART = ".part"  # of a name: what is not finished

D = TypeVar("D", bound=np.generic)


class WorkFolder:
    """Keeps arrays and folders by name; what is there is whole."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def has(self, name: str) -> bool:
        """Return whether something of this name is finished."""
        return (self.path / name).exists()

    def array(self, name: str, make: Callable[[], NDArray[D]]) -> NDArray[D]:
        """Return an array of this name, read-only; make it if it is not there.

        It may be called from several threads, with other names.
        """
        file = self.path / f"{name}.npy"
        if not file.exists():
            part = file.with_suffix(_PART)
            with part.open("wb") as out:
                np.save(out, make())
            part.replace(file)
        return np.asarray(np.load(file, mmap_mode="r"))

    def folder(self, name: str, make: Callable[[Path], object]) -> Path:
        """Return a folder of this name; have it filled if it is not there."""
        folder = self.path / name
        if not folder.exists():
            part = folder.with_suffix(_PART)
            shutil.rmtree(part, ignore_errors=True)
            part.mkdir()
            make(part)
            part.rename(folder)
        return folder


@contextmanager
def work_folder(kept: Path | None, key: str) -> Iterator[WorkFolder]:
    """Give a folder whose content belongs to a key.

    Args:
        kept: Where it is, until all is done without an error; None for one that does not stay.
        key: What the results depend on; content of another key is removed.

    Raises:
        ConfigError: If the folder holds something that no survey has put there.
    """
    if kept is None:
        with tempfile.TemporaryDirectory(prefix="survey_") as scratch:
            yield WorkFolder(Path(scratch))
        return
    marker = kept / _KEY
    if kept.exists() and not marker.is_file() and (not kept.is_dir() or any(kept.iterdir())):
        raise ConfigError(
            f"surveying.work: {kept} is there already, and is no survey's: name a new folder"
        )
    if marker.is_file() and marker.read_text(encoding="ascii") != key:
        shutil.rmtree(kept)
    kept.mkdir(parents=True, exist_ok=True)
    marker.write_text(key, encoding="ascii")
    yield WorkFolder(kept)
    shutil.rmtree(kept)
