"""The command that repeats one run of a campaign."""

import shlex
from pathlib import Path

from executive.campaign.execution.folder import CampaignFolder
from executive.campaign.reporting.result import Result

_WORK = "mission"


def repetition(folder: Path, result: Result) -> str:
    """Return the command that repeats a mission with equal settings, answers and seed.

    The mission's file is the resolved one in the run's folder; where the run ended before it was
    written, it is written beside the runs. Empty for work that is no mission.

    Args:
        folder: The campaign's folder.
        result: The run.
    """
    trial = result.trial
    if trial.work != _WORK or "mission" not in trial.arguments:
        return ""
    mission = CampaignFolder(folder).run(trial.number, result.tries) / "mission.yaml"
    if not mission.is_file():
        mission = folder / "repeat" / f"{trial.number}.yaml"
        mission.parent.mkdir(parents=True, exist_ok=True)
        mission.write_text(trial.arguments["mission"], encoding="utf-8")
    answers = "".join(f" --answer {shlex.quote(one)}" for one in trial.arguments.get("answers", ()))
    return f"executive run {shlex.quote(str(mission))} --seed {trial.seed}{answers}"
