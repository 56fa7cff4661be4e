"""Whether the drives of the arm have pressure: what they measure against what the motion needs."""

from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from executive.arrays import Bool, Float
from executive.machine.dynamics import Dynamics
from executive.machine.gravity import GRAVITY_M_S2
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine
from executive.machine.sensor import Encoders
from executive.messages.command import Follow
from executive.messages.joints import JointSample

LOOKS = 3  # samples in a row: an effort that changes its sign passes zero in fewer
_WRONG = 2.0  # the factor by which the machine's masses may be wrong
_NOISE = 3.0  # standard deviations within which a measured effort may be none
_DRAGGED = 0.6  # friction of stone on soil: the share of its weight by which the ground may pull
_NEAR_M = 0.5  # above a path's lower end, where a stone in the jaws may touch the ground
_PRESSING = 0.25  # share of the jaws' own force from which they hold something
_STEP_S = 0.02  # of the difference quotient for accelerations of the path

_Motion = tuple[Float, Float, Float]  # position, velocity and acceleration of the arm, (n,) each


@dataclass(frozen=True, slots=True, eq=False)
class _Look:
    """The stamp and velocities of a sample, and which drives had no effort."""

    stamp_s: float
    dq: Float
    lost: frozenset[int]


class DrivePressure:
    """Finds a drive whose effort is none while the motion needs one.

    A drive without pressure measures an effort of zero. It is told where the machine's own masses
    need twice what the noise can hide, and the dry friction of the cylinder beside it, whatever
    the jaws carry: with nothing in them and with the whole payload, now and the drives' lag ago,
    and always in the same direction. So masses that are wrong by a factor of two do no harm, and a
    drive that needs no effort, as a swing at a constant speed on level ground, is not judged.

    Where the gripper or what it holds touches the ground, that may turn the gripper with the
    payload's weight at as much as half the width of the open jaws from the grasp centre. A drive
    that needs no more than this moment is not judged: those of the wrist never are. Within half a
    metre of the lower end of a path, jaws that press on a stone may drag it over the ground, or
    pull at one that is wedged there, by what friction holds of the payload's weight. They may also
    be pushed up by one whose faces widen downwards, which relieves the boom alone: there a drive is
    told only if its joint moves as it does without an effort. The ground may also carry the arm.
    Then the other drives do not measure what the measured motion needs, within the factor of two,
    and nothing is judged.
    """

    def __init__(self, machine: Machine) -> None:
        self._machine, self._dynamics = machine, Dynamics(machine)
        self._kinematics = Kinematics(machine)
        tips = machine.gripper.tips(machine.gripper.open_rad)
        arm_m = float(np.linalg.norm(tips[0] - tips[1])) / 2
        self._moment_nm = machine.payload_kg * GRAVITY_M_S2 * arm_m
        limits = np.array([joint.max_effort for joint in machine.joints])
        sheet = next(iter(machine.sensors_of("encoders")), None)
        share = sheet.effort_noise if isinstance(sheet, Encoders) else 0.0
        friction = machine.hydraulics.friction if machine.hydraulics is not None else 0.0
        self._none = _NOISE * share * limits
        self._needed = _WRONG * self._none + friction * limits
        self._looks: deque[_Look] = deque(maxlen=LOOKS)

    def forget(self) -> None:
        """Begin anew: nothing is followed, or another path."""
        self._looks.clear()

    def lost(self, sample: JointSample, follow: Follow, since_s: float, up_base: Float) -> str:
        """Return a drive that has had no effort in the newest samples though it needs one.

        Args:
            sample: The newest measurement.
            follow: The path that the arm follows.
            since_s: Time of the sample since the path began [s].
            up_base: The direction upwards in base axes, shape (3,).
        """
        lag_s = self._machine.stance.tracking_lag_s
        if not lag_s <= since_s <= follow.trajectory.duration_s:
            self.forget()
            return ""
        if self._looks and sample.stamp_s <= self._looks[-1].stamp_s:
            return ""
        motion = self._measured(sample)
        path = self._on_path(sample, follow, since_s)
        drags = self._presses(sample) and self._is_low(sample, follow, up_base)
        lost = self._lost_now(sample, motion, path, up_base, drags)
        self._looks.append(_Look(sample.stamp_s, motion[1], frozenset(lost)))
        lasting = frozenset.intersection(*(look.lost for look in self._looks))
        if len(self._looks) < LOOKS or not lasting:
            return ""
        i = min(lasting)
        joint = self._machine.joints[i]
        unit = "N" if joint.kind == "prismatic" else "N·m"
        return f"{joint.name} has no effort where its motion needs {lost[i]:.0f} {unit}"

    def _presses(self, sample: JointSample) -> bool:
        """Return whether the jaws press on something."""
        gripper = self._machine.gripper
        effort_nm = sample.of(self._machine.jaw.name)[2]
        return bool(effort_nm < -_PRESSING * gripper.tip_force_n * gripper.tip_radius_m)

    def _is_low(self, sample: JointSample, follow: Follow, up_base: Float) -> bool:
        """Return whether the gripper is near the lower end of the path."""
        q = np.array([sample.of(name)[0] for name in self._machine.arm_names])
        columns = [self._machine.arm_names.index(name) for name in follow.trajectory.names]
        ends = np.stack([q, q])
        ends[:, columns] = follow.trajectory.position[[0, -1]]
        heights = [self._kinematics.gripper(one)[:3, 3] @ up_base for one in (q, *ends)]
        return bool(heights[0] < min(heights[1:]) + _NEAR_M)

    def _lost_now(
        self,
        sample: JointSample,
        motion: _Motion,
        path: Iterator[_Motion],
        up_base: Float,
        drags: bool,
    ) -> dict[int, float]:
        """Return the drives that have no effort where they need one, and the least that it is."""
        measured = np.array([sample.of(name)[2] for name in self._machine.arm_names])
        is_none = np.abs(measured) <= self._none
        if not is_none.any():  # so it is at most times, and what is needed costs the most
            return {}
        moments, needs = self._moments(sample, up_base, drags), np.empty((0, len(measured)))
        is_lost = is_none
        for motion_on_path in path:  # mostly the first one shows already that no effort is needed
            needs = np.vstack([needs, self._needs([motion_on_path], up_base)])
            is_lost = is_none & (self._directions(needs, moments) != 0)
            if not is_lost.any():
                return {}
        moving = self._needs([motion], up_base)
        if self._is_carried(measured, is_none, moving, moments):
            return {}
        if drags:
            is_lost &= self._directions(moving, moments) == 0
        least = np.abs(needs).min(axis=0)
        return {int(i): float(least[i]) for i in np.flatnonzero(is_lost)}

    def _on_path(self, sample: JointSample, follow: Follow, since_s: float) -> Iterator[_Motion]:
        """Yield the motion of the path now, and back to the drives' lag ago."""
        names, lag_s = self._machine.arm_names, self._machine.stance.tracking_lag_s
        columns = [names.index(name) for name in follow.trajectory.names]
        for time_s in (since_s - lag_s, since_s - lag_s / 2, since_s):
            q = np.array([sample.of(name)[0] for name in names])
            dq, ddq = np.zeros((2, len(names)))
            q[columns], dq[columns] = follow.trajectory.at(time_s)
            after, before = (follow.trajectory.at(time_s + by)[1] for by in (_STEP_S, -_STEP_S))
            ddq[columns] = (after - before) / (2 * _STEP_S)
            yield q, dq, ddq

    def _measured(self, sample: JointSample) -> _Motion:
        """Return the measured motion, with the mean acceleration since the look before."""
        q, dq, _ = np.array([sample.of(name) for name in self._machine.arm_names]).T
        if not self._looks:
            return q, dq, np.zeros_like(dq)
        before = self._looks[-1]
        return q, dq, (dq - before.dq) / (sample.stamp_s - before.stamp_s)

    def _needs(self, motions: Iterable[_Motion], up_base: Float) -> Float:
        """Return the efforts of some motions, empty and loaded, shape (2 m, n)."""
        loads_kg = (0.0, self._machine.payload_kg)
        return np.array(
            [
                self._dynamics.efforts(*motion, up_base, load_kg)
                for motion in motions
                for load_kg in loads_kg
            ]
        )

    def _moments(self, sample: JointSample, up_base: Float, drags: bool) -> Float:
        """Return what a weight beside the grasp centre adds to each effort at most, shape (n,).

        With what a stone adds that is dragged over the ground, or wedged there.
        """
        q = np.array([sample.of(name)[0] for name in self._machine.arm_names])
        J = self._kinematics.jacobian(q)
        axes = J[3:].T  # zero for prismatic joints
        turned = self._moment_nm * np.linalg.norm(np.cross(axes, up_base), axis=1)
        if not drags:
            return np.asarray(turned)
        sideways = J[:3] - np.outer(up_base, up_base @ J[:3])
        pull_n = _DRAGGED * self._machine.payload_kg * GRAVITY_M_S2
        return np.asarray(turned + pull_n * np.linalg.norm(sideways, axis=0))

    def _directions(self, needs: Float, moments: Float) -> Float:
        """Return the sign of the effort that each drive needs in any case; 0 if in none."""
        least = self._needed + moments
        is_needed = (needs.min(axis=0) > least) | (needs.max(axis=0) < -least)
        return np.asarray(np.sign(needs[0]) * is_needed)

    def _is_carried(self, measured: Float, is_none: Bool, needs: Float, moments: Float) -> bool:
        """Return whether something else than the drives carries or pushes the arm."""
        direction = self._directions(needs, moments)
        along = measured * direction
        least = np.abs(needs).min(axis=0) / _WRONG - self._none
        most = np.abs(needs).max(axis=0) * _WRONG + self._none
        is_judged = (direction != 0) & ~is_none
        return bool((is_judged & ((along < least) | (along > most))).any())
