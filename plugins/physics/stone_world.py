"""A MuJoCo world of stones on ground: what settling is tried in, and judged in.

The contact is that of rough stone on stone (docs/simulator.md, `nominal`). Three settings matter
for anything that has to stand: friction in six dimensions and an `impratio` of 50 or more, without
which piles creep by decimetres in 20 s, and no sleeping bodies, since a body that sleeps passes
every test of stability.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import mujoco
import numpy as np
from executive_plugins.physics.contact import apply_contact
from executive_plugins.physics.convex_pieces import convex_pieces, is_convex
from executive_plugins.physics.surface import ContactModel, round_patch, uniform

from executive.arrays import Float
from executive.geometry.rotation import quaternion_wxyz
from executive.messages.building import AsBuilt, StandingStone
from executive.messages.height_grid import HeightGrid
from executive.messages.solid_stone import SolidStone

# Two rough faces touch at asperities 3 cm apart, 5 mm off the middle (scenario.py, `nominal`).
_ASPERITY_M, _ROLLING_M = 0.03, 0.005
_PLANE_M = 1e-3  # ground that is a plane to this is one
# A stone strays less than this within the window while it shakes on the spot: 2 mm, about 4 mrad
# (of its place and of its quaternion). One that creeps at 1 cm/s strays by more.
_WINDOW_S, _STAYING = 0.5, 2e-3
_DEEP_M = 1.0  # thickness of the ground below its lowest point


@dataclass(frozen=True, slots=True)
class WorldRules:
    """How a world is simulated.

    Attributes:
        step_s: Time step [s].
        friction: Coefficient of friction of all contacts.
        pieces: Number of convex pieces of each stone.
        impratio: Stiffness of friction over that of normal forces.
        dent_m: Radius of the dent that a stone presses into the ground [m]; without any the ground
            is as hard as a stone.
        is_convex_whole: Whether a stone that is convex is one piece, whatever their number: that is
            its shape to the last corner, and its contacts cost a tenth. Ten pieces of it touch at
            more points, and differ from one piece by nothing else.
    """

    step_s: float = 0.004
    friction: float = 0.65
    pieces: int = 10
    impratio: float = 50.0
    dent_m: float = 0.0
    is_convex_whole: bool = False


class StoneWorld:
    """Stones on ground, each free to move or fixed; poses are those of their frames."""

    def __init__(
        self,
        ground: HeightGrid,
        stones: Sequence[StandingStone],
        fixed: Sequence[bool] | None = None,
        rules: WorldRules | None = None,
    ) -> None:
        """Build the world; `fixed` says which stones are part of it and cannot move."""
        self.rules = rules or WorldRules()
        held = fixed or [False] * len(stones)
        spec = mujoco.MjSpec()
        spec.option.timestep = self.rules.step_s
        _add_ground(spec, ground)
        for number, (standing, is_fixed) in enumerate(zip(stones, held, strict=True)):
            _add_stone(spec, f"stone_{number}", standing, is_fixed, self.rules)
        apply_contact(spec, _contact(self.rules))
        self.model: mujoco.MjModel = spec.compile()
        self.data: mujoco.MjData = mujoco.MjData(self.model)
        self._free = [number for number, is_fixed in enumerate(held) if not is_fixed]
        self._start: Mapping[int, Float] = {
            n: np.array(s.T_map_stone) for n, s in enumerate(stones)
        }

    @property
    def free(self) -> Sequence[int]:
        """Return the numbers of the stones that move, in the order of their joints."""
        return self._free

    def set_pose(self, number: int, T_map_stone: Float) -> None:
        """Put a free stone somewhere, at rest."""
        at = 7 * self._free.index(number)
        self.data.qpos[at : at + 3] = T_map_stone[:3, 3]
        self.data.qpos[at + 3 : at + 7] = quaternion_wxyz(T_map_stone[:3, :3])
        self.data.qvel[6 * (at // 7) : 6 * (at // 7) + 6] = 0.0
        self.data.qacc_warmstart[:] = 0.0

    def pose_of(self, number: int) -> Float:
        """Return where a stone is now, shape (4, 4)."""
        if number not in self._free:
            return np.array(self._start[number])
        at = 7 * self._free.index(number)
        R = np.zeros(9)
        mujoco.mju_quat2Mat(R, self.data.qpos[at + 3 : at + 7])
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = R.reshape(3, 3), self.data.qpos[at : at + 3]
        return T

    def step(self, count: int = 1) -> None:
        """Advance by time steps."""
        mujoco.mj_step(self.model, self.data, nstep=count)

    def settle(
        self,
        least_s: float,
        most_s: float,
        still: float = 0.01,
        is_over: Callable[[], bool] | None = None,
    ) -> bool:
        """Step until all free stones are slower than `still` [m/s, rad/s], or the time is over.

        A stone that shakes on the spot rests, too: on ground that is a height field, and in some
        postures, contacts do not die down. It is one that has not strayed within half a second.
        If `is_over` says so in between, nothing more is of interest.

        Returns:
            Whether they rest.
        """
        # Twenty checks a second: a check costs less than a step.
        every = max(1, round(0.05 / self.rules.step_s))
        begun = window = float(self.data.time)
        low = high = np.array(self.data.qpos)
        while self.data.time - begun < most_s:
            self.step(every)
            if is_over is not None and is_over():
                return False
            low, high = np.minimum(low, self.data.qpos), np.maximum(high, self.data.qpos)
            if self.data.time - begun >= least_s and self.speed() < still:
                return True
            if self.data.time - window >= _WINDOW_S:
                if self.data.time - begun >= least_s and (high - low).max(initial=0.0) < _STAYING:
                    return True
                window, low, high = (
                    float(self.data.time),
                    self.data.qpos.copy(),
                    self.data.qpos.copy(),
                )
        return False

    def speed(self) -> float:
        """Return the largest component of velocity of any free stone [m/s] and [rad/s]."""
        return float(np.abs(self.data.qvel).max(initial=0.0))

    def standing(self, stones: Sequence[StandingStone]) -> tuple[StandingStone, ...]:
        """Return stones, given in the order of this world, at their present poses."""
        return tuple(
            StandingStone(one.stone, self.pose_of(number)) for number, one in enumerate(stones)
        )


def _contact(rules: WorldRules) -> ContactModel:
    """Return stone on stone, and stone on the ground, which rolls once half of the dent bears."""
    stone = round_patch(rules.friction, _ASPERITY_M, _ROLLING_M)
    if not rules.dent_m:
        return uniform(stone, rules.impratio)
    ground = round_patch(rules.friction, rules.dent_m, 4.0 * rules.dent_m / (3.0 * np.pi))
    return ContactModel(stone, ground, stone, rules.impratio)


def world_of(built: AsBuilt, rules: WorldRules) -> StoneWorld:
    """Return the world of a structure as it stands, all stones free."""
    return StoneWorld(built.ground, built.standing, None, rules)


def _add_ground(spec: mujoco.MjSpec, ground: HeightGrid) -> None:
    """Add a plane if the ground is one, and a height field otherwise."""
    i, j = np.indices(ground.heights.shape)
    x, y = (ground.corner[k] + ground.cell_m * (i, j)[k].ravel() for k in (0, 1))
    A = np.column_stack([x, y, np.ones(len(x))])
    z = ground.heights.ravel()
    (a, b, c), *_ = np.linalg.lstsq(A, z, rcond=None)
    if np.abs(A @ (a, b, c) - z).max() < _PLANE_M:
        spec.worldbody.add_geom(
            name="ground",
            type=mujoco.mjtGeom.mjGEOM_PLANE,
            size=[0, 0, 1],
            pos=[0, 0, float(c)],
            zaxis=[-float(a), -float(b), 1.0],
        )
        return
    low, high = float(z.min()), float(z.max())
    rows = np.ascontiguousarray(ground.heights.T)  # rows of MuJoCo run along x, one a value of y
    half = 0.5 * ground.cell_m * (np.array(ground.heights.shape) - 1)
    spec.add_hfield(
        name="ground",
        nrow=rows.shape[0],
        ncol=rows.shape[1],
        size=[*half, high - low, _DEEP_M],
        userdata=((rows - low) / (high - low)).ravel(),
    )
    spec.worldbody.add_geom(
        name="ground",
        type=mujoco.mjtGeom.mjGEOM_HFIELD,
        hfieldname="ground",
        pos=[*(ground.corner + half), low],
    )


def _add_stone(
    spec: mujoco.MjSpec, name: str, standing: StandingStone, is_fixed: bool, rules: WorldRules
) -> None:
    stone, T = standing.stone, standing.T_map_stone
    body = spec.worldbody.add_body(
        name=name, pos=T[:3, 3].tolist(), quat=quaternion_wxyz(T[:3, :3]).tolist()
    )
    if not is_fixed:
        body.add_freejoint(name=name)
    inertia = stone.inertia()
    body.explicitinertial = True
    body.mass, body.ipos = stone.mass_kg, [0.0, 0.0, 0.0]
    body.fullinertia = [*np.diag(inertia), inertia[0, 1], inertia[0, 2], inertia[1, 2]]
    for number, corners in enumerate(_pieces(stone, rules.pieces, rules.is_convex_whole)):
        mesh = f"{name}_{number}"
        spec.add_mesh(
            name=mesh,
            uservert=corners.ravel(),
            inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX,
        )
        body.add_geom(name=mesh, type=mujoco.mjtGeom.mjGEOM_MESH, meshname=mesh, mass=0.0)


@lru_cache(maxsize=128)  # the stones of a structure are in one world after the other
def _pieces(stone: SolidStone, count: int, is_convex_whole: bool) -> Sequence[Float]:
    if is_convex_whole and is_convex(stone.vertices, stone.volume_m3):
        count = 1
    return convex_pieces(stone.vertices, stone.triangles, count)
