"""The folder of one run: what a mission leaves behind."""

from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from executive.errors import ConfigError


@dataclass(frozen=True, slots=True)
class RunFolder:
    """Paths of a run's files; DESIGN: a run's folder."""

    path: Path

    @classmethod
    def create(cls, path: Path | None, mission: str) -> "RunFolder":
        """Make the folder; without a path, a new one under `runs/`.

        Raises:
            ConfigError: If it holds a run already, or cannot be made.
        """
        folder = path or _fresh(mission)
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise ConfigError(
                f"the run folder {folder} cannot be made: {error.strerror}"
            ) from error
        if (folder / "journal.jsonl").exists():
            raise ConfigError(f"{folder} holds a run already; give another --run-dir")
        return cls(folder)

    @property
    def mission(self) -> Path:
        return self.path / "mission.yaml"

    @property
    def journal(self) -> Path:
        return self.path / "journal.jsonl"

    @property
    def objects(self) -> Path:
        return self.path / "objects.sqlite"

    @property
    def map(self) -> Path:
        return self.path / "map.ply"

    @property
    def report(self) -> Path:
        return self.path / "report.json"

    @property
    def log(self) -> Path:
        return self.path / "log.txt"

    @property
    def recording(self) -> Path:
        return self.path / "recording.rrd"


def _fresh(mission: str) -> Path:
    stamp = datetime.now(UTC).strftime("%Y%m%d-%H%M%S")  # noqa: TID251 - names a folder, decides nothing
    name = f"{mission}-{stamp}"
    candidates = (Path("runs") / (name if n == 0 else f"{name}-{n}") for n in range(1000))
    return next(path for path in candidates if not path.exists())
