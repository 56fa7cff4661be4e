"""Answers that were given before the run: `--answer`, held against the mission's questions."""

from collections.abc import Sequence
from dataclasses import dataclass

from executive.errors import ConfigError, did_you_mean
from executive.tree.language import MissionFile
from executive.tree.node_kinds import Ask

_TRUTHS = {"yes": True, "no": False}


@dataclass(frozen=True, slots=True)
class PresetAnswers:
    """What is answered without asking anybody.

    Attributes:
        answer: The answer to every question of yes or no; None if they are asked.
        choices: Choices; a question takes the first of them that it offers.
    """

    answer: bool | None = None
    choices: tuple[str, ...] = ()


def preset_answers(given: Sequence[str], mission: MissionFile) -> PresetAnswers:
    """Return what `--answer` says, given any number of times.

    Raises:
        ConfigError: If no question of the mission takes an answer, or yes and no are both given.
    """
    offered = {choice for ask in _questions(mission) for choice in ask.choices}
    for one in given:
        if one not in _TRUTHS and one not in offered:
            near = did_you_mean(one, {*_TRUTHS, *offered})
            raise ConfigError(f"--answer: no question of {mission.name} takes '{one}'{near}")
    truths = [_TRUTHS[one] for one in given if one in _TRUTHS and one not in offered]
    if len(set(truths)) > 1:
        raise ConfigError("--answer: yes and no are both given")
    choices = tuple(one for one in given if one in offered)
    return PresetAnswers(truths[0] if truths else None, choices)


def answers_of(mission: MissionFile) -> set[str]:
    """Return every answer that a question of the mission takes: choices, yes and no."""
    asked = _questions(mission)
    return {answer for ask in asked for answer in ask.choices or _TRUTHS}


def unanswered(preset: PresetAnswers, mission: MissionFile) -> list[Ask]:
    """Return the questions that only a person could answer."""
    return [
        ask
        for ask in _questions(mission)
        if ask.default is None
        and (not set(preset.choices) & set(ask.choices) if ask.choices else preset.answer is None)
    ]


def _questions(mission: MissionFile) -> list[Ask]:
    nodes = (node for tree in mission.trees.values() for node in tree.root.walk())
    return [node.kind for node in nodes if isinstance(node.kind, Ask)]
