"""The folder of one run: what a mission leaves behind."""

import shutil
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path

from executive.errors import ConfigError
from executive.interfaces.report_file import REPORT
from executive.mission.run_lock import LOCK, RunLock

_RESERVE_BYTES = 2**18  # for a report, whose size grows with the number of picks


@dataclass(frozen=True, slots=True)
class RunFolder:
    """Paths of a run's files; DESIGN: a run's folder."""

    path: Path
    lock: RunLock | None = field(default=None, compare=False)  # held by the run that writes

    @classmethod
    def create(cls, path: Path | None, mission: str) -> "RunFolder":
        """Make the folder; without a path, a new one under `runs/`.

        Raises:
            ConfigError: If it holds a run already, another run writes into it, it holds files that
                no run has written and this one would write over, or it cannot be made or written.
        """
        folder = path or _fresh(mission)
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise ConfigError(
                f"the run folder {folder} cannot be made: {error.strerror}"
            ) from error
        cls(folder)._refuse_strange_files()
        made = cls(folder, RunLock(folder))
        if made.journal.exists():
            made.release()
            raise ConfigError(f"{folder} holds a run already; give another --run-dir")
        try:
            made._reserve.write_bytes(bytes(_RESERVE_BYTES))
        except OSError as error:
            made.release()
            raise ConfigError(
                f"the run folder {folder} cannot be written: {error.strerror}"
            ) from error
        return made

    @classmethod
    def open(cls, path: Path) -> "RunFolder":
        """Open the folder of a run that was cut off, to go on with it.

        Raises:
            ConfigError: If it holds no run, or a run writes into it.
        """
        if not cls(path).journal.is_file() or not cls(path).mission.is_file():
            raise ConfigError(f"{path} holds no run: it lacks journal.jsonl or mission.yaml")
        if cls(path).dry_note.is_file():
            raise ConfigError(f"{path} is a dry run, which cannot be resumed: run it again")
        return cls(path, RunLock(path))

    def _refuse_strange_files(self) -> None:
        """Refuse a folder in which no run began, with files of names that a run writes or removes.

        Raises:
            ConfigError: If there are any; it names them.
        """
        if (self.path / LOCK).exists() or self.journal.exists():  # a run's own files
            return
        written = (
            *(self.mission, self.options, self.values, self.kept, self.objects, self.map),
            *(self.report, self.dry_note, self.log, self.recording, self._reserve),
        )
        strange = [path.name for path in written if path.exists()]
        if strange:
            raise ConfigError(
                f"{self.path} is no run's folder and holds {', '.join(strange)}, which a run would "
                "write over or remove; give a new folder as --run-dir"
            )

    def give_room(self) -> None:
        """Free what was set aside for the report, should the disk be full."""
        self._reserve.unlink(missing_ok=True)

    def forget_state(self) -> None:
        """Remove what only a run that goes on or is resumed needs."""
        for folder in (self.values, self.kept):
            shutil.rmtree(folder, ignore_errors=True)

    @property
    def _reserve(self) -> Path:
        return self.path / "reserve"

    def release(self) -> None:
        """Let another run write."""
        if self.lock is not None:
            self.lock.release()

    @property
    def mission(self) -> Path:
        return self.path / "mission.yaml"

    @property
    def journal(self) -> Path:
        return self.path / "journal.jsonl"

    @property
    def options(self) -> Path:
        return self.path / "options.json"

    @property
    def values(self) -> Path:
        return self.path / "values"

    @property
    def kept(self) -> Path:
        return self.path / "kept"

    @property
    def objects(self) -> Path:
        return self.path / "objects.sqlite"

    @property
    def map(self) -> Path:
        return self.path / "map.ply"

    @property
    def report(self) -> Path:
        return self.path / REPORT

    @property
    def dry_note(self) -> Path:
        """Return the note of a run whose leaves were mocked."""
        return self.path / "dry_run.json"

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
