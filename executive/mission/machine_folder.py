"""What the folder of a run holds of a machine that lives in a process of its own."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from executive.errors import DataError
from executive.interfaces.oracle import Witness
from executive.interfaces.robot import Robot
from executive.journal.newest_file import NewestFile, newest_in
from executive.journal.value_file import from_bytes, to_bytes
from executive.mission.run_folder import RunFolder


@dataclass(frozen=True, slots=True)
class MachineFolder:
    """Paths of the machine's files in the folder of a run."""

    path: Path

    @property
    def mission(self) -> Path:
        """The mission, which says what machine and what site."""
        return RunFolder(self.path).mission

    @property
    def log(self) -> Path:
        """What the machine's process says."""
        return self.path / "machine.txt"

    @property
    def address(self) -> Path:
        """Where it listens."""
        return self.path / "machine.address"

    @property
    def truth(self) -> Path:
        """What it leaves at its end for the report; only an oracle reads it."""
        return self.path / "truth.npz"

    @property
    def state(self) -> Path:
        """The newest state of the world, for a run that is resumed."""
        return RunFolder(self.path).kept / "world"

    def last_words(self) -> str:
        """Return the last line that the machine's process has said."""
        lines = self.log.read_text(encoding="utf-8", errors="replace").strip().splitlines()
        return lines[-1] if lines else "the simulated machine ended at its start, without a word"


class WorldKeeper:
    """Writes the state of a simulated machine as it lives, and takes it back.

    Args:
        folder: The machine's files.
        robot: The machine.
    """

    def __init__(self, folder: MachineFolder, robot: Robot) -> None:
        self._folder, self._robot = folder, robot
        self._file: NewestFile | None = None

    def restore(self) -> float:
        """Let the world go on where it was kept; return its clock then [s], 0 if it is new.

        Raises:
            DataError: If there is a state that cannot be read: a world that began anew instead
                would have its stones where they no longer are.
        """
        data = newest_in(self._folder.state)
        if data is None:
            return 0.0
        try:
            kept: Any = from_bytes(data)
        except DataError as error:
            raise DataError(
                f"{self._folder.state}: the state of the simulated world cannot be read ({error}); "
                "start the mission anew in another folder"
            ) from error
        self._robot.restore(kept["robot"])
        return float(kept["time_s"])

    def keep(self, time_s: float) -> None:
        """Write the state at a time of the machine's clock [s].

        Raises:
            OSError: If it cannot be written.
        """
        if self._file is None:
            self._folder.state.parent.mkdir(exist_ok=True)
            self._file = NewestFile(self._folder.state)
        self._file.write(to_bytes({"time_s": time_s, "robot": self._robot.keep()}))

    def end(self, time_s: float) -> None:
        """Write the last state, and what really happened, should the machine know it.

        Raises:
            OSError: If they cannot be written.
        """
        self.keep(time_s)
        if self._file is not None:
            self._file.close()
        if isinstance(self._robot, Witness):
            self._robot.write_truth(self._folder.truth)
