"""`executive check`: the mistakes of a mission file, or of a campaign file."""

from collections.abc import Sequence

from executive.commands.console import answer, say
from executive.commands.options import JsonOption, MissionArgument, SetOption


def check(mission: MissionArgument, set_: SetOption = None, as_json: JsonOption = False) -> None:
    """Check a mission file, or a campaign file.

    Every mistake is listed with its place, all at once.

    Example: executive check my_wall.yaml --set placing.spacing_m=1.8
    """
    from executive.campaign.description.campaign_file import is_campaign_file
    from executive.tree.problem import MissionFileError

    kind = "campaign" if is_campaign_file(mission) else "mission"
    try:
        load = _load_campaign if kind == "campaign" else _load_mission
        name, warnings = load(mission, set_ or ())
    except MissionFileError as error:
        if as_json:
            problems = [str(problem) for problem in error.problems]
            answer({kind: None, "problems": problems, "warnings": []})
        raise
    for warning in warnings:
        say(warning)
    say(f"{name}: no mistake found")
    if as_json:
        answer({kind: name, "problems": [], "warnings": list(warnings)})


def _load_mission(mission: str, settings: Sequence[str]) -> tuple[str, Sequence[str]]:
    from executive.tree.load import load_mission

    description = load_mission(mission, settings, is_for_here=True)
    return description.name, [str(warning) for warning in description.warnings]


def _load_campaign(file: str, settings: Sequence[str]) -> tuple[str, Sequence[str]]:
    from executive.campaign.description.load import load_campaign
    from executive.campaign.description.options import CampaignOptions

    campaign = load_campaign(file, CampaignOptions(settings=tuple(settings)))
    return campaign.name, campaign.warnings
