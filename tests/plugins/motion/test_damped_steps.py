"""The compiled steps of inverse kinematics beside Pinocchio's kinematics."""

import numpy as np
import pytest
from executive_plugins.motion.arm_chain import ArmChain
from executive_plugins.motion.damped_steps import compile_steps, damped_steps

from executive.arrays import Float
from executive.geometry.rotation import angle_between
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine, load_machine


def limits(machine: Machine) -> tuple[Float, Float, Float]:
    lower, upper = np.maximum(machine.lower, -10.0), np.minimum(machine.upper, 10.0)
    return lower, upper, (lower + upper) / 2


@pytest.mark.parametrize("model", ["m545", "mini"])
def test_without_a_step_it_tells_by_how_much_the_pose_is_missed(model: str) -> None:
    machine = load_machine(model)
    kinematics, chain = Kinematics(machine), ArmChain.of(machine)
    lower, upper, _ = limits(machine)
    nothing = np.zeros(len(lower))
    for q, other in np.random.default_rng(5).uniform(lower, upper, (30, 2, len(lower))):
        T, wanted = kinematics.gripper(q), kinematics.gripper(other)
        ended, away_m, away_rad = damped_steps(chain, wanted, q, 0, nothing, limits(machine))
        np.testing.assert_array_equal(ended, q)
        assert away_m == pytest.approx(float(np.linalg.norm(T[:3, 3] - wanted[:3, 3])), abs=1e-9)
        assert away_rad == pytest.approx(angle_between(T[:3, :3], wanted[:3, :3]), abs=1e-6)


def test_a_pose_nearby_is_reached_in_few_steps_and_no_pull_is_left() -> None:
    machine = load_machine("m545")
    kinematics, chain = Kinematics(machine), ArmChain.of(machine)
    rng, begin = np.random.default_rng(6), machine.posture("carry")
    for _ in range(20):
        wanted = kinematics.gripper(begin + rng.normal(0, 0.05, len(begin)))
        q, away_m, away_rad = damped_steps(
            chain, wanted, begin, 6, np.full(len(begin), 0.1), limits(machine)
        )
        assert away_m < 2e-4
        assert away_rad < 1e-3
        np.testing.assert_allclose(kinematics.gripper(q)[:3, 3], wanted[:3, 3], atol=2e-4)


def test_joints_at_their_limits_stay_there_and_the_pose_is_missed() -> None:
    machine = load_machine("m545")
    begin = machine.posture("carry")
    wanted = Kinematics(machine).gripper(begin + 0.3)
    narrow = begin - 0.1, begin + 0.1, begin
    q, away_m, _ = damped_steps(
        ArmChain.of(machine), wanted, begin, 20, np.zeros(len(begin)), narrow
    )
    assert (q >= narrow[0]).all()
    assert (q <= narrow[1]).all()
    assert away_m > 0.05


def test_compiling_leaves_nothing_to_compile() -> None:
    machine = load_machine("mini")
    compile_steps(ArmChain.of(machine))
    from executive_plugins.motion import damped_steps as module

    before = len(module._iterate.signatures)
    damped_steps(
        ArmChain.of(machine),
        np.eye(4)[::1],
        machine.posture("scan"),
        2,
        np.zeros(len(machine.joints)),
        limits(machine),
    )
    assert len(module._iterate.signatures) == before
