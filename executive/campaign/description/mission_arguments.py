"""What one run of the work `mission` is given."""

from pydantic import Field

from executive.config import Settings


class MissionArguments(Settings):
    """Arguments of a mission that a campaign runs."""

    mission: str = Field(
        description="Complete mission file as text: every setting, tree and wire explicit, so that "
        "a run needs no other file of the mission, and a changed mission is another trial. Paths "
        "in settings are absolute."
    )
    answers: tuple[str, ...] = Field(
        (),
        description="Answers to the mission's questions, as with `--answer`: yes, no, or choices.",
    )
