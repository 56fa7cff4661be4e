"""The jaws of the simulated arm, empty, on their way from angle to angle in drawn postures."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.robot.mujoco.physics_settings import PhysicsSettings
from executive_plugins.robot.mujoco.site.settings import SiteSettings
from executive_plugins.robot.mujoco.site.site import make_site
from executive_plugins.robot.mujoco.world import World

from executive.arrays import Float
from executive.machine.machine import Machine, load_machine
from executive.messages.command import MoveJaws

_HEIGHT_M = 1.5  # of the gripper, at least: away from the ground
_LEAST_FORCE = 0.05  # share of the largest
_WAY = (0.1, 0.9)  # shares of the largest angle, from where to where the jaws move at least
_TO_SPEED_S, _TO_REST_S, _LOOK_S = 0.3, 1.0, 0.5
_AT_REST_RAD_S = 0.01
MOVING_SHARE, RESTLESS = Bound(0.02), Bound(0.0)


@dataclass(frozen=True, slots=True)
class Moved:
    """One motion of the jaws.

    Attributes:
        swing: Range of the drive's torque at full speed, over the largest torque.
        after_rad_s: Largest speed of a jaw one second after both have arrived.
    """

    swing: float
    after_rad_s: float


def measured(model: str, postures: int, seed: int) -> list[Moved]:
    """Move the jaws in postures that touch nothing."""
    machine, rng = load_machine(model), np.random.default_rng(seed)
    settings = SiteSettings.model_validate({"stones": {"count": 0}})
    world = World(machine, make_site(settings, machine, PhysicsSettings(), rng), PhysicsSettings())
    lower, upper = np.transpose([_range(machine, name) for name in machine.arm_names])
    found: list[Moved] = []
    while len(found) < postures:
        arm_rad = rng.uniform(lower, upper)
        if _is_free(world, arm_rad):
            found.append(_moved(world, arm_rad, rng))
    return found


def _is_free(world: World, arm_rad: Float) -> bool:
    """Say whether nothing touches anything in a posture, whatever the angle of the jaws."""
    for share in np.linspace(*_WAY, 5):
        _set_jaws(world, share * world.machine.jaw.upper)
        world._set_arm(arm_rad)
        if world.data.ncon:
            return False
    return bool(world.T_world_body(world.machine.gripper_link)[2, 3] > _HEIGHT_M)


def _set_jaws(world: World, angle_rad: float) -> None:
    world.data.qvel[:] = 0.0
    for name in (world.machine.jaw.name, world.machine.jaw.mirror_name):
        world.data.joint(name).qpos = angle_rad


def _range(machine: Machine, name: str) -> tuple[float, float]:
    limits = next(joint.range for joint in machine.joints if joint.name == name)
    return (-np.pi, np.pi) if limits is None else limits


def _moved(world: World, arm_rad: Float, rng: np.random.Generator) -> Moved:
    jaw, tip_force_n = world.machine.jaw, world.machine.gripper.tip_force_n
    joints = [world.data.joint(name) for name in (jaw.name, jaw.mirror_name)]
    force_n = tip_force_n * float(rng.uniform(_LEAST_FORCE, 1.0))
    begin, end = (share * jaw.upper for share in rng.permutation(_WAY))
    _set_jaws(world, begin)
    world._set_arm(arm_rad)
    world.move_jaws(MoveJaws(float(end), force_n))

    def after(duration_s: float) -> list[tuple[float, float]]:
        """Return the torque and the largest speed of a jaw, a pair a step."""
        told = []
        for _ in range(round(duration_s / float(world.model.opt.timestep))):
            world._substep(arm_rad, np.zeros(len(arm_rad)))
            told.append((world.jaws.effort_nm, max(abs(float(j.qvel[0])) for j in joints)))
        return told

    after(_TO_SPEED_S)
    way_s = abs(end - begin) / jaw.max_velocity
    torques, _ = zip(*after(way_s / 2 - _TO_SPEED_S), strict=True)
    after(way_s + _TO_REST_S)
    _, speeds = zip(*after(_LOOK_S), strict=True)
    return Moved(float(np.ptp(torques)) / jaw.max_effort, max(speeds))


def figures(moved: Sequence[Moved]) -> list[Figure]:
    """Return the figures of all motions."""
    swings = [motion.swing for motion in moved]
    restless = sum(motion.after_rad_s > _AT_REST_RAD_S for motion in moved)
    fastest = max(motion.after_rad_s for motion in moved)
    median, uneven = float(np.median(swings)), sum(s > MOVING_SHARE.must for s in swings)
    return [
        held(
            "swing of the torque of moving jaws, over the largest, worst posture",
            max(swings),
            MOVING_SHARE,
            f"{max(swings):.4f} (p50 {median:.4f}, {uneven} of {len(moved)} beyond)",
        ),
        held(
            "postures in which a jaw moves a second after it has arrived",
            float(restless),
            RESTLESS,
            f"{restless} of {len(moved)} (fastest {fastest:.4f} rad/s)",
        ),
    ]
