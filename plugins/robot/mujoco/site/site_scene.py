"""The site for rays from outside: ground, obstacles and stones, without the machine."""

from collections.abc import Sequence

import numpy as np
from executive_plugins.robot.mujoco.site.ray_mesh import Mesh, RayMesh, Rays, joined, moved
from executive_plugins.robot.mujoco.site.site import Site

from executive.arrays import Float, checked

_MOVED_M = 2e-3  # motion above which a stone does not rest


class SiteScene:
    """Ground, obstacles and stones for ray casting.

    The hierarchy is rebuilt only when a stone begins or stops moving. Moving stones are not part of
    it; a lidar casts them separately, see `sensors/lidar.py`.
    """

    def __init__(self, site: Site) -> None:
        self._fixed: Mesh = joined(
            [site.terrain.mesh(), *(obstacle.mesh() for obstacle in site.obstacles)]
        )
        self._names = tuple(stone.name for stone in site.stones)
        self._skins: tuple[Mesh, ...] = tuple(
            (stone.vertices, stone.triangles) for stone in site.stones
        )
        self._radii = tuple(
            float(np.linalg.norm(stone.vertices, axis=1).max()) for stone in site.stones
        )
        self._last: tuple[Float, ...] = site.T_world_stones
        self._built: tuple[Float, ...] = site.T_world_stones
        self._resting = frozenset(range(len(site.stones)))
        self._mesh = self._build()

    @property
    def moving(self) -> tuple[int, ...]:
        """Indices of the moving stones."""
        return tuple(i for i in range(len(self._skins)) if i not in self._resting)

    def name(self, index: int) -> str:
        """Return the name of a stone's body."""
        return self._names[index]

    def skin(self, index: int) -> Mesh:
        """Return the surface of a stone in its own frame."""
        return self._skins[index]

    def update(self, T_world_stones: Sequence[Float]) -> None:
        """Set the present poses of the stones.

        A stone rests if it has not moved since the last call.
        """
        still = {
            i for i, T in enumerate(T_world_stones) if self._shift_m(i, T, self._last[i]) < _MOVED_M
        }
        stays = {
            i
            for i in still & self._resting
            if self._shift_m(i, T_world_stones[i], self._built[i]) < _MOVED_M
        }
        self._last = tuple(T_world_stones)
        resting = frozenset(stays | (still - self._resting))
        if resting != self._resting:
            self._resting = resting
            self._built = self._last
            self._mesh = self._build()

    def _shift_m(self, i: int, T_a: Float, T_b: Float) -> float:
        """Return an upper bound of the motion of any point of a stone [m]."""
        turn = float(np.linalg.norm(T_a[:3, :3] - T_b[:3, :3]))
        return float(np.linalg.norm(T_a[:3, 3] - T_b[:3, 3])) + turn * self._radii[i]

    def _build(self) -> RayMesh:
        meshes = [
            self._fixed,
            *(moved(self._skins[i], self._built[i]) for i in sorted(self._resting)),
        ]
        self._top_m = max(float(vertices[:, 2].max()) for vertices, _ in meshes)
        return RayMesh(meshes)

    def cast_resting(self, rays_world: Rays) -> Rays:
        """Return ranges along rays (N, 6) to ground and resting stones, inf for none, (N,)."""
        ranges = np.full(len(rays_world), np.inf, dtype=np.float32)
        # The other rays start above the site and point upwards.
        candidates = np.flatnonzero((rays_world[:, 5] < 0) | (rays_world[:, 2] <= self._top_m))
        ranges[candidates] = self._mesh.cast(rays_world[candidates])
        return ranges

    def cast_rays(self, origins_world: Float, directions_world: Float) -> Float:
        """Return ranges to all of the site, see `executive.interfaces.robot.Scene`.

        The machine is not included, since a survey is flown before it arrives.
        """
        origins = checked("origins_world", origins_world, None, 3)
        rays = np.hstack(
            [origins, checked("directions_world", directions_world, len(origins), 3)]
        ).astype(np.float32)
        ranges = self.cast_resting(rays)
        if self.moving:
            movers = RayMesh([moved(self._skins[i], self._last[i]) for i in self.moving])
            ranges = np.minimum(ranges, movers.cast(rays))
        return ranges.astype(np.float64)
