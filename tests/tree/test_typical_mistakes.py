"""Typical mistakes are told at their line, with a cure."""

import pytest

from tests.tree.typical_mistakes import GOOD, MISTAKES, Mistake, problems_of, written


def test_the_mission_without_a_mistake_is_good_and_there_are_sixty_mistakes() -> None:
    assert problems_of(GOOD) == ()
    assert len(MISTAKES) >= 60


@pytest.mark.parametrize("mistake", MISTAKES, ids=lambda one: f"{one.old}->{one.new}")
def test_a_mistake_is_told_at_its_line_with_its_cure(mistake: Mistake) -> None:
    text, line = written(mistake)
    told = [one.message for one in problems_of(text) if one.mark.line == line]
    assert told, [str(one) for one in problems_of(text)]
    assert any(mistake.cure in message for message in told), told
