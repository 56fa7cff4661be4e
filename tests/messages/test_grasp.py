"""A grasp refuses what no plugin can mean."""

import numpy as np
import pytest

from executive.messages.grasp import Grasp


@pytest.mark.parametrize("rate", [None, 0.0, 1.0])
def test_a_rate_is_a_share_or_unknown(rate):
    assert Grasp(np.eye(4), 1.0, 0.5, {}, rate).hold_rate == rate


@pytest.mark.parametrize("rate", [-0.1, 1.1, float("nan")])
def test_any_other_rate_is_refused(rate):
    with pytest.raises(ValueError, match="hold_rate is a share from 0 to 1"):
        Grasp(np.eye(4), 1.0, 0.5, {}, rate)
