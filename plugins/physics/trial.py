"""One release of one stone onto others: lowered until it touches, let go, and observed."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from executive_plugins.physics.equilibrium import Touch
from executive_plugins.physics.stone_world import StoneWorld, WorldRules

from executive.arrays import Float
from executive.geometry.rotation import angle_between, exp_so3
from executive.messages.building import AsBuilt, StandingStone
from executive.messages.solid_stone import SolidStone

_STEP_M = 0.01  # of the lowering: a guarded descent ends within this of the first touch
_MOST_M = 1.0  # how far a stone is raised to be free, or lowered to touch
_LEAST_S, _MOST_S = 0.6, 4.0


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """What a release led to.

    Attributes:
        T_map_release: Pose at which the stone was let go, shape (4, 4).
        T_map_settled: Pose at which it came to rest, or was when time was over, shape (4, 4).
        moved_m: Largest displacement of any other stone [m].
        is_at_rest: Whether everything was at rest in the end.
    """

    T_map_release: Float
    T_map_settled: Float
    moved_m: float
    is_at_rest: bool


class Trial:
    """A structure as it stands and one stone more, released as often as is asked for."""

    def __init__(self, built: AsBuilt, stone: SolidStone, rules: WorldRules) -> None:
        self._others = built.standing
        self._new = len(built.standing)
        stones = (*built.standing, StandingStone(stone, np.eye(4)))
        self.world = StoneWorld(built.ground, stones, None, rules)

    def release(self, T_map_stone: Float, height_m: float) -> Outcome:
        """Lower the stone to first touch, raise it by `height_m`, and let it go."""
        world = self.world
        mujoco.mj_resetData(world.model, world.data)
        for number, other in enumerate(self._others):
            world.set_pose(number, other.T_map_stone)
        T = self._touching(T_map_stone)
        T[2, 3] += height_m
        world.set_pose(self._new, T)
        is_at_rest = world.settle(_LEAST_S, _MOST_S)
        return Outcome(T, world.pose_of(self._new), self._moved_m(), is_at_rest)

    def touches(self) -> list[Touch]:
        """Return where the new stone touches now; the others count as what cannot move."""
        return touches_of(self.world, only=self._new)

    def poses(self) -> Sequence[Float]:
        """Return the present poses of all stones, the new one last."""
        return [self.world.pose_of(number) for number in range(self._new + 1)]

    def _moved_m(self) -> float:
        moved = (
            float(np.linalg.norm(self.world.pose_of(n)[:3, 3] - other.T_map_stone[:3, 3]))
            for n, other in enumerate(self._others)
        )
        return max(moved, default=0.0)

    def _touching(self, T_map_stone: Float) -> Float:
        """Return the pose straight above or below at which the stone is just free."""
        T, risen = np.array(T_map_stone), 0.0
        while self._hits(T) and risen < _MOST_M:
            T[2, 3] += _STEP_M
            risen += _STEP_M
        if risen > 0.0:
            return T
        fallen = 0.0
        while fallen < _MOST_M:
            T[2, 3] -= _STEP_M
            fallen += _STEP_M
            if self._hits(T):
                break
        T[2, 3] += _STEP_M
        return T

    def _hits(self, T: Float) -> bool:
        world = self.world
        world.set_pose(self._new, T)
        mujoco.mj_kinematics(world.model, world.data)
        mujoco.mj_collision(world.model, world.data)
        body = world.model.body(f"stone_{self._new}").id
        pairs = world.model.geom_bodyid[world.data.contact.geom]
        return bool((pairs == body).any())


def disturbed(
    T_map_stone: Float, noise_m: float, noise_rad: float, rng: np.random.Generator
) -> Float:
    """Return a pose with noise along x and y, and about all axes, as standard deviations."""
    T = np.array(T_map_stone)
    T[:2, 3] += rng.normal(0.0, noise_m, 2)
    T[:3, :3] = exp_so3(rng.normal(0.0, noise_rad, 3)) @ T[:3, :3]
    return T


def apart(T_a: Float, T_b: Float) -> tuple[float, float]:
    """Return the distance [m] of the origins of two poses and the angle [rad] between them."""
    return float(np.linalg.norm(T_a[:3, 3] - T_b[:3, 3])), angle_between(T_a[:3, :3], T_b[:3, :3])


def touches_of(world: StoneWorld, only: int | None = None) -> list[Touch]:
    """Return the contacts of a world in its present state.

    Args:
        world: The world.
        only: The one stone whose balance is asked for; all others count as what cannot move, and
            it is number 0.
    """
    mujoco.mj_forward(world.model, world.data)
    first = world.model.body("stone_0").id
    found = []
    for contact in world.data.contact:
        bodies = world.model.geom_bodyid[contact.geom] - first
        a, b = (max(int(n), -1) for n in bodies)
        if only is not None:
            if only not in (a, b):
                continue
            a, b = (0 if n == only else -1 for n in (a, b))
        found.append(Touch(a, b, np.array(contact.pos), np.array(contact.frame[:3])))
    return found
