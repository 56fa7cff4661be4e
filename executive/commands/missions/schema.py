"""`executive schema`: the JSON schema of mission files."""

from executive.commands.console import answer


def schema() -> None:
    """Print the JSON schema of mission files.

    It is built from what is installed; an editor completes and checks missions by it.

    Example: executive schema > mission.schema.json
    """
    from executive.tree.schema import mission_schema

    answer(mission_schema())
