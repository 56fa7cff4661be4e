"""The folder of a campaign."""

from dataclasses import dataclass
from pathlib import Path

from executive.campaign.execution.disk_space import disk_errors


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
        with disk_errors(self.description):
            partial.write_text(text, encoding="utf-8")
        partial.replace(self.description)

    @property
    def results(self) -> Path:
        """The ledger."""
        return self.path / "results.sqlite"

    @property
    def lock(self) -> Path:
        return self.path / "campaign.lock"

    @property
    def runs(self) -> Path:
        """The folder with a folder for each try of each trial."""
        return self.path / "runs"

    def run(self, number: int, tries: int) -> Path:
        """Return the folder of one try of a trial."""
        return self.runs / f"{number}-{tries}"
