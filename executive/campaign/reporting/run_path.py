"""Where the files of a campaign's run are."""

from pathlib import Path

from executive.campaign.reporting.result import Result


def run_path(folder: Path, result: Result) -> Path:
    """Return the folder of a result's last try."""
    return folder / "runs" / f"{result.trial.number}-{result.tries}"
