"""A judge rates in a process of its own; whatever becomes of that process, there is an answer."""

import os

import numpy as np
import pytest

from executive.errors import ExecutiveError
from executive.messages.building import AsBuilt
from executive.messages.height_grid import HeightGrid
from executive.messages.structure import Structure
from executive.mission.judging import verdict_of

WALL = Structure("wall", np.array([[-1.0, 0.0], [1.0, 0.0]]), 1.0, 1.0)
BARE = AsBuilt(WALL, HeightGrid.plane(np.array([-2.0, -2.0]), np.array([2.0, 2.0])))


class Deadly:
    """Ends the process that it is sent to."""

    def __reduce__(self):
        return os._exit, (3,)


def test_the_shipped_judge_rates_a_structure_without_a_stone():
    verdict = verdict_of(BARE, "rigid_stones")
    assert (verdict["stones"], verdict["fill"], verdict["height_m"]) == (0, 0.0, 0.0)


def test_a_judge_whose_process_ends_is_an_error_and_not_waited_for_without_end():
    with pytest.raises(ExecutiveError, match="the process of the judge 'rigid_stones' ended early"):
        verdict_of(Deadly(), "rigid_stones")


def test_an_error_of_the_judge_comes_back_in_words():
    with pytest.raises(ExecutiveError, match=r"the judge 'nobody' failed: (.|\n)*UnknownPlugin"):
        verdict_of(BARE, "nobody")
