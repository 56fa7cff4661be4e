"""The arm on cylinders with valves that are told what to give: oil, relief valves and friction."""

from collections.abc import Mapping
from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.robot.mujoco.machine import hydraulic_arm
from executive_plugins.robot.mujoco.machine.hydraulic_arm import HydraulicArm, add_friction

from executive.arrays import Float

MACHINE = SimpleNamespace(
    arm_names=("a", "b"),
    joints=(
        SimpleNamespace(name="a", max_effort=100.0, holds_without_pressure=True),
        SimpleNamespace(name="b", max_effort=50.0, holds_without_pressure=False),
    ),
)
KP, KV = np.array([1000.0, 250.0]), np.array([100.0, 50.0])
STEP_S = 0.004


class Valves:
    """Valves whose speed is set by the test, beside what they are asked for."""

    def __init__(self, *given: object) -> None:
        self.step_s, self.asked, self.speed = given[2], [], np.zeros(2)

    def step(self, command: Float) -> None:
        self.asked.append(command.tolist())

    def keep(self) -> Mapping[str, object]:
        return {"asked": list(self.asked)}

    def restore(self, kept: Mapping[str, object]) -> None:
        self.asked = list(kept["asked"])


class Controller:
    """A controller that counts, and adds what it is given."""

    def __init__(self, *given: object) -> None:
        self.at = np.array(given[2])
        self.calls = 0

    def measured(self, position: Float) -> Float:
        return np.round(position, 1)

    def command(self, position: Float, velocity: Float, measured: Float) -> Float:
        self.calls += 1
        return position + 10 * velocity + 100 * measured

    def pace(self, velocity: Float) -> float:
        return float(velocity.sum())

    def keep(self) -> int:
        return self.calls

    def restore(self, kept: int) -> None:
        self.calls = kept


class Named(SimpleNamespace):
    """A model of two joints, each with a motor."""

    def actuator(self, name: str) -> SimpleNamespace:
        return SimpleNamespace(id=("a", "b").index(name))

    def joint(self, name: str) -> SimpleNamespace:
        i = ("a", "b").index(name)
        return SimpleNamespace(qposadr=[i], dofadr=[i], id=i)


@pytest.fixture
def arm(monkeypatch: pytest.MonkeyPatch) -> HydraulicArm:
    monkeypatch.setattr(hydraulic_arm, "Valves", Valves)
    monkeypatch.setattr(hydraulic_arm, "ValveController", Controller)
    monkeypatch.setattr(
        "executive_plugins.robot.mujoco.machine.arm_servos._integral_limit",
        lambda machine: np.ones(2),
    )
    bias = np.zeros((2, 3))
    bias[:, 2] = -KV
    gains = np.column_stack([KP, np.zeros((2, 2))])
    model = Named(
        opt=SimpleNamespace(timestep=STEP_S),
        actuator_gainprm=gains,
        actuator_biasprm=bias,
        actuator_forcerange=np.zeros((2, 2)),
        jnt_actfrclimited=np.zeros(2, dtype=bool),
        jnt_actfrcrange=np.zeros((2, 2)),
        dof_frictionloss=np.array([3.0, 1.5]),
        dof_solimp=np.full((2, 5), 0.5),
    )
    data = SimpleNamespace(
        qpos=np.array([0.5, -0.26]), qvel=np.zeros(2), ctrl=np.zeros(2), qfrc_actuator=np.zeros(2)
    )
    made = HydraulicArm(model, data, MACHINE, SimpleNamespace(), np.random.default_rng(0))
    made.data, made.model = data, model
    return made


def test_joints_have_the_dry_friction_of_their_cylinders() -> None:
    joints = {name: SimpleNamespace(frictionloss=0.0) for name in MACHINE.arm_names}
    add_friction(SimpleNamespace(joint=joints.get), SimpleNamespace(friction=0.03), MACHINE)
    assert [one.frictionloss for one in joints.values()] == pytest.approx([3.0, 1.5])


