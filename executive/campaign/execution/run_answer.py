"""The answer of a run in its folder: complete or absent, so that a later campaign can adopt it."""

import json
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from executive.campaign.trial import Outcome, Status, Trial

NAME = "answer.json"


@dataclass(frozen=True, slots=True)
class RunAnswer:
    """What a run that came to its end leaves.

    Attributes:
        trial: Fingerprint of the trial, see `fingerprint`.
        answer: What the work returned.
        wall_s: Duration of the run in its process [s].
        cpu_s: Processor time of the process and of its children that have ended [s].
        peak_memory_bytes: Largest resident memory of the process [byte].
        worker: Host and process.
    """

    trial: str
    answer: Mapping[str, Any]
    wall_s: float
    cpu_s: float
    peak_memory_bytes: int
    worker: str

    def outcome(self, number: int) -> Outcome:
        """Return the outcome of the trial, as far as the run itself could know it."""
        return Outcome(
            number,
            Status.DONE,
            answer=self.answer,
            wall_s=self.wall_s,
            cpu_s=self.cpu_s,
            peak_memory_bytes=self.peak_memory_bytes,
            worker=self.worker,
        )


def fingerprint(trial: Trial) -> str:
    """Return a hash of what determines the answer of a trial: work, arguments and seed."""
    said = json.dumps([trial.work, trial.arguments, trial.seed], sort_keys=True)
    return sha256(said.encode()).hexdigest()[:16]


def write_answer(folder: Path, answer: RunAnswer) -> None:
    """Write the answer under another name, and give it its name when it is on the disk.

    Raises:
        TypeError: If the work returned something that JSON cannot hold.
        OSError: If it cannot be written.
    """
    unfinished = folder / f"{NAME}.unfinished"
    text = json.dumps(asdict(answer))
    with unfinished.open("w", encoding="utf-8") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())
    unfinished.rename(folder / NAME)


def read_answer(folder: Path, trial: Trial) -> RunAnswer | None:
    """Return the complete answer to a trial that is in a folder, if there is one."""
    try:
        found = RunAnswer(**json.loads((folder / NAME).read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError):
        return None
    return found if found.trial == fingerprint(trial) else None
