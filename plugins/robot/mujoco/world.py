"""The simulated world: machine and site in one MuJoCo model, stepped by the control period."""

from collections.abc import Callable, Mapping
from typing import TypedDict

import mujoco
import numpy as np
from executive_plugins.physics.scenario import Scenario, contact_of
from executive_plugins.robot.mujoco.machine.arm_servos import ArmServos, make_servos
from executive_plugins.robot.mujoco.machine.footing import Footing, KeptFooting, OnLegs, OnWheels
from executive_plugins.robot.mujoco.machine.hydraulic_arm import (
    HydraulicArm,
    add_friction,
)
from executive_plugins.robot.mujoco.machine.jaw_drive import JawDrive, KeptJaws
from executive_plugins.robot.mujoco.machine.legs import Legs, set_footing, set_on_legs
from executive_plugins.robot.mujoco.machine.wheels import (
    Wheels,
    add_carrier,
    set_on_wheels,
    standing_on,
)
from executive_plugins.robot.mujoco.physics import apply_physics
from executive_plugins.robot.mujoco.physics_settings import LegSettings, PhysicsSettings
from executive_plugins.robot.mujoco.site.person import Walk
from executive_plugins.robot.mujoco.site.site import Site
from executive_plugins.robot.mujoco.site.terrain import let_dig
from executive_plugins.robot.trajectory_follower import Follower, KeptPath

from executive.arrays import Float
from executive.errors import RobotError
from executive.geometry.pose import pose
from executive.geometry.rotation import quaternion_wxyz
from executive.machine.hydraulics import Hydraulics
from executive.machine.machine import Machine
from executive.machine.mjcf import machine_spec
from executive.messages.command import Drive, Follow, LimitStop, MoveJaws

CONTROL_STEP_S = 0.01  # period of the controllers, of the fastest sensors, and of observers

_START_POSTURE = "scan"
_STAND_S = 3.0  # in which the machine comes to rest on its legs, before time begins
_STATE = mujoco.mjtState.mjSTATE_INTEGRATION


class KeptWorld(TypedDict):
    """The state of the simulation and of what drives it."""

    state: Float
    steps: int
    follower: KeptPath
    arm: Mapping[str, object]
    jaws: KeptJaws
    footing: KeptFooting


