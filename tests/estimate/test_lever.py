"""Places of sensors that the command line gives for a log without static transforms."""

import numpy as np
import pytest

from executive.errors import ConfigError
from executive.estimate.lever import read_levers


def test_places_are_read_by_their_frames() -> None:
    levers = read_levers(["gps:0,0,1.2", "a/b:c:-1,2.5,3"])
    assert list(levers) == ["gps", "a/b:c"]
    np.testing.assert_array_equal(levers["a/b:c"], [-1.0, 2.5, 3.0])
    assert read_levers([]) == {}


@pytest.mark.parametrize("text", ["", "gps", "gps:1,2", "gps:1,2,x", ":1,2,3", "gps:1,2,nan"])
def test_what_is_no_place_is_refused(text: str) -> None:
    with pytest.raises(ConfigError, match="is not FRAME:X,Y,Z in metres"):
        read_levers([text])


def test_a_place_in_millimetres_and_a_second_one_are_refused() -> None:
    with pytest.raises(ConfigError, match="is not FRAME:X,Y,Z in metres"):
        read_levers(["gps:0,0,1200"])
    with pytest.raises(ConfigError, match="'gps' is given twice"):
        read_levers(["gps:0,0,1", "gps:0,0,2"])
