"""The machine on its wheels: a chassis that is carried over the ground where it drives.

The chassis is a free body, held by a stiff constraint at a carrier whose motion is prescribed, so
that whatever accelerates the chassis is felt by the arm, the inertial sensors and the antennas. The
carrier goes where the wheels roll, and stands on the ground as the points of support do: at the
height and with the slope of the plane through the ground below them. Wheels do not slip, tyres do
not yield, and the machine does not tip: see docs/simulator.md.
"""

from collections.abc import Callable

import mujoco
import numpy as np
from executive_plugins.robot.base_driver import BaseDriver

from executive.arrays import Float
from executive.errors import ConfigError
from executive.geometry.pose import pose
from executive.geometry.rotation import from_quaternion, quaternion_wxyz
from executive.machine.machine import Machine

HeightAt = Callable[[Float], Float]  # ground heights [m] at places (n, 2), shape (n,)

_CARRIER = "carrier"
# Time constant of the constraint [s]: four integration steps of 2.5 ms, twice MuJoCo's least. With
# 2.7 t at 6 m the chassis yields by less than 0.1 mrad.
_HOLD_S = 0.01
_TYRE_M = 0.25  # half the length of ground that a tyre bridges


def set_on_wheels(spec: mujoco.MjSpec, machine: Machine) -> None:
    """Free the chassis, and hold it at the carrier, at the pose that its body has.

    Raises:
        ConfigError: If the machine's description says not how it drives or on what it stands.
    """
    base = spec.body(machine.base_link)
    base.add_freejoint()
    spec.add_exclude(bodyname1=base.name, bodyname2="world")  # the carrier bears it
    add_carrier(spec, machine, holds=True)


def add_carrier(spec: mujoco.MjSpec, machine: Machine, *, holds: bool) -> None:
    """Add the carrier of a chassis that is a free body.

    Args:
        spec: The model.
        machine: The machine.
        holds: Whether it holds the chassis from the start.

    Raises:
        ConfigError: If the machine's description says not how it drives or on what it stands.
    """
    if machine.driving is None or len(machine.stance.supports_m) < 3:
        raise ConfigError(
            f"{machine.name} does not drive: give driving and stance.supports_m in its robot.yaml, "
            "or robot.base: welded"
        )
    base = spec.body(machine.base_link)
    carrier = spec.worldbody.add_body(name=_CARRIER, pos=base.pos, quat=base.quat, mocap=True)
    hold = spec.add_equality(
        name=_CARRIER, type=mujoco.mjtEq.mjEQ_WELD, objtype=mujoco.mjtObj.mjOBJ_BODY
    )
    hold.name1, hold.name2, hold.active = base.name, carrier.name, holds
    hold.data[:11] = (*(0.0,) * 6, 1.0, 0.0, 0.0, 0.0, 1.0)  # no offset, no turn, torque in m
    hold.solref[:2] = (_HOLD_S, 1.0)
    hold.solimp[:5] = (0.99, 0.999, 0.001, 0.5, 2.0)


def standing_on(height_at: HeightAt, machine: Machine, pose_map: Float) -> Float:
    """Return T_world_base of a machine that stands on the ground, shape (4, 4).

    Args:
        height_at: The ground.
        machine: Its points of support and its height above them.
        pose_map: x [m], y [m] and heading [rad], shape (3,).
    """
    x, y, yaw = pose_map
    R = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    along = np.array([[-_TYRE_M, 0.0], [0.0, 0.0], [_TYRE_M, 0.0]])
    supports = np.array(machine.stance.supports_m)
    places = (supports[:, None, :] + along) @ R.T + (x, y)
    heights = height_at(places.reshape(-1, 2)).reshape(len(supports), -1).mean(axis=1)
    plane = np.linalg.lstsq(np.c_[supports, np.ones(len(supports))], heights, rcond=None)[0]
    up = np.array([-plane[0], -plane[1], 1.0]) / np.hypot(1.0, np.hypot(plane[0], plane[1]))
    ahead = np.array([1.0, 0.0, plane[0]]) / np.hypot(1.0, plane[0])
    R_level_base = np.column_stack([ahead, np.cross(up, ahead), up])
    turn = np.eye(3)
    turn[:2, :2] = R
    foot = np.array([x, y, plane[2]])
    return pose(turn @ R_level_base, foot + machine.stance.base_height_m * (turn @ up))


class Wheels:
    """Moves the carrier.

    Attributes:
        driver: Where the wheels roll.
    """

    def __init__(
        self, model: mujoco.MjModel, data: mujoco.MjData, machine: Machine, height_at: HeightAt
    ) -> None:
        self._data, self._machine, self._height_at = data, machine, height_at
        self._row, self._hold = int(model.body(_CARRIER).mocapid[0]), model.eq(_CARRIER).id
        self._base = model.body(machine.base_link).id
        self.driver = BaseDriver(machine)

    def advance(self, dt_s: float) -> None:
        """Advance by one integration step; call it before the step."""
        if self.driver.is_moving:
            self.carry_to(self.standing_at(self.driver.advance(dt_s)))

    def standing_at(self, pose_map: Float) -> Float:
        """Return T_world_base of the machine on its wheels, shape (4, 4); see `standing_on`."""
        return standing_on(self._height_at, self._machine, pose_map)

    def carrier(self) -> Float:
        """Return the pose of the carrier, shape (4, 4)."""
        R = from_quaternion(self._data.mocap_quat[self._row])
        return pose(R, self._data.mocap_pos[self._row].copy())

    def carry_to(self, T_world_base: Float) -> None:
        """Set the pose of the carrier, shape (4, 4)."""
        self._data.mocap_pos[self._row] = T_world_base[:3, 3]
        self._data.mocap_quat[self._row] = quaternion_wxyz(T_world_base[:3, :3])

    def hold(self) -> Float:
        """Let the carrier hold the chassis where it is; return that pose, shape (4, 4)."""
        self._data.mocap_pos[self._row] = self._data.xpos[self._base]
        self._data.mocap_quat[self._row] = self._data.xquat[self._base]
        self._data.eq_active[self._hold] = 1
        return self.carrier()

    def let_go(self) -> None:
        """Let the carrier hold the chassis no more."""
        self._data.eq_active[self._hold] = 0
