"""Whether the drives of the arm have pressure: what they measure against what the motion needs."""

from collections import deque

import numpy as np

from executive.arrays import Float
from executive.machine.dynamics import Dynamics
from executive.machine.machine import Machine
from executive.machine.sensor import Encoders
from executive.messages.command import Follow
from executive.messages.joints import JointSample

LOOKS = 3  # samples in a row: an effort that changes its sign passes zero in fewer
_NOISE = 3.0  # standard deviations within which a measured effort may be none
_STEP_S = 0.02  # of the difference quotient for accelerations of the path


class DrivePressure:
    """Finds a drive whose effort is none while the motion needs one.

    A drive without pressure measures an effort of zero. It is told where the machine's own masses
    need twice what the noise can hide, and the dry friction of the cylinder beside it, whatever
    the jaws carry: with nothing in them and with the whole payload, now and the drives' lag ago,
    and always in the same direction. So masses that are wrong by a factor of two do no harm, and a
    drive that needs no effort, as a swing at a constant speed on level ground, is not judged.
    """

    def __init__(self, machine: Machine) -> None:
        self._machine, self._dynamics = machine, Dynamics(machine)
        limits = np.array([joint.max_effort for joint in machine.joints])
        sheet = next(iter(machine.sensors_of("encoders")), None)
        share = sheet.effort_noise if isinstance(sheet, Encoders) else 0.0
        friction = machine.hydraulics.friction if machine.hydraulics is not None else 0.0
        self._none = _NOISE * share * limits
        self._needed = 2.0 * self._none + friction * limits
        self._looks: deque[tuple[float, frozenset[str]]] = deque(maxlen=LOOKS)

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
        if self._looks and sample.stamp_s <= self._looks[-1][0]:
            return ""
        measured = np.array([sample.of(name)[2] for name in self._machine.arm_names])
        times = (since_s - lag_s, since_s - lag_s / 2, since_s)
        needs = self._needs(sample, follow, times, up_base)
        is_needed = needs.min(axis=0) > self._needed
        is_needed |= needs.max(axis=0) < -self._needed
        found = is_needed & (np.abs(measured) <= self._none)
        names = frozenset(np.array(self._machine.arm_names)[found].tolist())
        self._looks.append((sample.stamp_s, names))
        lasting = frozenset.intersection(*(names for _, names in self._looks))
        if len(self._looks) < LOOKS or not lasting:
            return ""
        i = next(i for i, name in enumerate(self._machine.arm_names) if name in lasting)
        least = float(np.abs(needs[:, i]).min())
        unit = "N" if self._machine.joints[i].kind == "prismatic" else "N·m"
        return (
            f"{self._machine.arm_names[i]} has no effort where its motion needs {least:.0f} {unit}"
        )

    def _needs(
        self, sample: JointSample, follow: Follow, times_s: tuple[float, ...], up_base: Float
    ) -> Float:
        """Return the efforts of the path at some times, empty and loaded, shape (2 m, n)."""
        names = self._machine.arm_names
        still = np.array([sample.of(name)[0] for name in names])
        columns = [names.index(name) for name in follow.trajectory.names]
        efforts = []
        for time_s in times_s:
            q, dq, ddq = still.copy(), np.zeros(len(names)), np.zeros(len(names))
            q[columns], dq[columns] = follow.trajectory.at(time_s)
            after, before = (follow.trajectory.at(time_s + by)[1] for by in (_STEP_S, -_STEP_S))
            ddq[columns] = (after - before) / (2 * _STEP_S)
            efforts += [
                self._dynamics.efforts(q, dq, ddq, up_base, load_kg)
                for load_kg in (0.0, self._machine.payload_kg)
            ]
        return np.array(efforts)
