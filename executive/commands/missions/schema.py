"""`executive schema`: the JSON schema of mission files, and of campaign files."""

from typing import Annotated

import typer

from executive.commands.console import answer


def schema(
    campaign: Annotated[
        bool, typer.Option("--campaign", help="Of campaign files instead of mission files.")
    ] = False,
) -> None:
    """Print the JSON schema of mission files.

    It is built from what is installed; an editor completes and checks missions by it.

    Example: executive schema > mission.schema.json
    """
    if campaign:
        from executive.campaign.description.schema import campaign_schema

        answer(campaign_schema())
        return
    from executive.tree.schema import mission_schema

    answer(mission_schema())
