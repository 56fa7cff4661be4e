"""One release of one stone onto others: lowered until it touches, let go, and observed."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from executive_plugins.physics.equilibrium import Touch
from executive_plugins.physics.stone_world import StoneWorld, WorldRules

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.geometry.rotation import angle_between, exp_so3
from executive.messages.building import AsBuilt, StandingStone
from executive.messages.solid_stone import SolidStone

_STEP_M = 0.01  # of the lowering: a guarded descent ends within this of the first touch
_MOST_M = 1.0  # how far a stone is raised to be free, or lowered to touch
_LEAST_S, _MOST_S = 0.6, 4.0
TOUCHING_M = 5e-3  # half of what ten convex pieces are off a scan (convex_pieces.py)
_GONE = 1.5  # times its bounds, from where a stone does not sway back
_AWAY_M = 1e3  # height of the stone until it is released: it meets nothing there
_PARTING = 80  # pairs of steps in which overlaps are parted; each parts a tenth or more
_REST_S, _STILL_M = 3.0, 1e-3  # until the others move less than this within `_LEAST_S`


@dataclass(frozen=True, slots=True, eq=False)
class Bounds:
    """A pose, and how far a stone may be from it to be there: farther is somewhere else.

    Attributes:
        T_map_stone: The pose, shape (4, 4).
        far_m: Largest distance [m].
        far_rad: Largest rotation [rad].
    """

    T_map_stone: Float
    far_m: float
    far_rad: float

    def holds(self, T_map_stone: Float, share: float = 1.0) -> bool:
        """Return whether a pose is within a multiple of the bounds."""
        distance_m, angle_rad = apart(self.T_map_stone, T_map_stone)
        return distance_m <= share * self.far_m and angle_rad <= share * self.far_rad


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

    def __init__(
        self,
        built: AsBuilt,
        stone: SolidStone,
        rules: WorldRules,
        rest: Sequence[Float] | None = None,
        fixed: Sequence[bool] | None = None,
    ) -> None:
        """Build the world.

        Args:
            built: The structure, or the part of it that the stone can reach.
            stone: The stone that is released.
            rules: How the world is simulated.
            rest: Where the stones of the structure rest in it, see `rest_of`, if it is known.
            fixed: Which of them cannot move; none if it is not given.
        """
        self._new = len(built.standing)
        self._rest = rest_of(built, rules) if rest is None else rest
        held = [False] * self._new if fixed is None else list(fixed)
        resting = [
            StandingStone(one.stone, T) for one, T in zip(built.standing, self._rest, strict=True)
        ]
        away = StandingStone(stone, pose(t=np.array([0.0, 0.0, _AWAY_M])))
        self.world = StoneWorld(built.ground, (*resting, away), [*held, False], rules)

    def release(self, T_map_stone: Float, height_m: float, bounds: Bounds | None = None) -> Outcome:
        """Lower the stone to first touch, raise it by `height_m`, and let it go.

        The release ends early, and not at rest, when the stone is one and a half times as far off
        as its bounds allow: a stone that only sways does not come as far.
        """
        world = self.world
        mujoco.mj_resetData(world.model, world.data)
        for number in world.free:
            if number != self._new:
                world.set_pose(number, self._rest[number])
        T = self._touching(T_map_stone)
        T[2, 3] += height_m
        world.set_pose(self._new, T)
        is_over = None
        if bounds is not None:
            here = bounds
            is_over = lambda: not here.holds(world.pose_of(self._new), _GONE)
        is_at_rest = world.settle(_LEAST_S, _MOST_S, is_over=is_over)
        return Outcome(T, world.pose_of(self._new), self._moved_m(), is_at_rest)

    def touches(self) -> list[Touch]:
        """Return where the new stone touches now; the others count as what cannot move.

        Faces that are closer than the shapes are true count as touching: a stone at rest sways by
        fractions of a millimetre, and in one instant bears on fewer points than it does.
        """
        return touches_of(self.world, only=self._new, within_m=TOUCHING_M)

    def poses(self) -> Sequence[Float]:
        """Return the present poses of all stones, the new one last."""
        return [self.world.pose_of(number) for number in range(self._new + 1)]

    def _moved_m(self) -> float:
        moved = (
            float(np.linalg.norm(self.world.pose_of(n)[:3, 3] - self._rest[n][:3, 3]))
            for n in self.world.free
            if n != self._new
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


def rest_of(built: AsBuilt, rules: WorldRules) -> Sequence[Float]:
    """Return where the stones of a structure rest in a world of these rules, (4, 4) each.

    Poses and shapes that were measured are off by some centimetres: without this, the stones
    would move by themselves, and each place would seem to move them. Overlaps are parted first,
    without speed: the contact engine would throw the stones apart.
    """
    if not built.standing:
        return []
    world, count = StoneWorld(built.ground, built.standing, None, rules), len(built.standing)
    for _ in range(_PARTING):
        world.step(2)
        world.data.qvel[:] = 0.0
    every = max(1, round(_LEAST_S / rules.step_s))
    world.step(every)
    for _ in range(round(_REST_S / _LEAST_S)):
        before = [world.pose_of(n)[:3, 3] for n in range(count)]
        world.step(every)
        after = [world.pose_of(n)[:3, 3] for n in range(count)]
        if np.abs(np.subtract(after, before)).max() < _STILL_M:
            break
    return [world.pose_of(n) for n in range(count)]


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


def touches_of(world: StoneWorld, only: int | None = None, within_m: float = 0.0) -> list[Touch]:
    """Return the contacts of a world in its present state.

    Args:
        world: The world.
        within_m: Gap up to which two faces are in contact [m].
        only: The one stone whose balance is asked for; all others count as what cannot move, and
            it is number 0.
    """
    world.model.geom_margin[:] = within_m
    mujoco.mj_fwdPosition(world.model, world.data)
    world.model.geom_margin[:] = 0.0
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
