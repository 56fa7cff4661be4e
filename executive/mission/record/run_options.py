"""How a run was started, kept in its folder, so that it can be resumed in the same way."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path

from executive.errors import DataError


@dataclass(frozen=True, slots=True)
class KeptOptions:
    """Options of the command line that a resumed run takes over."""

    seed: int
    real_time: bool
    runner: str | None
    answer: bool | None
    choices: tuple[str, ...]
    attended: bool
    pause_on_failure: bool
    apart: bool

    def write(self, path: Path) -> None:
        """Write them."""
        path.write_text(json.dumps(asdict(self), indent=2) + "\n", encoding="utf-8")

    @classmethod
    def read(cls, path: Path) -> "KeptOptions":
        """Read them back.

        Raises:
            DataError: If the file is missing or damaged.
        """
        try:
            return cls(**json.loads(path.read_text(encoding="utf-8")))
        except (OSError, ValueError, TypeError, RecursionError) as error:
            raise DataError(f"{path}: how the run was started cannot be read: {error}") from error
