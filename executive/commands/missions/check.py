"""`executive check`: the mistakes of a mission file."""

from executive.commands.console import answer, say
from executive.commands.options import JsonOption, MissionArgument, SetOption


def check(mission: MissionArgument, set_: SetOption = None, as_json: JsonOption = False) -> None:
    """Check a mission file.

    Every mistake is listed with its place, all at once.

    Example: executive check my_wall.yaml --set placing.spacing_m=1.8
    """
    from executive.tree.load import load_mission
    from executive.tree.problem import MissionFileError

    try:
        description = load_mission(mission, set_ or ())
    except MissionFileError as error:
        if as_json:
            problems = [str(problem) for problem in error.problems]
            answer({"mission": None, "problems": problems, "warnings": []})
        raise
    warnings = [str(warning) for warning in description.warnings]
    for warning in warnings:
        say(warning)
    say(f"{description.name}: no mistake found")
    if as_json:
        answer({"mission": description.name, "problems": [], "warnings": warnings})
