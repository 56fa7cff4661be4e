"""What leaves answered, by the contents: small values in the journal itself, large ones beside."""

import base64
import hashlib
import os
from pathlib import Path
from typing import Any

from executive.errors import DataError
from executive.journal.value_codec import NotKeptError
from executive.journal.value_file import from_bytes, to_bytes

_SMALL_BYTES = 400
_DIGITS = 32


class ValueFolder:
    """Keeps values in files that are named after their contents.

    A file is written whole before the journal names it; `secure` waits until it is on the disk.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._pending: list[Path] = []
        self.failure: OSError | None = None  # why values are no longer kept, such as a full disk

    def put(self, value: Any) -> Any:
        """Return what stands for a value in the journal, after it was kept.

        A value that cannot be kept is named; `get` refuses it.
        """
        if value is None or type(value) in (bool, int, float, str):
            return value
        try:
            data = to_bytes(value)
        except NotKeptError as error:
            return {"lost": str(error)}
        if len(data) <= _SMALL_BYTES:
            return {"data": base64.b85encode(data).decode()}
        name = hashlib.sha256(data).hexdigest()[:_DIGITS]
        self._write(name, data)
        return {"file": name}

    def get(self, found: Any) -> Any:
        """Return a value.

        Raises:
            DataError: If it was not kept, or its file is missing or damaged.
        """
        if not isinstance(found, dict):
            return found
        if "data" in found:
            try:
                return from_bytes(base64.b85decode(found["data"]))
            except ValueError as error:
                raise DataError(f"not a kept value: {error}") from error
        if "file" not in found:
            raise DataError(str(found.get("lost", f"not a kept value: {found}")))
        return from_bytes(self._read(str(found["file"])))

    def secure(self) -> None:
        """Wait until all values are on the disk."""
        for path in self._pending:
            with path.open("rb") as file:
                os.fdatasync(file.fileno())
        self._pending.clear()

    def _read(self, name: str) -> bytes:
        path = self._folder / name
        try:
            data = path.read_bytes()
        except OSError as error:
            raise DataError(f"{path}: a kept value cannot be read: {error.strerror}") from error
        if hashlib.sha256(data).hexdigest()[:_DIGITS] != name:
            raise DataError(f"{path}: a kept value was changed")
        return data

    def _write(self, name: str, data: bytes) -> None:
        path = self._folder / name
        if path.exists():
            return
        try:
            self._folder.mkdir(exist_ok=True)
            partial = path.with_suffix(".partial")
            partial.write_bytes(data)
            partial.replace(path)
        except OSError as error:
            self.failure = error
            return
        self._pending.append(path)
