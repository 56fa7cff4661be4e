"""The bias of a gyroscope from pieces of rest, and how sure it is."""

import numpy as np
import pytest
from executive_plugins.estimation.start.rest_bias import RestBias


def test_without_a_piece_nothing_is_known() -> None:
    bias = RestBias(2.0)
    assert np.array_equal(bias.rate, np.zeros(3))
    assert bias.std_rad_s == np.inf


def test_pieces_that_overlap_count_once() -> None:
    bias = RestBias(2.0)
    assert bias.add(10.0, np.full(3, 0.01), 1e-3)
    assert not bias.add(11.9, np.full(3, 0.05), 1e-3)
    assert bias.rate == pytest.approx(np.full(3, 0.01))
    assert bias.add(12.0, np.full(3, 0.03), 1e-3)
    assert bias.rate == pytest.approx(np.full(3, 0.02))


def test_it_is_as_sure_as_noise_or_the_spread_of_the_pieces_allow() -> None:
    bias = RestBias(1.0)
    bias.add(0.0, np.array([0.0, 0.01, 0.0]), 3e-3)
    assert bias.std_rad_s == pytest.approx(3e-3)
    bias.add(1.0, np.array([0.0, 0.01, 0.0]), 4e-3)
    assert bias.std_rad_s == pytest.approx(np.sqrt(12.5e-6))
    bias.add(2.0, np.array([0.0, 0.04, 0.003]), 4e-3)
    assert bias.std_rad_s == pytest.approx(0.03 / np.sqrt(3))
