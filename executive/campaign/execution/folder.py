"""The folder of a campaign."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True)
class CampaignFolder:
    """Paths of a campaign's files."""

    path: Path

    @property
    def description(self) -> Path:
        """The campaign file as it was given, or what the options say."""
        return self.path / "campaign.yaml"

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
