"""The folder of a campaign."""

import errno
from dataclasses import dataclass
from pathlib import Path

from executive.campaign.execution.disk_space import DiskFullError


@dataclass(frozen=True, slots=True)
class CampaignFolder:
    """Paths of a campaign's files."""

    path: Path

    @property
    def description(self) -> Path:
        """The campaign file with all options in it and absolute paths."""
        return self.path / "campaign.yaml"

    def keep_description(self, text: str) -> None:
        """Write the campaign file, whole or not at all.

        Raises:
            DiskFullError: If there is no space for it.
        """
        partial = self.description.with_suffix(".partial")
        try:
            partial.write_text(text, encoding="utf-8")
        except OSError as error:
            if error.errno == errno.ENOSPC:
                raise DiskFullError(f"no space is left for {self.description}") from error
            raise
        partial.replace(self.description)

    @property
    def results(self) -> Path:
        """The ledger."""
        return self.path / "results.sqlite"

    @property
    def lock(self) -> Path:
        return self.path / "campaign.lock"

    def run(self, number: int, tries: int) -> Path:
        """Return the folder of one try of a trial."""
        return self.path / "runs" / f"{number}-{tries}"
