"""A prediction that is wrong is told from fixes that are noisier than they declare."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.innovation_bias import InnovationBias


@pytest.mark.parametrize("factor", [1.0, 5.0])
def test_noisy_fixes_do_not_make_the_prediction_wrong(factor: float) -> None:
    rng, bias = np.random.default_rng(1), InnovationBias(3)
    alarms = 0
    for _ in range(20_000):  # 1,000 s
        bias.add(rng.normal(0, factor * 0.01, 3), 1e-4 * np.eye(3), 0.05)
        alarms += bias.is_biased
    assert alarms <= 2  # one an hour by its bound


def test_innovations_that_lean_to_one_side_make_it_wrong_and_white_ones_right_again() -> None:
    rng, bias = np.random.default_rng(1), InnovationBias(3)
    for _ in range(6):
        bias.add(rng.normal(0, 0.01, 3) + [0.05, 0.0, 0.0], 1e-4 * np.eye(3), 0.05)
    assert bias.is_biased
    for _ in range(6):
        bias.add(rng.normal(0, 0.01, 3), 1e-4 * np.eye(3), 0.05)
    assert not bias.is_biased