class World:
    """The true state, which only the simulator, its sensors and the oracle may read.

    Attributes:
        machine: Description of the machine.
        site: Ground and stones.
        scenario: Name of its physics.
        model: Compiled MuJoCo model; bodies and joints have the names of the description.
        data: State of the model.
        footing: What the machine stands on.
        T_world_base: Pose of the base at the start, shape (4, 4).
    """

    def __init__(
        self,
        machine: Machine,
        site: Site,
        settings: PhysicsSettings,
        scenario: Scenario = "kind",
        legs: LegSettings | None = None,
        valves: np.random.Generator | None = None,
        *,
        on_wheels: bool = False,
    ) -> None:
        """Build the world.

        Args:
            machine: The machine.
            site: Ground and stones.
            settings: Integration, contacts, and gains of the drives.
            scenario: Name of its physics.
            legs: How the legs yield; the base is welded to the ground without.
            valves: Draws the machine's own valves; its joints have servos without.
            on_wheels: Whether the machine stands on wheels, and drives; one on legs drives, too, if
                its description says how.
        """
        self.machine, self.site = machine, site
        self.scenario, self._contact = scenario, contact_of(scenario, machine.gripper)
        self.T_world_base = pose(t=np.array([0.0, 0.0, machine.stance.base_height_m]))
        if on_wheels:
            self.T_world_base = standing_on(site.terrain.height_at, machine, np.zeros(3))
        self._substeps = settings.substeps(CONTROL_STEP_S)
        hydraulics = None if valves is None else machine.hydraulics
        self.model = self._build(settings, legs, hydraulics, on_wheels=on_wheels)
        self.data = mujoco.MjData(self.model)
        self._set_arm(machine.posture(_START_POSTURE))
        self.arm = self._drives(valves)
        self.jaws = JawDrive(self.model, self.data, machine, settings)
        self._walk = Walk(site.people, self.model)
        self._follower = Follower(machine, self.arm.position())
        self._control_steps = 0
        self._observers: list[Callable[[World], None]] = []
        self.footing = self._footing(legs, on_wheels=on_wheels)
        self._stand()

    @property
    def time_s(self) -> float:
        """Simulated time [s]."""
        return self._control_steps * CONTROL_STEP_S

    @property
    def is_moving(self) -> bool:
        """Whether a trajectory is being followed, or the chassis moves."""
        return self._follower.is_moving or self.footing.is_moving

    @property
    def legs(self) -> Legs | None:
        """The legs that the machine stands on, or None if it stands on none."""
        return self.footing.legs

    @property
    def wheels(self) -> Wheels | None:
        """The wheels that it drives on, or None if it does not drive."""
        return self.footing.wheels

    def reference(self) -> Float:
        """Return where the arm is asked to be now, shape (n,)."""
        return self._follower.position()

    def observe(self, observer: Callable[["World"], None]) -> None:
        """Register a function that is called after each control step."""
        self._observers.append(observer)

    def follow(self, command: Follow) -> None:
        """Follow a trajectory.

        Raises:
            RobotError: If it is refused.
        """
        self.footing.check_standing()
        self._follower.follow(command.trajectory, self.arm.position(), command.stop_s)

    def limit_stop(self, command: LimitStop) -> None:
        """Change the least time of a stop in the middle of the path under way."""
        self._follower.limit_stop(command.stop_s)

    def drive(self, command: Drive) -> None:
        """Drive the chassis.

        Raises:
            RobotError: If it does not drive, or the command is refused; see `BaseDriver`.
        """
        self.footing.command(command, self.arm.position(), arm_moves=self._follower.is_moving)

    def move_jaws(self, command: MoveJaws) -> None:
        """Drive the jaws.

        Raises:
            RobotError: If the angle or the force is out of range.
        """
        jaw, gripper = self.machine.jaw, self.machine.gripper
        if not jaw.lower <= command.position_rad <= jaw.upper:
            raise RobotError(
                f"jaws to {command.position_rad:.3f} rad: the range is {jaw.lower} to "
                f"{jaw.upper} rad"
            )
        if not 0 < command.force_n <= gripper.tip_force_n:
            raise RobotError(
                f"tip force {command.force_n:.0f} N: the largest is {gripper.tip_force_n:.0f} N"
            )
        self.jaws.press(command.position_rad, command.force_n)

    def stop(self) -> None:
        """Slow the arm down along its path, and brake; the jaws keep pressing."""
        self._follower.stop()
        self.footing.stop()

    def give_up(self) -> None:
        """Slow the arm down for good; jaws that press keep pressing, and others hold."""
        self._follower.give_up()
        self.footing.give_up()
        self.jaws.hold()

    def take_up(self) -> None:
        """Go on after `give_up`: a machine on raised legs stands on them again."""
        self.footing.go_on()

    def resume(self) -> None:
        """Continue along the path that `stop` interrupted."""
        self._follower.resume()

    def behind_s(self) -> float:
        """Return by how much the arm will be behind the mission's time if that goes on now [s]."""
        return self._follower.behind_s()

    def pause(self) -> None:
        """Note that the mission's time stands still; free jaws hold."""
        self._follower.pause()
        self.jaws.hold()

    def go_on(self) -> None:
        """Note that the mission's time goes on; jaws go on to where they were sent."""
        self._follower.go_on()
        self.jaws.go_on()

    def step(self) -> None:
        """Advance by one control step.

        Raises:
            RobotError: If the integration diverged, or the machine has tipped over.
        """
        dt_s = float(self.model.opt.timestep)
        pace = 1.0
        if isinstance(self.arm, HydraulicArm):
            pace = self.arm.pace(self._follower.velocity())
        self._walk.step(self.time_s + CONTROL_STEP_S, self.data)
        for _ in range(self._substeps):
            self._substep(*self._follower.advance(dt_s, pace))
        # mj_step leaves the poses one substep behind the positions.
        mujoco.mj_kinematics(self.model, self.data)
        self._control_steps += 1
        if (
            self.data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number
            or not np.isfinite(self.data.qpos).all()
        ):
            raise RobotError(
                f"the simulated world diverged at {self.time_s:.2f} s; use a smaller "
                "physics.timestep_s"
            )
        self.footing.watch()
        for observer in self._observers:
            observer(self)

    def _substep(self, position: Float, velocity: Float) -> None:
        """Advance by one integration step, with references of the arm, shape (n,) each."""
        self.arm.drive(position, velocity)
        self.jaws.drive()
        self.footing.advance(float(self.model.opt.timestep))
        mujoco.mj_step(self.model, self.data)

    def _stand(self) -> None:
        """Level the legs and let the machine come to rest on them, before time begins."""
        if self.legs is None:
            return
        self.legs.level()
        position = self.arm.position()
        for _ in range(round(_STAND_S / float(self.model.opt.timestep))):
            self._substep(position, np.zeros(len(position)))
        self.data.time = 0.0
        self.T_world_base = self.T_world_body(self.machine.base_link)

    def keep(self) -> KeptWorld:
        """Return the state of the simulation and of what drives it; the site follows from the seed.

        Source: mj_getState of MuJoCo 3, with mjSTATE_INTEGRATION: all that a step depends on.
        """
        state = np.empty(mujoco.mj_stateSize(self.model, _STATE))
        mujoco.mj_getState(self.model, self.data, state, _STATE)
        return {
            "state": state,
            "steps": self._control_steps,
            "follower": self._follower.keep(),
            "arm": self.arm.keep(),
            "jaws": self.jaws.keep(),
            "footing": self.footing.keep(),
        }

    def restore(self, kept: KeptWorld) -> None:
        """Go on with the world of a process that has ended."""
        mujoco.mj_setState(self.model, self.data, kept["state"], _STATE)
        mujoco.mj_forward(self.model, self.data)
        self._control_steps = kept["steps"]
        self.arm.restore(kept["arm"])
        self._follower.restore(kept["follower"])
        self.jaws.restore(kept["jaws"])
        self.footing.restore(kept["footing"])

    def T_world_body(self, name: str) -> Float:
        """Return the pose of a link or a stone by its name, shape (4, 4)."""
        body = self.data.body(name)
        return pose(body.xmat.reshape(3, 3).copy(), body.xpos.copy())

    def _drives(self, valves: np.random.Generator | None) -> ArmServos:
        if valves is None or self.machine.hydraulics is None:
            return ArmServos(self.model, self.data, self.machine)
        return HydraulicArm(self.model, self.data, self.machine, self.machine.hydraulics, valves)

    def _footing(self, legs: LegSettings | None, *, on_wheels: bool) -> Footing:
        height_at = self.site.terrain.height_at
        if on_wheels:
            return OnWheels(self.model, self.data, self.machine, height_at)
        if legs is not None:
            return OnLegs(self.model, self.data, self.machine, height_at, legs)
        return Footing()

    def _build(
        self,
        settings: PhysicsSettings,
        legs: LegSettings | None,
        hydraulics: Hydraulics | None,
        *,
        on_wheels: bool,
    ) -> mujoco.MjModel:
        spec = machine_spec(self.machine)
        base = spec.body(self.machine.base_link)
        base.pos = self.T_world_base[:3, 3]
        if on_wheels:
            base.quat = quaternion_wxyz(self.T_world_base[:3, :3])
        make_servos(spec, self.machine, settings)
        if hydraulics is not None:
            add_friction(spec, hydraulics, self.machine)
        if legs is not None:
            set_on_legs(spec, self.machine, legs)
            if self.machine.driving is not None:
                add_carrier(spec, self.machine, holds=False)
        if on_wheels:
            set_on_wheels(spec, self.machine)
        self.site.add_to(spec)
        for jaw in self.machine.gripper.links:
            let_dig(spec.body(jaw))
        apply_physics(spec, settings, self._contact)
        if legs is not None:
            set_footing(spec, self.machine, settings.replaced(self._contact).soil)
        return spec.compile()

    def _set_arm(self, position: Float) -> None:
        for name, value in zip(self.machine.arm_names, position, strict=True):
            self.data.joint(name).qpos = value
        mujoco.mj_forward(self.model, self.data)
