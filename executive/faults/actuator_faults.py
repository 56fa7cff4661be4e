"""The faults of actuators: what a drive makes of a command, in front of any robot."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from executive.arrays import Float
from executive.faults.description import ARM, JAWS, ActuatorFault
from executive.interfaces.facilities import Breakable
from executive.interfaces.robot import Robot
from executive.machine.machine import Machine
from executive.messages.command import Command, Follow, MoveJaws
from executive.messages.trajectory import JointTrajectory

_SLUGGISH_SHARE = 0.5  # of the commanded motion, where the file gives none
_NO_FORCE_N = 1.0  # what jaws without pressure still press with
_STEP_S = 0.05  # of the rest of a path that is commanded anew
_LEAST_S = 0.2  # a rest of a path that is shorter is not worth a new command


class FaultyActuator:
    """One fault of one drive: commands are changed before they reach the robot.

    A simulated robot takes the loss of pressure itself: a joint whose machine declares that it
    holds without pressure stops, any other sinks or coasts, and jaws let go.
    """

    def __init__(self, fault: ActuatorFault, machine: Machine) -> None:
        self.fault, self._machine = fault, machine
        is_sluggish = fault.how == "sluggish"
        self._share = (fault.share or _SLUGGISH_SHARE) if is_sluggish else 0.0
        arm = machine.arm_names if fault.actuator == ARM else (fault.actuator,)
        self._joints = () if fault.actuator == JAWS else arm
        self._holding = [one.name for one in machine.joints if one.holds_without_pressure]

    def begin(self, robot: Robot, command: Callable[[Command], None], way: "Way") -> None:
        """Act on what the robot is doing when the fault begins."""
        if self.fault.how == "open":
            command(MoveJaws(self._machine.gripper.open_rad, self._machine.gripper.tip_force_n))
        elif isinstance(robot, Breakable) and self.fault.how == "no_pressure":
            self._weaken(robot, 0.0)
        elif self.fault.actuator == JAWS:
            command(MoveJaws(self._machine.gripper.open_rad, _NO_FORCE_N))
        else:
            rest = way.rest()
            if rest is not None:
                command(Follow(self._slowed(rest)))

    def end(self, robot: Robot) -> None:
        """Let the drive be sound again; what it has not moved stays where it is."""
        if isinstance(robot, Breakable) and self.fault.how == "no_pressure":
            self._weaken(robot, 1.0)

    def alter(self, command: Command, robot: Robot) -> Command | None:
        """Return the command that reaches the drives instead; None if none does."""
        is_broken_itself = isinstance(robot, Breakable) and self.fault.how == "no_pressure"
        if is_broken_itself:
            return command
        if isinstance(command, MoveJaws) and self.fault.actuator == JAWS:
            return self._jaws(command)
        if isinstance(command, Follow) and self._joints:
            return replace(command, trajectory=self._slowed(command.trajectory))
        return command

    @property
    def is_of_arm(self) -> bool:
        """Whether it keeps the arm from its path, which shows only as the path goes on."""
        return bool(self._joints)

    def withheld(self, robot: Robot, way: "Way", since_s: float) -> float:
        """Return by how much the worst joint is off a sound one with its lag [rad] or [m].

        A sound drive is between the motion that is commanded now and that of its declared lag ago.
        A sluggish one makes its share of it. A joint without pressure stays where it is; one of a
        simulated robot that does not hold without pressure goes on at the speed that it had when
        that began, as long as no other force acts on it.

        Args:
            robot: The robot, which may take the loss of pressure itself.
            way: What it was commanded.
            since_s: Machine time at which the fault began [s].
        """
        commanded = way.commanded(since_s, self._machine.stance.tracking_lag_s)
        if commanded is None:
            return 0.0
        is_broken_itself = isinstance(robot, Breakable) and self.fault.how == "no_pressure"
        coasts = is_broken_itself & ~np.isin(commanded.names, self._holding)
        made = np.where(coasts, commanded.coasted, self._share * commanded.now)
        low = np.minimum(commanded.now, commanded.lagged)
        high = np.maximum(commanded.now, commanded.lagged)
        is_faulty = np.isin(commanded.names, self._joints)
        return float(np.maximum(low - made, made - high)[is_faulty].max(initial=0.0))

    def _jaws(self, command: MoveJaws) -> MoveJaws | None:
        if self.fault.how == "sluggish":
            return replace(command, force_n=max(self._share * command.force_n, _NO_FORCE_N))
        return None  # open, or without pressure: they do not close

    def _slowed(self, trajectory: JointTrajectory) -> JointTrajectory:
        """Return the trajectory with only a share of the motion of the faulty joints."""
        share = np.array([self._share if n in self._joints else 1.0 for n in trajectory.names])
        start = trajectory.position[0]
        return replace(
            trajectory,
            position=start + share * (trajectory.position - start),
            velocity=share * trajectory.velocity,
        )

    def _weaken(self, robot: Breakable, share: float) -> None:
        names = (self._machine.jaw.name,) if self.fault.actuator == JAWS else self._joints
        for name in names:
            robot.weaken(name, share)


@dataclass(frozen=True, slots=True, eq=False)
class Commanded:
    """The motion of each joint since an instant [rad] or [m], shape (n,) each.

    Attributes:
        names: The joints.
        now: Commanded up to now.
        lagged: Commanded up to the drives' lag ago.
        coasted: What a joint makes that goes on at the speed which was commanded at that instant.
    """

    names: tuple[str, ...]
    now: Float
    lagged: Float
    coasted: Float


class Way:
    """The path that the robot follows, so that a fault can act in the middle of it.

    Args:
        now_s: Returns the machine's time [s].
    """

    _began_s: float  # of the newest path

    def __init__(self, now_s: Callable[[], float]) -> None:
        self._now_s = now_s
        self._trajectory: JointTrajectory | None = None
        self._wanted: JointTrajectory | None = None

    def take(self, given: Command, reaching: Command) -> None:
        """Take a command of the mission, and what of it has reached the robot."""
        if isinstance(given, Follow) and isinstance(reaching, Follow):
            self._wanted, self._trajectory = given.trajectory, reaching.trajectory
            self._began_s = self._now_s()

    def stop(self) -> None:
        """Take a stop: the rest of the path is the robot's own."""
        self._trajectory = self._wanted = None

    def commanded(self, since_s: float, lag_s: float) -> "Commanded | None":
        """Return what was commanded since a machine time [s]; None if nothing is followed."""
        wanted = self._wanted
        if wanted is None:
            return None
        begin_s = max(since_s - self._began_s, 0.0)
        now_s = max(self._now_s() - self._began_s, begin_s)
        before, speed = wanted.at(begin_s)
        return Commanded(
            names=wanted.names,
            now=wanted.at(now_s)[0] - before,
            lagged=wanted.at(max(now_s - lag_s, begin_s))[0] - before,
            coasted=speed * (now_s - begin_s),
        )

    def rest(self) -> JointTrajectory | None:
        """Return what is left of the path; None if that is nothing."""
        if self._trajectory is None:
            return None
        since_s = self._now_s() - self._began_s
        left_s = self._trajectory.duration_s - since_s
        if left_s < _LEAST_S:
            return None
        times = np.linspace(0.0, left_s, int(np.ceil(left_s / _STEP_S)) + 1)
        at = [self._trajectory.at(since_s + time) for time in times]
        return JointTrajectory(
            self._trajectory.names,
            times,
            np.array([position for position, _ in at]),
            np.array([velocity for _, velocity in at]),
        )
