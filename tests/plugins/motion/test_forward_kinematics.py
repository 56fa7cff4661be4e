"""The batched kinematics is another writing of Pinocchio's."""

import numpy as np
import pytest
from executive_plugins.motion.forward_kinematics import link_frames

from executive.machine.kinematics import Kinematics
from executive.machine.machine import load_machine


@pytest.mark.parametrize("model", ["m545", "mini"])
def test_agrees_with_pinocchio_at_random_postures(model: str) -> None:
    machine = load_machine(model)
    kinematics = Kinematics(machine)
    rng = np.random.default_rng(0)
    q = rng.uniform(
        np.maximum(machine.lower, -7.0), np.minimum(machine.upper, 7.0), (50, len(machine.joints))
    )
    frames = link_frames(machine, q, 0.4)
    for k, posture in enumerate(q):
        expected = kinematics.frames(posture, 0.4)
        for name in machine.links:
            np.testing.assert_allclose(frames[name][k], expected[name], atol=1e-12)
