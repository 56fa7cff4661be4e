"""What a campaign answers to its missions' questions: nobody is there to be asked."""

from executive.errors import did_you_mean
from executive.mission.preset_answers import answers_of, preset_answers, unanswered
from executive.tree.language import MissionFile
from executive.tree.problem import Mark
from executive.tree.reading import Reading
from executive.tree.value import Scalar, Table, Value


class AnswerReader:
    """Gives each mission those of the campaign's answers that its questions take."""

    def __init__(self, table: Table, reading: Reading) -> None:
        """Read `answers`: a list of choices, true for yes and false for no; mistakes are noted."""
        self._reading = reading
        self._given: dict[str, Mark] = {}
        self._offered: set[str] = set()
        value = table.get("answers")
        listing = None if value is None else reading.listing(value, "'answers'")
        for item in () if listing is None else listing.items:
            text = self._word(item)
            if text is not None:
                self._given[text] = item.mark
        if {"yes", "no"} <= self._given.keys():
            told = "true and false are both given; questions of yes or no take one of them"
            reading.problems.error(self._given.pop("no"), told)

    def _word(self, item: Value) -> str | None:
        """Return an answer as `--answer` takes it."""
        if isinstance(item, Scalar) and isinstance(item.value, bool):
            return "yes" if item.value else "no"
        return self._reading.text(item, "an answer")

    def of(self, mission: MissionFile, mark: Mark) -> tuple[str, ...]:
        """Return the answers that a mission takes; note each question that is left open.

        Args:
            mission: The mission.
            mark: Where the campaign names it.
        """
        offered = answers_of(mission)
        self._offered |= offered
        taken = tuple(one for one in self._given if one in offered)
        for ask in unanswered(preset_answers(taken, mission), mission):
            words = " or ".join(ask.choices or ("true", "false"))
            self._reading.problems.error(
                mark,
                f"{mission.name} asks '{ask.question}', and nobody is there to answer: put {words} "
                "under 'answers', or give the question a default",
            )
        return taken

    def refuse_unused(self) -> None:
        """Note each answer that no mission takes, after all missions were seen."""
        for text, mark in self._given.items():
            if text not in self._offered:
                near = did_you_mean(text, self._offered)
                told = f"no question of the campaign's missions takes '{text}'{near}"
                self._reading.problems.error(mark, told)
