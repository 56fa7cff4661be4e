"""The simulated robot apart from its world: what it hands on, refuses and latches."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from executive_plugins.robot.mujoco.robot import MujocoRobot
from executive_plugins.robot.mujoco.settings import MujocoSettings
from executive_plugins.robot.mujoco.truth.truth_file import read_records

from executive.errors import RobotError
from executive.machine.machine import load_machine
from executive.messages.command import Drive, MoveJaws, SwitchLidars

MACHINE = load_machine("m545")


class World:
    """Notes what it is told."""

    def __init__(self) -> None:
        self.told: list[Any] = []
        self.time_s, self.is_moving = 2.0, False
        self.jaws = SimpleNamespace(weaken=lambda share: self.told.append(("jaws", share)))
        self.arm = SimpleNamespace(weaken=lambda *given: self.told.append(given))
        self.legs: Any = None

    def behind_s(self) -> float:
        return 0.25

    def __getattr__(self, name: str) -> Any:
        return lambda *given: self.told.append((name, *given))


@pytest.fixture
def robot() -> MujocoRobot:
    made = MujocoRobot(MujocoSettings(), MACHINE, np.random.default_rng(1))
    made._world = World()
    made._sensors = SimpleNamespace(lidars_on=False)
    return made


def test_before_its_start_it_has_no_world_and_nothing_has_changed() -> None:
    robot = MujocoRobot(MujocoSettings(), MACHINE, np.random.default_rng(1))
    assert robot.revision == 0
    with pytest.raises(RobotError, match=r"the simulated robot is not started: call start\(\)"):
        robot.stop()


def test_its_revision_counts_the_steps_of_control(robot: MujocoRobot) -> None:
    robot.world.time_s = 0.0
    assert robot.revision == 0
    robot.world.time_s = 2.0
    assert robot.revision == 200
    robot.close()
    assert robot.revision == 0


def test_pauses_and_stops_reach_the_world(robot: MujocoRobot) -> None:
    robot.stop()
    robot.paused(1.0)
    assert robot.behind_s() == 0.25
    robot.resumed(1.0)
    robot.resume()
    assert robot.world.told == [("stop",), ("pause",), ("go_on",), ("resume",)]


def test_a_safe_stop_is_latched_until_the_machine_rests_and_is_reset(robot: MujocoRobot) -> None:
    assert robot.latched() == ""
    robot.safe_stop("a fault")
    assert robot.latched() == "a fault"
    assert robot.world.told == [("give_up",)]
    with pytest.raises(RobotError, match=r"MoveJaws is refused: a safe stop is latched \(a fault"):
        robot.command(MoveJaws(0.3, 8000.0))
    robot.command(SwitchLidars(True))
    assert robot._sensors.lidars_on is True
    robot.world.is_moving = True
    with pytest.raises(RobotError, match="still moves"):
        robot.reset()
    robot.world.is_moving = False
    robot.reset()
    assert robot.latched() == ""
    robot.command(MoveJaws(0.3, 8000.0))
    robot.command(Drive(0.5, 0.0))
    assert [one[0] for one in robot.world.told] == ["give_up", "take_up", "move_jaws", "drive"]


def test_drives_of_the_arm_and_of_the_jaws_are_weakened_apart(robot: MujocoRobot) -> None:
    robot.weaken("J_BOOM", 0.5)
    robot.weaken(MACHINE.jaw.name, 0.0)
    assert robot.world.told == [("J_BOOM", 0.5), ("jaws", 0.0)]


@pytest.mark.parametrize("has_legs", [False, True])
def test_the_stance_of_legs_is_part_of_the_truth(
    robot: MujocoRobot, tmp_path: Path, has_legs: bool
) -> None:
    taken: list[Any] = []
    robot.truth_log = SimpleNamespace(
        records=lambda: {"time_s": np.arange(3.0)}, take=lambda *given: taken.append(given)
    )
    robot.limit_log = SimpleNamespace(records=dict, take=lambda *given: None)
    if has_legs:
        robot.world.legs = SimpleNamespace(most_tilt_rad=0.1, least_margin_m=0.4)
    path = tmp_path / "truth.npz"
    robot.write_truth(path)
    assert read_records(path)["stance"].tolist() == ([0.1, 0.4] if has_legs else [])
    robot.world.legs = SimpleNamespace(most_tilt_rad=0.0, least_margin_m=9.0)
    robot.read_truth(path, 5.0)
    ((records, zero_s),) = taken
    assert zero_s == 5.0
    assert records["time_s"].tolist() == [0.0, 1.0, 2.0]
    legs = robot.world.legs
    assert (legs.most_tilt_rad, legs.least_margin_m) == ((0.1, 0.4) if has_legs else (0.0, 9.0))


def test_a_photograph_is_of_the_site_as_it_is_now(
    robot: MujocoRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    site = SimpleNamespace(photograph=lambda *given: iter([given]))
    monkeypatch.setattr(MujocoRobot, "site_now", lambda self: site)
    assert next(iter(robot.photograph([np.eye(4)], (40, 30), 1.0)))[1:] == ((40, 30), 1.0)
