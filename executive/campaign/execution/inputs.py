"""Input files and folders by their content, and the cache that a worker keeps them in."""

import os
import shutil
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path, PurePosixPath

from executive.errors import ConfigError, DataError

CHUNK_BYTES = 16 << 20  # of a message: large enough for a network, small beside a worker's memory


@dataclass(frozen=True, slots=True)
class InputFile:
    """One file of an input.

    Attributes:
        name: Its path beginning with the name of the input's own file or folder, with `/`.
        path: Where it is on this computer.
    """

    name: str
    path: Path


@dataclass(frozen=True, slots=True)
class Chunk:
    """A part of an input's files on its way to a worker.

    Attributes:
        name: Name of the file, see `InputFile`.
        offset: Position of the part in the file [byte].
        content: The part.
    """

    name: str
    offset: int
    content: bytes


def files_of(path: Path) -> tuple[InputFile, ...]:
    """List the files of an input, a file or a folder with all that is in it, in order of names.

    Raises:
        ConfigError: If the input does not exist, is empty, or holds something that is neither a
            file nor a folder, such as a link to a folder, which could lead anywhere.
    """
    if path.is_file():
        return (InputFile(path.name, path),)
    if not path.is_dir():
        raise ConfigError(f"input {path} does not exist")
    path = path.resolve()
    found = sorted(one for one in path.rglob("*") if one.is_symlink() or not one.is_dir())
    for one in found:
        if not one.is_file():
            raise ConfigError(f"input {path}: {one} is neither a file nor a folder; copy it there")
    if not found:
        raise ConfigError(f"input {path} is a folder without files")
    return tuple(InputFile(one.relative_to(path.parent).as_posix(), one) for one in found)


def digest_of(path: Path) -> str:
    """Return the SHA-256, in hexadecimal digits, over names, sizes and bytes of an input's files.

    Raises:
        ConfigError: As `files_of`, or if a file cannot be read.
    """
    digest = sha256()
    try:
        for file in files_of(path):
            digest.update(f"{file.name}\0{file.path.stat().st_size}\0".encode())
            with file.path.open("rb") as content:
                while part := content.read(CHUNK_BYTES):
                    digest.update(part)
    except OSError as error:
        raise ConfigError(f"input {path} cannot be read: {error}") from error
    return digest.hexdigest()


def stamp_of(path: Path) -> tuple[tuple[str, int, int], ...]:
    """Return names, sizes and times of change: while they are equal, the content is taken as equal.

    Raises:
        ConfigError: As `files_of`.
    """
    stats = ((file.name, file.path.stat()) for file in files_of(path))
    return tuple((name, stat.st_size, stat.st_mtime_ns) for name, stat in stats)


def chunks_of(path: Path) -> Iterator[Chunk]:
    """Yield the content of an input in parts; an empty file is one empty part."""
    for file in files_of(path):
        with file.path.open("rb") as content:
            offset = 0
            part = content.read(CHUNK_BYTES)
            while part or offset == 0:
                yield Chunk(file.name, offset, part)
                offset += max(len(part), 1)
                part = content.read(CHUNK_BYTES)


class InputCache:
    """Inputs by their digest in a folder that the workers of a computer share.

    An input is written under another name, compared with its digest, made read-only, and only then
    renamed: what is in the cache is whole. Nothing in it is ever changed.
    """

    def __init__(self, folder: Path) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self._folder = folder
        self._arriving: dict[str, Path] = {}
        self._verified: dict[str, object] = {}  # stamp by digest

    def find(self, digest: str) -> Path | None:
        """Return where an input is, once its content is found equal to its digest; else None.

        One that has been changed since it arrived is removed, to be sent again.
        """
        home = self._folder / digest
        if not home.is_dir():
            return None
        path = next(home.iterdir())
        if self._verified.get(digest) == stamp_of(path):
            return path
        stamp = stamp_of(path)
        if digest_of(path) == digest:
            self._verified[digest] = stamp
            return path
        self._remove(home)
        return None

    def receive(self, digest: str, chunk: Chunk) -> None:
        """Write one part of an input that is arriving.

        Raises:
            DataError: If its name leads out of the cache.
        """
        home = self._arriving.get(digest)
        if home is None:
            home = Path(tempfile.mkdtemp(prefix="arriving-", dir=self._folder))
            self._arriving[digest] = home
        target = home / safe_name(chunk.name)
        target.parent.mkdir(parents=True, exist_ok=True)
        with target.open("r+b" if target.exists() else "w+b") as file:
            file.seek(chunk.offset)
            file.write(chunk.content)

    def complete(self, digest: str) -> None:
        """Take an input that has arrived whole into the cache.

        Nothing is done if another campaign that sent it at the same time was first.

        Raises:
            DataError: If what arrived differs from the digest.
        """
        home = self._arriving.pop(digest, None)
        if home is None:
            return
        arrived = digest_of(next(home.iterdir()))
        if arrived != digest:
            shutil.rmtree(home)
            raise DataError(f"an input arrived with the digest {arrived} instead of {digest}")
        for file in home.rglob("*"):
            if file.is_file():
                file.chmod(0o444)
        try:
            home.rename(self._folder / digest)
        except OSError:  # another worker of this computer was first
            self._remove(home)

    def _remove(self, home: Path) -> None:
        """Take a folder out of the cache at once, and delete it."""
        aside = Path(tempfile.mkdtemp(prefix="removed-", dir=self._folder))
        os.rename(home, aside / home.name)
        shutil.rmtree(aside)


def safe_name(name: str) -> PurePosixPath:
    """Return a relative name that was received, once it is sure to stay in its folder.

    Raises:
        DataError: If it is absolute, empty, or has a part `..`.
    """
    path = PurePosixPath(name)
    if path.is_absolute() or ".." in path.parts or not path.parts or "\0" in name or "\\" in name:
        raise DataError(f"the name {name!r} of a received file leads out of its folder")
    return path
