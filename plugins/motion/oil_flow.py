"""Paths that ask for no more oil than the pump of a hydraulic machine gives."""

import numpy as np

from executive.machine.machine import Machine
from executive.messages.trajectory import JointTrajectory

_SHARE = 0.85  # of the pump's flow; the feedback of the drives has the rest


def within_flow(trajectory: JointTrajectory, machine: Machine) -> JointTrajectory:
    """Return a trajectory of all arm joints, slowed down evenly where its largest flow is too much.

    A slower motion along the same path keeps every limit that the faster one keeps. A machine
    without hydraulics has no such limit.
    """
    if machine.hydraulics is None:
        return trajectory
    taken = np.array([machine.hydraulics.displacement[name] for name in trajectory.names])
    largest_m3_s = float((np.abs(trajectory.velocity) @ taken).max())
    factor = largest_m3_s / (_SHARE * machine.hydraulics.pump_flow_m3_s)
    return trajectory.slowed(factor) if factor > 1.0 else trajectory
