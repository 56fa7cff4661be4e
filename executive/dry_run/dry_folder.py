"""The folder of a dry run: the mission, the journal, and a note that its leaves were mocked."""

import json
from pathlib import Path
from types import TracebackType

from executive.dry_run.chance import Chance
from executive.dry_run.dry_run import DryResult
from executive.journal import Journal
from executive.mission.run_folder import RunFolder
from executive.tree.language import MissionFile
from executive.tree.resolved import resolved_yaml


class DryFolder:
    """What a dry run leaves behind; it has no report, so that nobody takes it for a real run.

    Attributes:
        journal: The run's journal, a file of the folder.
    """

    def __init__(self, path: Path, mission: MissionFile) -> None:
        """Make the folder.

        Raises:
            ConfigError: If it holds a run already or cannot be made.
        """
        self._folder = RunFolder.create(path, mission.name)
        self._folder.mission.write_text(resolved_yaml(mission), encoding="utf-8")
        self.journal = Journal(self._folder.journal)

    def __enter__(self) -> "DryFolder":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.journal.close()
        self._folder.give_room()
        self._folder.release()

    def finish(self, chance: Chance, result: DryResult) -> None:
        """Note that the run was dry, with what it was drawn by."""
        note = {
            "seed": chance.seed,
            "failures": chance.failures,
            "outcome": result.outcome,
            "reason": result.reason,
            "ended_s": result.ended_s,
        }
        self._folder.dry_note.write_text(json.dumps(note, indent=2) + "\n", encoding="utf-8")