def test_closed_valves_hold_the_arm_where_its_oil_is(arm: HydraulicArm) -> None:
    arm.drive(np.ones(2), np.zeros(2))
    assert arm.data.ctrl.tolist() == [0.5, -0.26]
    arm.data.qpos += 0.05  # a load compresses the oil, which pushes back
    arm.drive(np.ones(2), np.zeros(2))
    assert arm.data.ctrl.tolist() == [0.5, -0.26]


def test_the_oil_moves_at_the_speed_of_the_valves(arm: HydraulicArm) -> None:
    """The damping of the servo is with the speed of the oil, which leads by kv / kp."""
    arm._valves.speed = np.array([0.5, -1.0])
    for k in (1, 2, 3):
        arm.drive(np.ones(2), np.zeros(2))
        oil = np.array([0.5, -0.26]) + k * STEP_S * np.array([0.5, -1.0])
        assert arm.data.ctrl == pytest.approx(oil + np.array([0.1, 0.2]) * [0.5, -1.0])


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_relief_valve_opens_at_the_largest_effort(arm: HydraulicArm, sign: float) -> None:
    """Stiffness times the distance of the oil from the joint is at most the effort's limit."""
    arm._valves.speed = sign * np.array([100.0, 100.0])
    for _ in range(3):
        arm.drive(np.ones(2), np.zeros(2))
    most = sign * np.array([100.0 / 1000.0, 50.0 / 250.0])
    lead = np.array([0.1, 0.2]) * arm._valves.speed
    assert arm.data.ctrl == pytest.approx(np.array([0.5, -0.26]) + most + lead)


def test_the_controller_runs_once_a_period_of_its_own(arm: HydraulicArm) -> None:
    """Every 10 ms, that is every second step of 4 ms, with positions as they are measured."""
    assert (arm.controller.at.tolist(), arm._valves.step_s) == ([0.5, -0.26], STEP_S)
    for k in range(5):
        arm.drive(np.full(2, float(k)), np.full(2, 0.1))
    assert arm.controller.calls == 3
    asked = [[51.0 + k, -29.0 + k] for k in (0, 0, 2, 2, 4)]
    assert np.array(arm._valves.asked) == pytest.approx(np.array(asked))
    assert arm.pace(np.array([0.25, 0.5])) == 0.75


def test_a_shut_valve_brakes_with_the_effort_at_which_its_relief_valve_opens(
    arm: HydraulicArm,
) -> None:
    """The line has no pressure, so that what its sensor measures, the actuator's force, is none."""
    for name in ("a", "b"):
        arm.weaken(name, 0.0)
    assert arm.model.actuator_forcerange.tolist() == [[0.0, 0.0], [0.0, 0.0]]
    assert arm.model.dof_frictionloss.tolist() == [100.0, 1.5]  # the other has no such valve
    assert arm.model.dof_solimp[:, 0].tolist() == [pytest.approx(1.0, abs=1e-3), 0.5]
    for name in ("a", "b"):
        arm.weaken(name, 0.5)  # some of the pressure opens it
    assert arm.model.dof_frictionloss.tolist() == [3.0, 1.5]
    assert (arm.model.dof_solimp == 0.5).all()
    assert arm.model.jnt_actfrcrange.tolist() == [[-50.0, 50.0], [-25.0, 25.0]]


def test_a_lost_pressure_is_lost_in_the_world_that_goes_on(arm: HydraulicArm) -> None:
    arm.weaken("a", 0.0)
    kept = arm.keep()
    arm.weaken("a", 1.0)
    arm.restore(kept)
    assert arm.model.dof_frictionloss.tolist() == [100.0, 1.5]
    assert arm.model.jnt_actfrclimited.tolist() == [True, False]


def test_it_goes_on_from_what_was_kept(arm: HydraulicArm) -> None:
    arm._valves.speed = np.array([0.5, -1.0])
    for _ in range(3):
        arm.drive(np.ones(2), np.zeros(2))
    kept = arm.keep()
    after = []
    for _ in range(2):
        arm.restore(kept)
        for _ in range(2):
            arm.drive(2 * np.ones(2), np.zeros(2))
        after.append((arm.data.ctrl.tolist(), arm.controller.calls, arm._valves.asked))
    assert after[0] == after[1]
    assert after[0][1] == 3
    assert len(after[0][2]) == 5
